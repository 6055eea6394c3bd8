#include "tests/simulation/simulation.hpp"

#include <cmath>
#include <functional>

#include <Eigen/Dense>

#include "tests/catch.hpp"
#include "tests/simulation/arc_shape.hpp"
#include "tests/simulation/device.hpp"
#include "tests/simulation/stream.hpp"
#include "tests/simulation/truth.hpp"

using namespace simulation;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using Eigen::Vector3d;
using identify::Sample;
using identify::Sweep;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegree = kPi / 180;

Robot robot(std::uint32_t seed = 1, std::size_t targets = 1) {
  return at_random_home(built(kr5(targets), seed), seed);
}

Strokes strokes(int samples) {
  Strokes how;
  how.samples = samples;
  return how;
}

/// Where the arm of a forward kinematics apart from the simulation's has its target, in the base.
Vector3d by_table(const Robot& robot, const std::vector<double>& angles, std::size_t target = 0) {
  return identify::forward_kinematics(robot.arm, angles) * robot.targets_mm[target];
}

std::vector<double> angles_of(const Sample& sample) {
  return {sample.angles_rad.begin(), sample.angles_rad.begin() + sample.joints};
}

/// Standard deviation of deviations from zero; of n of them it is known to 1 / sqrt(2 n).
struct Spread {
  double squares = 0;
  int count = 0;
  void add(double value) {
    squares += value * value;
    ++count;
  }
  [[nodiscard]] double sigma() const { return std::sqrt(squares / count); }
  [[nodiscard]] double tolerance() const { return 5 / std::sqrt(2.0 * count); }  // five sigma
};

World exact_angles() {
  World world;
  world.angles = true;
  return world;
}

/// What the positions of `changed` have beyond those of `plain`, sample by sample.
void compare(const std::vector<Sweep>& plain, const std::vector<Sweep>& changed,
             const std::function<void(const Sweep&, std::size_t, const Vector3d&)>& see) {
  REQUIRE(plain.size() == changed.size());
  for (std::size_t s = 0; s < plain.size(); ++s)
    for (std::size_t i = 0; i < plain[s].samples->size(); ++i)
      see(plain[s], i, (*changed[s].samples)[i].position_mm - (*plain[s].samples)[i].position_mm);
}

}  // namespace

TEST_CASE("Without errors every sample is where the true arm's table has it") {
  for (const Robot& arm : {robot(3, 3), at_random_home(built(iiwa(3), 3), 3)}) {
    const Simulation simulation(arm, strokes(20), exact_angles(), 3);
    for (const Sweep& sweep : simulation.sweeps())
      for (const Sample& sample : *sweep.samples)
        CHECK((by_table(arm, angles_of(sample), sweep.target) - sample.position_mm).norm() < 1e-9);
  }
}

TEST_CASE("What is identified of exact data is the true table") {
  const Robot arm = robot(4);
  const Simulation simulation(arm, strokes(60), exact_angles(), 4);
  const auto found = identify::identify(simulation.sweeps(), simulation.campaign());
  const auto truth = true_table(simulation, found.dh, found.home_rad);
  for (std::size_t j = 0; j + 1 < truth.size(); ++j) {
    CHECK_THAT(found.dh[j].a_mm.value, WithinAbs(truth[j].a_mm, 1e-5));
    CHECK_THAT(found.dh[j].b_mm.value,
               WithinAbs(truth[j].b_mm, 1e-3));  // rows 2 and 3 are parallel
    CHECK_THAT(found.dh[j].alpha_rad.value, WithinAbs(truth[j].alpha_rad, 1e-8));
    CHECK_THAT(identify::wrapped(found.dh[j].theta_rad.value - truth[j].theta_rad),
               WithinAbs(0, 1e-6));
  }
}

