#include "identify/models/kinematic_model.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/simulated_campaign.hpp"

using namespace identify;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

namespace {

/// How well axes are known, isotropic and independent.
struct Doubt {
  double direction_rad = 0;
  double point_mm = 0;
  double target_mm = 0;
};

/// The base of an arm that stands somewhere in the measurement frame, turned in no simple way.
Eigen::Isometry3d somewhere() {
  return Eigen::Translation3d(1200, -700, 300) *
         Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized());
}

/// The chain of a DH table that stands at its thetas.
Chain chain_of(const std::vector<DhRow>& rows, const std::vector<int>& positive,
               const Eigen::Isometry3d& base, const Vector3d& tool_mm) {
  Chain chain;
  Eigen::Isometry3d frame = base;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    chain.axes.push_back({positive[j] * frame.linear().col(2), frame.translation()});
    frame = frame * transform(rows[j]);
  }
  chain.targets_mm = {frame * tool_mm};
  chain.tool = frame.linear();
  return chain;
}

/// As the estimators measure an arm.
double size_of(const Chain& chain) {
  double size = 0;
  auto places = chain.targets_mm;
  for (const ChainAxis& axis : chain.axes)
    places.push_back(Line::through(axis.point_mm, axis.direction).closest_mm(places.front()));
  for (const Vector3d& a : places)
    for (const Vector3d& b : places) size = std::max(size, (a - b).norm());
  return size;
}

std::vector<std::optional<Axis>> z_axes(const Chain& chain, const std::vector<int>& positive,
                                        const MatrixXd& covariance) {
  std::vector<std::optional<Axis>> axes;
  for (std::size_t j = 0; j < chain.axes.size(); ++j) {
    // As from a circle: the point is where the target comes closest.
    const Line line = Line::through(chain.axes[j].point_mm, chain.axes[j].direction);
    Axis axis{chain.axes[j].direction, line.closest_mm(chain.targets_mm.front())};
    const auto at = static_cast<Eigen::Index>(6 * j);
    if (covariance.size() > 0) axis.covariance = covariance.block<6, 6>(at, at);
    axes.push_back(positive[j] < 0 ? axis.reversed() : axis);
  }
  return axes;
}

MatrixXd covariance_of(const Chain& chain, const Doubt& doubt) {
  const auto joints = static_cast<Eigen::Index>(chain.axes.size());
  MatrixXd covariance = MatrixXd::Zero(6 * joints + 3, 6 * joints + 3);
  for (Eigen::Index j = 0; j < joints; ++j) {
    const Vector3d& n = chain.axes[static_cast<std::size_t>(j)].direction;
    const Matrix3d across_it = Matrix3d::Identity() - n * n.transpose();
    covariance.block<3, 3>(6 * j, 6 * j) = doubt.direction_rad * doubt.direction_rad * across_it;
    covariance.block<3, 3>(6 * j + 3, 6 * j + 3) = doubt.point_mm * doubt.point_mm * across_it;
  }
  covariance.bottomRightCorner<3, 3>() = doubt.target_mm * doubt.target_mm * Matrix3d::Identity();
  return covariance;
}

/// What the estimator would hand over for this chain.
ModelSource source_of(Chain chain, const std::vector<int>& positive, const Doubt& doubt = {}) {
  for (ChainAxis& axis : chain.axes)
    axis.point_mm = Line::through(axis.point_mm, axis.direction).closest_mm(chain.targets_mm[0]);
  const MatrixXd covariance = covariance_of(chain, doubt);
  // Independent axes: the same for reversed ones.
  const MatrixXd of_z = covariance.topLeftCorner(static_cast<Eigen::Index>(6 * chain.axes.size()),
                                                 static_cast<Eigen::Index>(6 * chain.axes.size()));
  const auto dh = extract_dh(z_axes(chain, positive, covariance), size_of(chain), {}, of_z);
  ModelSource source{std::move(chain), positive, dh, covariance, {}, true};
  for (std::size_t j = 0; j < positive.size(); ++j)
    source.home_rad.push_back(0.3 * static_cast<double>(j) - 1);
  return source;
}

/// 1,000 poses, home among them.
const std::vector<Turns>& poses() {
  static const std::vector<Turns> all = [] {
    std::mt19937 random(7);
    std::uniform_real_distribution<> angle(-kPi, kPi);
    std::vector<Turns> turns(1000);
    for (std::size_t k = 1; k < turns.size(); ++k)
      for (std::size_t j = 0; j < 7; ++j) turns[k][j] = angle(random);
    return turns;
  }();
  return all;
}

