#include "tests/simulation/simulation.hpp"

#include <cmath>
#include <functional>

#include <Eigen/Dense>

#include "tests/catch.hpp"
#include "tests/identify/simulated_robots.hpp"
#include "tests/simulation/truth.hpp"

using namespace simulation;
using namespace simulation::robots;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using Eigen::Vector3d;
using identify::Sample;
using identify::Sweep;

namespace {

/// What the positions of `changed` have beyond those of `plain`, sample by sample.
void compare(const std::vector<Sweep>& plain, const std::vector<Sweep>& changed,
             const std::function<void(const Sweep&, std::size_t, const Vector3d&)>& see) {
  REQUIRE(plain.size() == changed.size());
  for (std::size_t s = 0; s < plain.size(); ++s)
    for (std::size_t i = 0; i < plain[s].samples->size(); ++i)
      see(plain[s], i, (*changed[s].samples)[i].position_mm - (*plain[s].samples)[i].position_mm);
}

}  // namespace

TEST_CASE("Without errors every sample is where the true arm's table has it", "[simulation]") {
  for (const Robot& arm : {robot(3, 3), at_random_home(built(iiwa(3), 3), 3)}) {
    const Simulation simulation(arm, strokes(20), exact_angles(), 3);
    for (const Sweep& sweep : simulation.sweeps())
      for (const Sample& sample : *sweep.samples)
        CHECK((by_table(arm, angles_of(sample), sweep.target) - sample.position_mm).norm() < 1e-9);
  }
}

TEST_CASE("What is identified of exact data is the true table", "[simulation]") {
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

TEST_CASE("The true table leads to the same axes whatever rows are called parallel",
          "[simulation]") {
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

TEST_CASE("The same seed gives the same bits, and a knob leaves other errors as they are",
          "[simulation]") {
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

TEST_CASE("Locked joints stand off home by turns about their own axes, anew each stroke",
          "[simulation]") {
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

TEST_CASE("Home errors that encoders see are in the angles", "[simulation]") {
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

TEST_CASE("Telegrams are rounded, and locked joints that do not wobble print one value",
          "[simulation]") {
  for (const int decimals : {4, 1}) {
    World world = exact_angles();
    world.controller = true;
    world.orientations = true;
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

TEST_CASE("Orientations of a controller are those of its tool", "[simulation]") {
  World world = exact_angles();
  world.controller = true;
  world.orientations = true;
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

TEST_CASE("A servo wobbles by what is asked for", "[simulation]") {
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