TEST_CASE("The true table leads to the same axes whatever rows are called parallel") {
  const Robot arm = robot(5);
  World world;
  world.placed = true;
  const Simulation simulation(arm, {}, world, 5);
  std::vector<identify::DhEstimate> found(6);
  found[1].relation = identify::Relation::parallel;
  const auto skew = true_table(simulation, {}, {});
  const auto parallel = true_table(simulation, found, {});
  CHECK(parallel[1].b_mm == 0);
  CHECK(std::abs(skew[1].b_mm) > 1e-3);
  CHECK_THAT(skew[1].beta_rad, WithinAbs(0, 1e-12));
  Eigen::Isometry3d a = Eigen::Isometry3d::Identity(), b = a;
  for (std::size_t j = 0; j < 5; ++j) {
    a = a * identify::transform(skew[j]);
    b = b * identify::transform(parallel[j]);
    CHECK((a.linear().col(2) - b.linear().col(2)).norm() < 1e-9);
    CHECK(a.linear().col(2).cross(a.translation() - b.translation()).norm() < 1e-6);
  }
}

TEST_CASE("The same seed gives the same bits, and a knob leaves other errors as they are") {
  World world = exact_angles();
  world.placed = true;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  const auto one = Simulation(robot(), strokes(50), world, 1).sweeps();
  compare(one, Simulation(robot(), strokes(50), world, 1).sweeps(),
          [](const Sweep&, std::size_t, const Vector3d& off) { CHECK(off.isZero(0)); });
  World drifting = world;
  drifting.drift.linear_mm = 1;
  compare(one, Simulation(robot(), strokes(50), drifting, 1).sweeps(),
          [](const Sweep&, std::size_t, const Vector3d& off) { CHECK(off.norm() < 1 + 1e-9); });
}

TEST_CASE("Random homes are off the grid, and keep targets off the axes") {
  for (std::uint32_t seed = 0; seed < 20; ++seed)
    for (const Robot& arm : {robot(seed, 3), at_random_home(built(iiwa(3), seed), seed)}) {
      const identify::Chain chain = chain_of(arm);
      for (std::size_t j = 0; j < arm.arm.joints(); ++j) {
        const double degrees = arm.arm.home_rad[j] / kDegree;
        CHECK(std::abs(degrees * 1e4 - std::round(degrees * 1e4)) > 1e-6);
        for (const Vector3d& target : chain.targets_mm)
          CHECK(chain.axes[j].direction.cross(target - chain.axes[j].point_mm).norm() > 80);
        CHECK(std::abs(arm.specified.rows[j].a_mm - arm.arm.rows[j].a_mm) < 3);  // six sigma
      }
    }
}

TEST_CASE("White and correlated noise are as large and as much alike as they should be") {
  for (const double correlation : {0.0, 0.9}) {
    Noise noise;
    noise.range_mm = noise.across_mm = 0.02;
    noise.correlation = correlation;
    Device device(noise, {}, 1, 7);
    Spread all;
    double products = 0;
    Vector3d before = Vector3d::Zero();
    constexpr int kCount = 100'000;
    for (int i = 0; i < kCount; ++i) {
      const Vector3d error = device.measured(Vector3d::Zero(), 0);
      for (const double one : error) all.add(one);
      products += error.dot(before);
      before = error;
    }
    CHECK_THAT(all.sigma(), WithinRel(0.02, 0.02));
    CHECK_THAT(products / all.squares, WithinAbs(correlation, 0.01));
  }
}

TEST_CASE("A tracker's noise lies along and across its line of sight") {
  Noise noise;
  noise.range_mm = 0.005;
  noise.across_mm = 0.03;
  const Vector3d point(1000, -2000, 500);
  const Vector3d sight = point.normalized();
  Device device(noise, {}, 1, 8);
  Spread along, across;
  for (int i = 0; i < 20'000; ++i) {
    const Vector3d error = device.measured(point, 0) - point;
    along.add(sight.dot(error));
    across.add(sight.unitOrthogonal().dot(error));
  }
  CHECK_THAT(along.sigma(), WithinRel(0.005, along.tolerance()));
  CHECK_THAT(across.sigma(), WithinRel(0.03, across.tolerance()));
}