/// Where the tool is at each of them.
std::vector<Eigen::Isometry3d> tool_poses(const Chain& chain) {
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
  tool.linear() = chain.tool;
  tool.translation() = chain.targets_mm.front();
  std::vector<Eigen::Isometry3d> all;
  for (const Turns& turns : poses()) all.push_back(chain.displacement(turns) * tool);
  return all;
}

/// Acceptance: 1e-9 m at 1,000 random poses, and nothing beyond the arm's reach is identified.
/// Where the first axes are parallel, offsets count from a point `away_mm` from the arm.
void check_models(const ModelSource& source, double away_mm = 0) {
  const auto models = kinematic_models(source);
  REQUIRE(models.size() == kModelForms.size());
  const auto expected = tool_poses(source.chain);
  const double reach = 2 * size_of(source.chain) + away_mm;
  for (const KinematicModel& model : models) {
    INFO(text(model.form));
    REQUIRE(model.joints() == source.chain.axes.size());
    double worst_mm = 0;
    double worst_rotation = 0;
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const Eigen::Isometry3d pose = forward_kinematics(model, poses()[k]);
      worst_mm = std::max(worst_mm, (pose.translation() - expected[k].translation()).norm());
      worst_rotation = std::max(worst_rotation, (pose.linear() - expected[k].linear()).norm());
    }
    CHECK(worst_mm < 1e-6);
    CHECK(worst_rotation < 1e-12);
    for (std::size_t g = 1; g + 1 < model.groups.size(); ++g)
      for (const ModelNumber& entry : model.groups[g]) {
        if (entry.quantity != Quantity::length || model.form == ModelForm::exponentials) continue;
        if (model.form == ModelForm::urdf && g == 1) continue;  // where the arm stands
        INFO(g << " " << entry.name << " = " << entry.number.value);
        CHECK((entry.number.knowledge != Knowledge::identified ||
               std::abs(entry.number.value) < reach));
      }
  }
}

DhNumber find(const KinematicModel& model, std::size_t group, std::string_view name) {
  for (const ModelNumber& entry : model.groups.at(group))
    if (entry.name == name) return entry.number;
  FAIL("no " << name << " in group " << group);
  return {};
}

bool has(const KinematicModel& model, std::size_t group, std::string_view name) {
  const auto& entries = model.groups.at(group);
  return std::any_of(entries.begin(), entries.end(),
                     [&](const ModelNumber& entry) { return entry.name == name; });
}

constexpr Doubt kTracker{5e-5, 0.01, 0.01};

}  // namespace

TEST_CASE("every form reproduces the exact KR 5", "[kinematic_model]") {
  const Arm arm = test::kr5_arc();
  for (const auto& base : {Eigen::Isometry3d::Identity(), somewhere()}) {
    const Chain chain = chain_of(arm.rows, arm.positive, base, arm.tool_mm);
    for (const auto& positive : {arm.positive, std::vector<int>(6, 1)}) {
      check_models(source_of(chain, positive));
      check_models(source_of(chain, positive, kTracker));
    }
  }
}

TEST_CASE("every form reproduces axes 2 and 3 with a twist from 0 to 1 degree",
          "[kinematic_model][long]") {
  const Arm arm = test::kr5_arc();
  const Chain chain = chain_of(arm.rows, arm.positive, somewhere(), arm.tool_mm);
  const Vector3d normal = (chain.axes[2].point_mm - chain.axes[1].point_mm).normalized();
  const Vector3d center = chain.axes[2].point_mm;
  std::set<Relation> relations;
  for (const double twist_deg : {0.0, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.02, 0.05,
                                 0.1, 0.2,  0.3,  0.4,  0.5,  0.6,  0.7,  0.8,  0.9,  1.0})
    // About the common normal, where its foot stays, and further and further from it.
    for (const double off_normal_deg : {0.0, 1e-3, 30.0}) {
      const Vector3d about =
          Eigen::AngleAxisd(off_normal_deg * kDegree, chain.axes[2].direction) * normal;
      const Eigen::AngleAxisd tilt(twist_deg * kDegree, about);
      Chain tilted = chain;
      for (std::size_t j = 2; j < 6; ++j) {
        tilted.axes[j].direction = (tilt * chain.axes[j].direction).normalized();
        tilted.axes[j].point_mm = center + tilt * (chain.axes[j].point_mm - center);
      }
      // Parallel by reach alone far from the normal: doubt changes nothing there.
      const std::vector<Doubt> exact = {{}};
      const std::vector<Doubt> any = {{}, {1e-6, 1e-3, 1e-3}, kTracker};
      for (const Doubt& doubt : off_normal_deg > 1 ? exact : any) {
        CAPTURE(twist_deg, off_normal_deg, doubt.direction_rad);
        const ModelSource source = source_of(tilted, arm.positive, doubt);
        relations.insert(source.dh[1].relation);
        check_models(source);
      }
    }
  CHECK(relations == std::set{Relation::skew, Relation::parallel});
}

