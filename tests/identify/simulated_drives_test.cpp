#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "tests/catch.hpp"
#include "tests/identify/simulated_robots.hpp"
#include "tests/simulation/arc_shape.hpp"
#include "tests/simulation/gravity.hpp"
#include "tests/simulation/stream.hpp"

using namespace simulation;
using namespace simulation::robots;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using Eigen::Vector3d;
using identify::Sample;
using identify::Sweep;

TEST_CASE("Gears err by two harmonics of the joint's angle, locked joints at other homes as well",
          "[simulated_drives]") {
  World world = exact_angles();
  world.gears.first_arcsec = 60;
  world.gears.second_arcsec = 30;
  const Robot arm = robot(9);
  Strokes how = strokes(20);
  how.homes = 2;
  const Simulation simulation(arm, how, world, 9);
  constexpr int kPlaces = 36;
  for (std::size_t j = 0; j < 6; ++j) {
    std::array<std::complex<double>, 4> waves{};
    for (int i = 0; i < kPlaces; ++i) {
      auto angles = arm.arm.home_rad;
      angles[j] += 2 * kPi * i / kPlaces;
      const double off = arm.arm.positive[j] * (simulation.arm_at(angles).rows[j].theta_rad -
                                                arm.arm.rows[j].theta_rad) -
                         (angles[j] - arm.arm.home_rad[j]);
      for (std::size_t m = 0; m < waves.size(); ++m)
        waves[m] += off * std::polar(2.0 / kPlaces, 2 * kPi * static_cast<double>(m) * i / kPlaces);
    }
    CHECK_THAT(std::abs(waves[0]), WithinAbs(0, 1e-12));
    CHECK_THAT(std::abs(waves[1]), WithinRel(60 * kArcsec, 1e-6));
    CHECK_THAT(std::abs(waves[2]), WithinRel(30 * kArcsec, 1e-6));
    CHECK_THAT(std::abs(waves[3]), WithinAbs(0, 1e-12));
  }
  for (const Sweep& sweep : simulation.sweeps())
    for (const Sample& sample : *sweep.samples) {
      const auto angles = angles_of(sample);
      const auto standing = simulation.arm_at(angles);
      CHECK(
          (identify::forward_kinematics(standing, angles) * arm.targets_mm[0] - sample.position_mm)
              .norm() < 1e-9);
    }
}

TEST_CASE("Backlash is the difference between the two ways", "[simulated_drives]") {
  World world = exact_angles();
  world.gears.backlash_arcsec = 30;
  Strokes how = strokes(11);
  how.there_and_back = true;
  const Robot arm = robot(10);
  const auto sweeps = Simulation(arm, how, world, 10).sweeps();
  REQUIRE(sweeps.size() == 12);
  for (std::size_t s = 0; s < sweeps.size(); s += 2) {
    const Sweep& rising = sweeps[s].direction > 0 ? sweeps[s] : sweeps[s + 1];
    const Sweep& falling = sweeps[s].direction > 0 ? sweeps[s + 1] : sweeps[s];
    CHECK(falling.direction == -1);
    const identify::Chain chain = chain_of(arm);
    const identify::ChainAxis& axis = chain.axes[*rising.joint];
    const double radius = axis.direction.cross(chain.targets_mm[0] - axis.point_mm).norm();
    for (std::size_t i = 0; i < 11; ++i)
      CHECK_THAT(((*rising.samples)[i].position_mm - (*falling.samples)[10 - i].position_mm).norm(),
                 WithinRel(30 * kArcsec * radius, 1e-3));
  }
}

TEST_CASE("Torques are what lifts the weights, and none about a vertical axis",
          "[simulated_drives]") {
  for (const Robot& arm : {robot(11), at_random_home(iiwa(), 11)}) {
    const Sag sag(arm, 100 * kArcsec);
    const auto energy_j = [&](const identify::Turns& turns) {
      double sum = 0;
      Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
      for (std::size_t k = 0; k < arm.arm.joints(); ++k) {
        auto row = arm.arm.rows[k];
        row.theta_rad += arm.arm.positive[k] * turns[k];
        frame = frame * identify::transform(row);
        sum += 9.81 * arm.links[k].mass_kg * (frame * arm.links[k].center_mm).z() / 1000;
      }
      return sum;
    };
    const identify::Turns turns = {0.3, -0.2, 0.4, 0.5, -0.6, 0.7, 0.1};
    const identify::Turns torques = sag.torques(turns);
    CHECK_THAT(torques[0], WithinAbs(0, 1e-9));
    for (std::size_t j = 0; j < arm.arm.joints(); ++j) {
      identify::Turns above = turns, below = turns;
      above[j] += 1e-5;
      below[j] -= 1e-5;
      CHECK_THAT(torques[j], WithinAbs((energy_j(below) - energy_j(above)) / 2e-5, 1e-5));
    }
  }
}