TEST_CASE("Outliers are as many and as far off as asked for") {
  Noise noise;
  noise.outlier_share = 0.15;
  Device device(noise, {}, 1, 9);
  int count = 0;
  for (int i = 0; i < 10'000; ++i) {
    const double off = device.measured(Vector3d::Zero(), 0).norm();
    if (off == 0) continue;
    CHECK_THAT(off, WithinAbs(5, 1e-9));
    ++count;
  }
  CHECK(std::abs(count - 1500) < 5 * 36);
}

TEST_CASE("A device drifts by what is asked for over the campaign") {
  Device straight({}, {0.05, 0}, 100, 1);
  CHECK(straight.measured(Vector3d::Zero(), 0).isZero(0));
  CHECK_THAT(straight.measured(Vector3d::Zero(), 50).norm(), WithinAbs(0.025, 1e-12));
  CHECK_THAT(straight.measured(Vector3d::Zero(), 100).norm(), WithinAbs(0.05, 1e-12));
  Spread ends;
  for (std::uint32_t seed = 0; seed < 1000; ++seed) {
    Device walking({}, {0, 0.05}, 100, seed);
    Vector3d end;
    for (int i = 0; i <= 10; ++i) end = walking.measured(Vector3d::Zero(), 10 * i);
    for (const double one : end) ends.add(one);
  }
  CHECK_THAT(ends.sigma(), WithinRel(0.05 / std::sqrt(3.0), ends.tolerance()));
}

TEST_CASE("Locked joints stand off home by turns about their own axes, anew each stroke") {
  World world = exact_angles();
  world.home.sigma_deg = 0.002;
  const std::vector<double> sigma_rad(6, 0.002 * kDegree);
  std::vector<Spread> found(6);
  Spread left;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    const Robot arm = robot(seed, 3);
    Strokes how = strokes(5);
    how.targets_at_once = true;
    const Simulation simulation(arm, how, world, seed);
    const auto sweeps = simulation.sweeps();
    for (std::size_t s = 0; s < sweeps.size(); s += 3) {
      // Three targets tell all turns: by the derivative of the table, to first order.
      const std::size_t swept = *sweeps[s].joint;
      Eigen::MatrixXd by_turn(9, 6);
      Eigen::VectorXd off(9);
      const auto angles = angles_of(sweeps[s].samples->front());
      for (std::size_t t = 0; t < 3; ++t) {
        const auto row = static_cast<Eigen::Index>(3 * t);
        off.segment<3>(row) = sweeps[s + t].samples->front().position_mm - by_table(arm, angles, t);
        for (std::size_t k = 0; k < 6; ++k) {
          auto turned = angles;
          turned[k] += 1e-6;
          by_turn.block<3, 1>(row, static_cast<Eigen::Index>(k)) =
              (by_table(arm, turned, t) - by_table(arm, angles, t)) / 1e-6;
        }
      }
      const Eigen::VectorXd turns = by_turn.colPivHouseholderQr().solve(off);
      left.add((by_turn * turns - off).norm());
      for (std::size_t k = 0; k < 6; ++k)
        if (k == swept)
          CHECK_THAT(turns(static_cast<Eigen::Index>(k)),
                     WithinAbs(0, 3e-6));  // a tenth of sigma: second order
        else
          found[k].add(turns(static_cast<Eigen::Index>(k)));
    }
  }
  CHECK(left.sigma() < 1e-5);
  for (const Spread& spread : found)
    CHECK_THAT(spread.sigma(), WithinRel(0.002 * kDegree, spread.tolerance()));
}

