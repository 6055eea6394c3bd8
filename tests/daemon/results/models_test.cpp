#include "daemon/results/models.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <sstream>

#include <nlohmann/json.hpp>

#include "daemon/results/result_files.hpp"
#include "daemon/results/result_formats.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/chain_outcomes.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/daemon/texts.hpp"

using namespace sweepd;
using namespace sweepd::test;
using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;
using OrderedJson = nlohmann::ordered_json;

namespace {

/// A model as a reader of the file has it: the numbers of each joint by name; angles in radians.
struct Read {
  std::map<int, std::map<std::string, double>> joints;

  double operator()(int joint, const std::string& name) const {
    const auto& numbers = joints.at(joint);
    const auto at = numbers.find(name);
    return at == numbers.end() ? 0 : at->second;
  }
};

std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> all(1);
  for (const char c : line)
    if (c == ',')
      all.emplace_back();
    else
      all.back() += c;
  return all;
}

std::map<std::string, Read> read(const std::string& csv) {
  std::map<std::string, Read> models;
  std::istringstream stream(csv);
  std::string line;
  std::getline(stream, line);
  CHECK(line == "model,joint,parameter,value,unit,sigma,low_95,high_95,knowledge");
  while (std::getline(stream, line)) {
    const auto row = fields(line);
    REQUIRE(row.size() == 9);
    const double unit = row[4] == "deg" ? kPi / 180 : 1;
    models[row[0]].joints[std::stoi(row[1])][row[2]] = unit * number_in(row[3]);
  }
  return models;
}

Isometry3d turn_about(double angle, int axis) {
  return Isometry3d(AngleAxisd(angle, Vector3d::Unit(axis)));
}
Isometry3d along(double x, double y, double z) {
  return Isometry3d(Translation3d(x, y, z));
}

Isometry3d matrix(const Read& model, int joint) {
  Isometry3d pose = Isometry3d::Identity();
  if (!model.joints.contains(joint)) return pose;
  const std::string digits = "123";
  for (Eigen::Index i = 0; i < 3; ++i) {
    pose.translation()(i) = model(joint, std::string(1, "xyz"[i]));
    for (Eigen::Index k = 0; k < 3; ++k)
      pose.linear()(i, k) = model(joint, std::string("r") + "123"[i] + "123"[k]);
  }
  return pose;
}

Isometry3d urdf_origin(const Read& model, int joint) {
  return along(model(joint, "x"), model(joint, "y"), model(joint, "z")) *
         turn_about(model(joint, "yaw"), 2) * turn_about(model(joint, "pitch"), 1) *
         turn_about(model(joint, "roll"), 0);
}

/// Formulas as in the documentation of the file, written apart from those of the program.
Isometry3d kinematics(const std::string& form, const Read& m, const identify::Turns& turns) {
  const bool urdf = form == "urdf";
  Isometry3d pose = urdf ? Isometry3d::Identity() : matrix(m, 0);
  for (int i = 1; i <= 6; ++i) {
    const double turn = turns[static_cast<std::size_t>(i - 1)];
    const double q = m(i, "positive") * turn;
    if (form == "dh" || form == "hayati")
      pose = pose * along(0, 0, m(i, "b")) * turn_about(m(i, "theta") + q, 2) *
             along(m(i, "a"), 0, 0) * turn_about(m(i, "alpha"), 0) * turn_about(m(i, "beta"), 1);
    if (form == "modified_dh")
      pose = pose * turn_about(m(i, "alpha"), 0) * along(m(i, "a"), 0, 0) *
             turn_about(m(i, "beta"), 1) * turn_about(m(i, "theta") + q, 2) *
             along(0, 0, m(i, "b"));
    if (form == "s_model")
      pose = pose * turn_about(q, 2) * turn_about(m(i, "beta"), 2) * along(0, 0, m(i, "d")) *
             along(m(i, "a"), 0, 0) * turn_about(m(i, "alpha"), 0) *
             turn_about(m(i, "hayati_beta"), 1) * turn_about(m(i, "gamma"), 2) *
             along(0, 0, m(i, "b"));
    if (form == "exponentials") {
      // exp of the twist by the series' closed form (Modern Robotics, eq. 3.88).
      const Vector3d w(m(i, "wx"), m(i, "wy"), m(i, "wz"));
      const Vector3d v(m(i, "vx"), m(i, "vy"), m(i, "vz"));
      Eigen::Matrix3d cross;
      cross << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
      Isometry3d screw = turn_about(0, 0);
      screw.linear() += std::sin(turn) * cross + (1 - std::cos(turn)) * cross * cross;
      screw.translation() =
          turn * v + (1 - std::cos(turn)) * cross * v + (turn - std::sin(turn)) * cross * cross * v;
      pose = pose * screw;
    }
    if (urdf)
      pose = pose * urdf_origin(m, i) * turn_about(m(i, "axis_z") * (m(i, "home") + turn), 2);
  }
  return pose * (urdf ? urdf_origin(m, 7) : matrix(m, 7));
}

}  // namespace