TEST_CASE("every form reproduces arms of one to seven joints, whatever their relations",
          "[kinematic_model][long]") {
  constexpr double kRight = 90 * kDegree;
  const std::vector<std::vector<DhRow>> arms = {
      {{0, 0, 0, 0}},
      // Palletizer: parallel and antiparallel.
      {{400, 0.3, 150, kRight}, {0, 1, 500, 0}, {0, -1, 450, 2 * kRight}, {90, 0.4, 0, 0}},
      // Scara: all parallel, the last two coincident.
      {{0, 0.1, 325, 0}, {0, 0.2, 225, 0}, {0, 0, 0, 0}, {0, 0.7, 0, 0}},
      // Coincident and antiparallel along one line, then meeting axes.
      {{100, 0.3, 0, 2 * kRight},
       {200, 0.2, 0, 0},
       {300, 1, 0, kRight},
       {0, 2, 0, -kRight},
       {50, 0.6, 0, 0}},
      // All axes meet the next, as in arms of seven joints.
      {{340, 0.1, 0, kRight},
       {0, 0.2, 0, -kRight},
       {400, 0.3, 0, -kRight},
       {0, 0.4, 0, kRight},
       {400, 0.5, 0, kRight},
       {0, 0.6, 0, -kRight},
       {126, 0.7, 0, 0}},
      // Nothing special.
      {{100, 1, -200, 1.1},
       {-80, 2, 300, -0.7},
       {60, -2, 50, 2.6},
       {250, 0.5, 120, 0.4},
       {-30, 1.5, 75, -1.3}}};
  for (std::size_t k = 0; k < arms.size(); ++k)
    for (const auto& base : {Eigen::Isometry3d::Identity(), somewhere()})
      for (const Doubt& doubt : {Doubt{}, kTracker})
        for (const bool alternate : {false, true}) {
          CAPTURE(k, doubt.direction_rad, alternate);
          std::vector<int> positive(arms[k].size(), 1);
          if (alternate)
            for (std::size_t j = 0; j < positive.size(); j += 2) positive[j] = -1;
          check_models(source_of(chain_of(arms[k], positive, base, {60, 20, 150}), positive, doubt),
                       base.translation().norm());
        }
}

TEST_CASE("every form reproduces axes that are nearly coincident", "[kinematic_model]") {
  std::mt19937 random(3);
  std::normal_distribution<> normal;
  for (int run = 0; run < 10; ++run) {
    const std::vector<int> positive(4, 1);
    Chain chain = chain_of({{100, 0.2, 0, 0}, {200, 0.2, 0, 1}, {300, 1, 0, 1}, {0, 2, 0, 0}},
                           positive, somewhere(), {60, 20, 150});
    for (ChainAxis& axis : chain.axes) {
      axis.direction =
          (axis.direction + 2e-5 * Vector3d(normal(random), normal(random), normal(random)))
              .normalized();
      axis.point_mm += 5e-3 * Vector3d(normal(random), normal(random), normal(random));
    }
    const ModelSource source = source_of(chain, positive, kTracker);
    CHECK(source.dh[0].relation == Relation::coincident);
    check_models(source, somewhere().translation().norm());
  }
}