TEST_CASE("Elastic joints give way in proportion to the torque", "[simulated_drives]") {
  const Robot arm = robot(12);
  const Sag sag(arm, 100 * kArcsec);
  double worst = 0;
  for (double turn = -3; turn < 3; turn += 0.1)
    for (double other = -3; other < 3; other += 0.1) {
      const identify::Turns turns = {0, turn, other};
      const auto bent = sag.at(turns);
      const auto torques = sag.torques(turns);
      CHECK(bent[0] == 0);
      CHECK(bent[3] == 0);
      CHECK_THAT(bent[1] * sag.torques({})[1], WithinAbs(torques[1] * sag.at({})[1], 1e-12));
      worst = std::max(worst, std::abs(bent[1]));
    }
  // The worst of some hundred poses is not quite the worst of all.
  CHECK(worst > 90 * kArcsec);
  CHECK(worst < 115 * kArcsec);
}

TEST_CASE("A robot that sags stands where its bent joints have it", "[simulated_drives]") {
  World world = exact_angles();
  world.sag_arcsec = 100;
  const Robot arm = robot(13);
  const Simulation simulation(arm, strokes(20), world, 13);
  double most = 0;
  for (const Sweep& sweep : simulation.sweeps())
    for (const Sample& sample : *sweep.samples) {
      const auto angles = angles_of(sample);
      CHECK((identify::forward_kinematics(simulation.arm_at(angles), angles) * arm.targets_mm[0] -
             sample.position_mm)
                .norm() < 1e-9);
      most = std::max(most, (by_table(arm, angles) - sample.position_mm).norm());
    }
  CHECK(most > 0.05);
}

TEST_CASE("Angles are late by the delay, and by the device's clock", "[simulated_drives]") {
  World world = exact_angles();
  world.delay = {0.1, 50};
  const Robot arm = robot(14);
  for (const Sweep& sweep : Simulation(arm, strokes(50), world, 14).sweeps())
    for (const Sample& sample : *sweep.samples) {
      auto angles = angles_of(sample);
      const double late_s = 0.1 + 50e-6 * sample.time_s;
      angles[*sweep.joint] += sweep.direction * 20 * kDegree * late_s;
      CHECK((by_table(arm, angles) - sample.position_mm).norm() < 1e-6);
    }
}

TEST_CASE("Arcs that are no circles depart by smooth curves of the size asked for, not at home",
          "[simulated_drives]") {
  const ArcShape shape{0.02, 2};
  auto random = stream(16, Source::shape);
  Spread all;
  for (int n = 0; n < 2000; ++n) {
    const ArcCurve curve(shape, -0.8, 0.8, random);
    CHECK(curve.at(0).isZero(0));
    const Vector3d at_start = curve.at(-0.8);
    CHECK((curve.at(-0.8 + 1e-6) - at_start).norm() < 1e-5);
    // Orders even and odd: differences across the arc know nothing of what home took away.
    const Vector3d across = curve.at(0.8) - at_start;
    for (const double one : across) all.add(one);
  }
  // Twice the odd orders: 4 (1 + 3^-4 + 5^-4 + 7^-4) over the sum of all orders' means.
  double odd = 0, mean = 1;
  for (int m = 1; m < 9; ++m) {
    mean += std::pow(m, -4.0) * (0.5 - 0.5 / (4 * m * m - 1));
    if (m % 2 == 1) odd += 4 * std::pow(m, -4.0);
  }
  CHECK_THAT(all.sigma(), WithinRel(0.02 * std::sqrt(odd / mean), all.tolerance()));

  World world = exact_angles();
  world.shape = shape;
  const Robot arm = robot(16);
  for (const Sweep& sweep : Simulation(arm, strokes(21), world, 16).sweeps()) {
    const Sample& home = (*sweep.samples)[10];
    CHECK((by_table(arm, angles_of(home)) - home.position_mm).norm() < 1e-9);
    const double off = (by_table(arm, angles_of(sweep.first())) - sweep.first().position_mm).norm();
    CHECK(off > 1e-4);
    CHECK(off < 0.5);
  }
}