TEST_CASE("Home errors that encoders see are in the angles") {
  World world = exact_angles();
  world.home.sigma_deg = 0.01;
  world.home.seen = true;
  world.home.stray_sigma_deg = 0.05;
  const Robot arm = robot(2);
  Spread errors;
  for (const Sweep& sweep : Simulation(arm, strokes(5), world, 2).sweeps())
    for (const Sample& sample : *sweep.samples) {
      CHECK((by_table(arm, angles_of(sample)) - sample.position_mm).norm() < 1e-9);
      for (std::size_t k = 0; k < 6; ++k)
        if (k != sweep.joint) errors.add(sample.angles_rad[k] - arm.arm.home_rad[k]);
    }
  CHECK(errors.sigma() > 0.01 * kDegree);
}

TEST_CASE("Telegrams are rounded, and locked joints that do not wobble print one value") {
  for (const int decimals : {4, 1}) {
    World world = exact_angles();
    world.controller = true;
    world.decimals = decimals;
    const double step = std::pow(10.0, -decimals);
    const Robot arm = robot(6);
    const Simulation simulation(arm, strokes(40), world, 6);
    CHECK_THAT(simulation.campaign().resolution.angle_rad, WithinRel(step * kDegree, 1e-12));
    for (const Sweep& sweep : simulation.sweeps())
      for (const Sample& sample : *sweep.samples) {
        const auto on_grid = [&](double value) {
          return std::abs(value / step - std::round(value / step)) < 1e-6;
        };
        for (const double value : sample.position_mm) CHECK(on_grid(value));
        for (const double value : sample.abc_rad) CHECK(on_grid(value / kDegree));
        for (std::size_t k = 0; k < 6; ++k) {
          CHECK(on_grid(sample.angles_rad[k] / kDegree));
          if (k == sweep.joint) continue;
          CHECK(sample.angles_rad[k] == sweep.first().angles_rad[k]);
          CHECK(std::abs(sample.angles_rad[k] - arm.arm.home_rad[k]) <= 0.5001 * step * kDegree);
        }
        // The position is of the joints as they are, not as they are printed.
        auto angles = arm.arm.home_rad;
        angles[*sweep.joint] = sample.angles_rad[*sweep.joint];
        const double tangential = 2000 * 0.5 * step * kDegree + step;  // within 2 m of the axis
        CHECK((by_table(arm, angles) - sample.position_mm).norm() < tangential);
      }
  }
}

TEST_CASE("Orientations of a controller are those of its tool") {
  World world = exact_angles();
  world.controller = true;
  const Robot arm = robot(7);
  for (const Sweep& sweep : Simulation(arm, strokes(5), world, 7).sweeps())
    for (const Sample& sample : *sweep.samples) {
      const auto [a, b, c] = sample.abc_rad;
      const Eigen::Matrix3d rotation =
          (Eigen::AngleAxisd(a, Vector3d::UnitZ()) * Eigen::AngleAxisd(b, Vector3d::UnitY()) *
           Eigen::AngleAxisd(c, Vector3d::UnitX()))
              .toRotationMatrix();
      const auto flange = identify::forward_kinematics(arm.arm, angles_of(sample));
      CHECK((rotation - flange.linear()).norm() < 1e-9);
    }
}

TEST_CASE("A servo wobbles by what is asked for") {
  World world = exact_angles();
  world.wobble_deg = 0.0005;
  const Robot arm = robot(8);
  Spread wobble;
  for (const Sweep& sweep : Simulation(arm, strokes(500), world, 8).sweeps())
    for (const Sample& sample : *sweep.samples) {
      CHECK((by_table(arm, angles_of(sample)) - sample.position_mm).norm() < 1e-9);
      for (std::size_t k = 0; k < 6; ++k)
        if (k != sweep.joint) wobble.add(sample.angles_rad[k] - arm.arm.home_rad[k]);
    }
  CHECK_THAT(wobble.sigma(), WithinRel(0.0005 * kDegree, wobble.tolerance()));
}
