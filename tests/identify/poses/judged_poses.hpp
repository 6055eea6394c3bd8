#pragma once

// Results of static poses against the truth, and poses of campaigns, for the tests of both.

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "identify/identification.hpp"
#include "tests/catch.hpp"
#include "tests/identify/poses/simulated_poses.hpp"
#include "tests/simulation/truth.hpp"

namespace simulation::robots {

struct Judged {
  int inside = 0;
  int numbers = 0;
  double squares = 0;   ///< of errors in standard uncertainties
  double farthest = 0;  ///< the largest of them
};

inline void judge(const Simulation& of, const identify::Identification& found, Judged& all) {
  const auto truth = true_table(of, found.dh, found.home_rad);
  for (std::size_t i = 0; i < found.dh.size(); ++i) {
    const identify::DhRow& row = truth[i];
    const std::array<double, 5> values{row.b_mm, row.theta_rad, row.a_mm, row.alpha_rad,
                                       row.beta_rad};
    const auto numbers = identify::numbers_of(found.dh[i]);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (numbers[k]->knowledge != identify::Knowledge::identified) continue;
      double error = numbers[k]->value - values[k];
      if (k == 1 || k == 3) error = identify::wrapped(error);
      const double z = error / numbers[k]->sigma;
      ++all.numbers;
      all.squares += z * z;
      all.farthest = std::max(all.farthest, std::abs(z));
      if (std::abs(z) < 1.96) ++all.inside;
    }
  }
}

inline double error_of(const Simulation& of, const identify::Identification& found) {
  const auto truth = true_table(of, found.dh, found.home_rad);
  double squares = 0;
  for (std::size_t i = 1; i + 1 < found.dh.size(); ++i) {
    if (found.dh[i].relation == identify::Relation::parallel ||
        found.dh[i - 1].relation == identify::Relation::parallel)
      continue;
    squares += std::pow(found.dh[i].b_mm.value - truth[i].b_mm, 2) +
               std::pow(found.dh[i].a_mm.value - truth[i].a_mm, 2);
  }
  return squares;
}

inline World with_gears(double arcsec) {
  World world = tracker();
  world.gears.first_arcsec = world.gears.second_arcsec = arcsec;
  return world;
}

/// Where a robot rests in a campaign of sweeps: at the ends of each, there twice, and at home.
inline std::vector<identify::Pose> rests(const Simulation& of) {
  std::vector<std::vector<double>> angles_rad;
  for (std::size_t j = 0; j < of.robot().arm.joints(); ++j) {
    auto at = of.robot().arm.home_rad;
    angles_rad.push_back(at);
    for (const double turn_deg : {-40.0, 45.0, -40.0}) {
      at[j] = of.robot().arm.home_rad[j] + turn_deg * kDegree;
      angles_rad.push_back(at);
    }
  }
  return of.poses_at(angles_rad);
}

/// Each target at each of so many rests.
inline std::vector<identify::Pose> seen_together(const Simulation& of, std::size_t rests,
                                                 std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<> turn(-80 * kDegree, 80 * kDegree);
  std::vector<std::vector<double>> angles_rad;
  for (std::size_t i = 0; i < rests; ++i) {
    auto at = of.robot().arm.home_rad;
    for (double& angle : at) angle += turn(random);
    angles_rad.insert(angles_rad.end(), of.robot().targets_mm.size(), at);
  }
  return of.poses_at(angles_rad);
}

/// Identifies and judges a result that is to be complete.
inline void judge_complete(const Simulation& of, const std::vector<identify::Sweep>& sweeps,
                           std::size_t poses, Judged& all) {
  const auto found = identify::identify(sweeps, of.campaign(), of.poses(poses));
  INFO(found.reason);
  REQUIRE(found.status == identify::Status::complete);
  judge(of, found, all);
}

/// But those of one joint.
inline std::vector<identify::Sweep> sweeps_without(std::size_t joint, const Simulation& of) {
  auto sweeps = of.sweeps();
  std::erase_if(sweeps, [&](const identify::Sweep& sweep) { return sweep.joint == joint; });
  return sweeps;
}

}  // namespace simulation::robots
