#pragma once

// Poses of arms that are known exactly, for the tests of what is made of them.

#include <optional>
#include <random>
#include <string>
#include <vector>

#include "identify/poses/pose_estimate.hpp"
#include "tests/identify/simulated_robots.hpp"
#include "tests/simulation/simulation.hpp"

namespace simulation::robots {

/// A tracker beside the cell, 0.02 mm; joints stand off what they tell by as much as asked for.
inline World tracker(double joint_deg = 0) {
  World world;
  world.angles = true;
  world.placed = true;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  world.home.sigma_deg = joint_deg;
  return world;
}

inline Simulation arm_with(const World& world, std::uint32_t seed = 1, std::size_t targets = 1) {
  return {robot(seed, targets), strokes(50), world, seed};
}

inline std::optional<identify::PoseEstimate> estimated(const std::vector<identify::Pose>& poses,
                                                       const identify::Campaign& campaign) {
  std::string reason;
  return identify::estimate_poses(poses, campaign, nullptr, {}, reason);
}

/// The same poses of joints that play by twice as much: the arm stands behind what the angles tell,
/// on the side that the senses say.
inline std::vector<identify::Pose> played(std::vector<identify::Pose> poses, std::size_t joints,
                                          double half_rad, std::uint32_t seed) {
  std::mt19937 random(seed);
  for (identify::Pose& pose : poses)
    for (std::size_t j = 0; j < joints; ++j) {
      pose.senses[j] = random() % 2 == 0 ? 1 : -1;
      pose.sample.angles_rad[j] += half_rad * pose.senses[j];
    }
  return poses;
}

/// The mean distance between where poses were seen and where the estimate has them.
inline double mean_off(const identify::PoseEstimate& found,
                       const std::vector<identify::Pose>& poses) {
  double sum = 0;
  for (const auto& pose : poses)
    sum += (pose.sample.position_mm - found.fit.model.position_mm(pose)).norm();
  return sum / static_cast<double>(poses.size());
}

}  // namespace simulation::robots