TEST_CASE("every model read back from models.csv moves as the chain to 1e-9 m", "[models]") {
  const Outcome outcome = chain_outcome();
  const auto models = read(models_csv(models_of(outcome)));
  CHECK(models.size() == 6);
  for (const auto& [form, model] : models) {
    INFO(form);
    std::mt19937 random(11);
    double worst_mm = 0;
    double worst_rotation = 0;
    for (int k = 0; k < 1000; ++k) {
      const auto turns = random_turns(random);
      const auto pose = kinematics(form, model, turns);
      worst_mm = std::max(worst_mm, misfit_mm(outcome, turns, pose));
      worst_rotation = std::max(worst_rotation, misfit_of_rotation(outcome, turns, pose));
    }
    CHECK(worst_mm < 1e-6);
    CHECK(worst_rotation < 1e-12);
  }
}

TEST_CASE("models.csv has an interval for what is identified, and none for conventions",
          "[models]") {
  const auto csv = models_csv(models_of(chain_outcome()));
  std::istringstream stream(csv);
  std::string line;
  std::getline(stream, line);
  int identified = 0;
  while (std::getline(stream, line)) {
    const auto row = fields(line);
    INFO(line);
    CHECK(row[3] != "-0");
    if (row[8] == "by_convention") {
      CHECK((row[5].empty() && row[6].empty() && row[7].empty()));
      continue;
    }
    ++identified;
    REQUIRE(row[8] == "identified");
    if (row[5].empty()) {
      // Yaw of joint 1: X of the first frame lies above that of the measurement frame, and home is
      // a quarter turn.
      CHECK(line == "urdf,1,yaw,90,deg,,,,identified");
      continue;
    }
    const double value = number_in(row[3]);
    const double sigma = number_in(row[5]);
    CHECK(sigma > 0);
    CHECK(number_in(row[6]) == Approx(value - 1.96 * sigma).margin(1e-9));
    CHECK(number_in(row[7]) == Approx(value + 1.96 * sigma).margin(1e-9));
  }
  CHECK(identified > 100);
  CHECK_THAT(csv, Catch::Matchers::ContainsSubstring("\ndh,2,b,0,mm,,,,by_convention\n"));
  CHECK_THAT(csv, Catch::Matchers::ContainsSubstring("\ndh,1,positive,-1,1,,,,by_convention\n"));
}

TEST_CASE("there are no models without a chain, of another estimator or with gaps", "[models]") {
  CHECK(models_of(Outcome{}).empty());
  Outcome by_circles = chain_outcome();
  by_circles.identification.estimator = identify::Estimator::circle;
  CHECK(models_of(by_circles).empty());
  Outcome with_gap = chain_outcome();
  with_gap.identification.chain->dh[3].a_mm.knowledge = identify::Knowledge::undetermined;
  CHECK(models_of(with_gap).empty());
}

TEST_CASE("the models of result.json have every form, in full precision", "[models]") {
  const Outcome outcome = chain_outcome();
  const auto json = OrderedJson::parse(result_json(outcome)).at("models");
  REQUIRE(json.size() == 6);
  for (const char* form : {"dh", "modified_dh", "hayati", "s_model", "exponentials", "urdf"}) {
    INFO(form);
    CHECK(json.at(form).at("joints").size() == 6);
    CHECK(json.at(form).contains("tool"));
  }
  CHECK(json.at("dh").contains("base"));
  CHECK_FALSE(json.at("exponentials").contains("base"));
  const auto& row = outcome.identification.dh[2];
  const auto& joint = json.at("dh").at("joints").at(2);
  CHECK(joint.at("joint") == 3);
  CHECK(joint.at("a_mm").get<double>() == row.a_mm.value);
  CHECK(joint.at("theta_deg").get<double>() == degrees(row.theta_rad.value));
  CHECK(joint.at("a_sigma_mm").get<double>() == row.a_mm.sigma);
  CHECK(joint.at("by_convention") == OrderedJson{"beta_deg", "positive"});
  CHECK_FALSE(joint.contains("beta_sigma_deg"));
}

TEST_CASE("a complete chain leaves robot.urdf, dh.tex and models.csv; another takes them away",
          "[models]") {
  const TemporaryFolder folder;
  Outcome outcome = chain_outcome();
  const auto there = [&](const char* name) { return std::filesystem::exists(folder / name); };
  write_result(folder.path(), outcome);
  for (const char* name : {"robot.urdf", "dh.tex", "models.csv", "result.json"}) CHECK(there(name));
  outcome.identification.estimator = identify::Estimator::circle;
  write_result(folder.path(), outcome);
  for (const char* name : {"robot.urdf", "dh.tex", "models.csv"}) CHECK_FALSE(there(name));
  CHECK_FALSE(OrderedJson::parse(result_json(outcome)).contains("models"));
}
