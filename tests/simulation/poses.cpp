#include <random>

#include "identify/geometry/angle.hpp"
#include "tests/simulation/device.hpp"
#include "tests/simulation/printed.hpp"
#include "tests/simulation/simulation.hpp"
#include "tests/simulation/stream.hpp"

namespace simulation {

using identify::kDegree;

std::vector<identify::Pose> Simulation::poses(std::size_t count, double range_deg) const {
  std::uniform_real_distribution<> range(-range_deg, range_deg);
  return poses_where(count, [&](std::size_t, std::mt19937_64& random) {
    std::vector<double> angles = robot_.arm.home_rad;
    for (double& angle : angles) angle += range(random) * kDegree;
    return angles;
  });
}

std::vector<identify::Pose> Simulation::poses_at(
    const std::vector<std::vector<double>>& angles_rad) const {
  return poses_where(angles_rad.size(),
                     [&](std::size_t i, std::mt19937_64&) { return angles_rad[i]; });
}

template <typename Angles>
std::vector<identify::Pose> Simulation::poses_where(std::size_t count, const Angles& of) const {
  const std::size_t joints = robot_.arm.joints();
  Device device(world_.noise, world_.drift, static_cast<double>(count), seed_ + 1);
  auto random = stream(seed_, Source::poses);
  std::normal_distribution<> normal;
  std::vector<identify::Pose> poses;
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<double> angles = of(i, random);
    identify::Turns turns = turns_at(angles, std::vector<int>(joints, 1));
    for (std::size_t k = 0; k < joints; ++k)
      turns[k] += world_.home.sigma_deg * kDegree * normal(random);
    identify::Pose pose;
    pose.target = i % robot_.targets_mm.size();
    pose.name = "pose " + std::to_string(i + 1);
    pose.sample.time_s = static_cast<double>(i);
    pose.sample.has_position = true;
    pose.sample.joints = static_cast<std::uint8_t>(joints);
    for (std::size_t k = 0; k < joints; ++k)
      pose.sample.angles_rad[k] = printed(angles[k] / kDegree, world_.decimals) * kDegree;
    device.begin();
    pose.sample.position_mm =
        device.measured(base_ * chain_.target_mm(pose.target, turns), pose.sample.time_s);
    poses.push_back(pose);
  }
  return poses;
}

std::vector<identify::Load> Simulation::loads() const {
  std::vector<identify::Load> loads;
  for (std::size_t j = 0; j < robot_.links.size(); ++j)
    loads.push_back({robot_.links[j].mass_kg, j, robot_.links[j].center_mm});
  return loads;
}

}  // namespace simulation