TEST_CASE("every form reproduces an arm whose target lies on an axis", "[kinematic_model]") {
  const Arm arm = test::kr5_arc();
  const ModelSource source =
      source_of(chain_of(arm.rows, arm.positive, somewhere(), {0, 0, 215}), arm.positive, kTracker);
  check_models(source);
  const auto models = kinematic_models(source);
  const KinematicModel& stone = models[3];
  REQUIRE(stone.form == ModelForm::s_model);
  CHECK(find(stone, 5, "gamma").knowledge == Knowledge::by_convention);
  CHECK(find(stone, 5, "b").knowledge == Knowledge::identified);
}

TEST_CASE("roll, pitch and yaw reproduce frames whose pitch is at a right angle, or almost",
          "[kinematic_model]") {
  for (const double pitch : {90 * kDegree, -90 * kDegree})
    for (const double off : {0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-5, 2e-3, 0.1}) {
      CAPTURE(pitch, off);
      Chain chain;
      chain.axes = {{Vector3d::UnitZ(), {0, 0, 0}}, {Vector3d::UnitY(), {200, 0, 500}}};
      chain.targets_mm = {{700, 100, 300}};
      chain.tool = (Eigen::AngleAxisd(0.4, Vector3d::UnitZ()) *
                    Eigen::AngleAxisd(pitch - off, Vector3d::UnitY()) *
                    Eigen::AngleAxisd(-1.9, Vector3d::UnitX()))
                       .matrix();
      // The tool's frame is seen from that of the last axis: turn this one into the base's.
      const ModelSource source = source_of(chain, {1, 1}, kTracker);
      const Matrix3d last =
          forward_kinematics_without_tool(kinematic_models(source)[5], {}).linear();
      chain.tool = last * chain.tool;
      const ModelSource locked = source_of(chain, {1, 1}, kTracker);
      check_models(locked);
      const auto yaw = find(kinematic_models(locked)[5], 3, "yaw");
      CHECK(yaw.knowledge == (off < 1e-3 ? Knowledge::by_convention : Knowledge::identified));
    }
}

TEST_CASE("DH numbers and their uncertainties are those of the table", "[kinematic_model]") {
  const Arm arm = test::kr5_arc();
  const ModelSource source =
      source_of(chain_of(arm.rows, arm.positive, somewhere(), arm.tool_mm), arm.positive, kTracker);
  const auto models = kinematic_models(source);
  const auto same = [](const DhNumber& number, const DhNumber& other) {
    return number.value == other.value && number.sigma == other.sigma &&
           number.knowledge == other.knowledge;
  };
  for (std::size_t i = 0; i < 6; ++i) {
    const DhEstimate& row = source.dh[i];
    for (const std::size_t form : {0u, 2u}) {
      CHECK(same(find(models[form], i + 1, "theta"), row.theta_rad));
      CHECK(same(find(models[form], i + 1, "a"), row.a_mm));
      CHECK(same(find(models[form], i + 1, "alpha"), row.alpha_rad));
    }
    CHECK(same(find(models[0], i + 1, "b"), row.b_mm));
    CHECK(same(find(models[0], i + 1, "beta"), row.beta_rad));
    CHECK(same(find(models[1], i + 1, "theta"), row.theta_rad));
    if (i > 0) CHECK(same(find(models[1], i + 1, "alpha"), source.dh[i - 1].alpha_rad));
    const bool parallel = row.relation == Relation::parallel;
    CHECK(parallel == (i == 1));
    CHECK(models[2].groups[i + 1].size() == 5);  // four numbers, and the sense
    CHECK(has(models[2], i + 1, "beta") == parallel);
    CHECK(has(models[2], i + 1, "b") != parallel);
    CHECK(has(models[3], i + 1, "hayati_beta") == parallel);
  }
}

TEST_CASE("what the data do not determine is by convention in every form", "[kinematic_model]") {
  const Arm arm = test::kr5_arc();
  ModelSource source =
      source_of(chain_of(arm.rows, arm.positive, somewhere(), arm.tool_mm), arm.positive, kTracker);
  source.tool_identified = false;
  for (const KinematicModel& model : kinematic_models(source)) {
    INFO(text(model.form));
    const std::size_t tool = model.groups.size() - 1;
    const bool urdf = model.form == ModelForm::urdf;
    CHECK(find(model, tool, urdf ? "pitch" : "r22").knowledge == Knowledge::by_convention);
    CHECK(find(model, tool, "x").knowledge == Knowledge::identified);
    for (const auto& group : model.groups)
      for (const ModelNumber& entry : group) {
        INFO(entry.name);
        CHECK((entry.number.knowledge == Knowledge::identified) == (entry.number.sigma > 0));
      }
  }
  const auto models = kinematic_models(source);
  CHECK(find(models[0], 2, "b").knowledge == Knowledge::by_convention);
  CHECK(find(models[3], 2, "d").knowledge == Knowledge::by_convention);
  CHECK(find(models[5], 3, "z").knowledge == Knowledge::by_convention);
}

TEST_CASE("uncertainties of every form are the scatter that uncertain axes cause",
          "[kinematic_model][long]") {
  const Arm arm = test::kr5_arc();
  Chain chain = chain_of(arm.rows, arm.positive, somewhere(), arm.tool_mm);
  chain.tool = chain.tool * Eigen::AngleAxisd(1.2, Vector3d(1, -3, 2).normalized()).matrix();
  ModelSource source = source_of(chain, arm.positive, kTracker);
  // The tool's orientation is uncertain too.
  const Eigen::Index count = source.covariance.rows();
  source.covariance.conservativeResize(count + 3, count + 3);
  source.covariance.bottomRows<3>().setZero();
  source.covariance.rightCols<3>().setZero();
  source.covariance.bottomRightCorner<3, 3>() = 1e-8 * Matrix3d::Identity();
  const auto predicted = kinematic_models(source);

  constexpr int kRuns = 500;
  std::mt19937 random(5);
  std::normal_distribution<> normal;
  const auto noise = [&](double sigma) -> Vector3d {
    return sigma * Vector3d(normal(random), normal(random), normal(random));
  };
  std::vector<std::vector<double>> squares(predicted.size());
  for (int run = 0; run < kRuns; ++run) {
    Chain moved = source.chain;
    for (ChainAxis& axis : moved.axes) {
      axis.point_mm += noise(kTracker.point_mm);
      axis.direction =
          (axis.direction + noise(kTracker.direction_rad).cross(axis.direction)).normalized();
    }
    moved.targets_mm[0] += noise(kTracker.target_mm);
    const Vector3d turn = noise(1e-4);
    moved.tool = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * moved.tool;
    const auto models = kinematic_models(source_of(moved, arm.positive, kTracker));
    for (std::size_t m = 0; m < models.size(); ++m) {
      std::size_t k = 0;
      for (std::size_t g = 0; g < models[m].groups.size(); ++g)
        for (std::size_t e = 0; e < models[m].groups[g].size(); ++e, ++k) {
          squares[m].resize(std::max(squares[m].size(), k + 1));
          const double change =
              models[m].groups[g][e].number.value - predicted[m].groups[g][e].number.value;
          const double wrapped_change =
              predicted[m].groups[g][e].quantity == Quantity::angle ? wrapped(change) : change;
          squares[m][k] += wrapped_change * wrapped_change / kRuns;
        }
    }
  }
  for (std::size_t m = 0; m < predicted.size(); ++m) {
    std::size_t k = 0;
    for (std::size_t g = 0; g < predicted[m].groups.size(); ++g)
      for (const ModelNumber& entry : predicted[m].groups[g]) {
        const double scatter = std::sqrt(squares[m][k++]);
        if (entry.number.knowledge != Knowledge::identified) continue;
        INFO(text(predicted[m].form) << " group " << g << " " << entry.name);
        // 500 runs give a standard deviation to +-3 % (1 sigma); some 250 numbers. What is zero to
        // first order (as r33 = 1) scatters in second.
        if (entry.number.sigma > 1e-6)
          CHECK(scatter / entry.number.sigma == Approx(1).margin(0.13));
      }
  }
}

TEST_CASE("there are no models of a table with gaps, and no uncertainties without a covariance",
          "[kinematic_model]") {
  const Arm arm = test::kr5_arc();
  ModelSource source =
      source_of(chain_of(arm.rows, arm.positive, somewhere(), arm.tool_mm), arm.positive, kTracker);
  source.covariance.resize(0, 0);
  source.home_rad.clear();
  const auto models = kinematic_models(source);
  REQUIRE(models.size() == kModelForms.size());
  CHECK(find(models[4], 1, "wx").sigma == 0);
  CHECK(find(models[5], 1, "home").value == 0);

  source.dh[2].b_mm.knowledge = Knowledge::undetermined;
  CHECK(kinematic_models(source).empty());
  CHECK(kinematic_models({}).empty());
}
