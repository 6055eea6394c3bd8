#pragma once

// What a measuring device sees of a simulated robot that runs a plan, by a clock of its own.

#include <filesystem>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "daemon/plan/simulated_robot.hpp"
#include "daemon/settings/robot_description.hpp"
#include "daemon/settings/sweep_plan.hpp"
#include "daemon/text/numbers.hpp"

namespace sweepd::test {

struct DevicePlay {
  double rate_hz = 100;
  double ahead_s = 0;   ///< of the controller's clock, at the beginning
  double rate = 0;      ///< what its clock gains
  double jitter_s = 0;  ///< up to so much, either way
  double loss = 0;
  double noise_mm = 0.02;
  bool times = true;  ///< each line begins with one
};

struct DeviceLine {
  double at_s = 0;  ///< true time since the first telegram
  std::string text;
};

/// The lines "t_s,x_mm,y_mm,z_mm" of a device that stands some metres off.
inline std::vector<DeviceLine> device_play(const std::filesystem::path& robot,
                                           const std::filesystem::path& plan, const DevicePlay& how,
                                           std::uint32_t seed = 1) {
  SimulatedRobot::Options options;
  options.wobble_deg = 0;
  SimulatedRobot simulated(load_robot(robot), load_plan(plan), options);
  const double cycle_s = 0.004;
  std::vector<Eigen::Vector3d> path;
  rsi::SignalValues values;
  while (simulated.next(values)) path.emplace_back(values.RIst[0], values.RIst[1], values.RIst[2]);
  const Eigen::Isometry3d device(
      Eigen::Translation3d(2500, -700, 300) *
      Eigen::AngleAxisd(2.1, Eigen::Vector3d(0.05, 0.02, 1).normalized()));
  std::mt19937 random(seed);
  std::normal_distribution<> normal(0, how.noise_mm);
  std::uniform_real_distribution<> uniform(0, 1);
  std::vector<DeviceLine> lines;
  for (int i = 0;; ++i) {
    const double at = i / how.rate_hz;
    const auto k = static_cast<std::size_t>(at / cycle_s);
    if (k + 1 >= path.size()) return lines;
    const double share = at / cycle_s - static_cast<double>(k);
    const Eigen::Vector3d point = device * ((1 - share) * path[k] + share * path[k + 1]);
    const double jitter = how.jitter_s * (2 * uniform(random) - 1);
    DeviceLine line{at, ""};
    if (how.times) line.text = fixed(at * (1 + how.rate) + how.ahead_s + jitter, 6) + ",";
    for (const double value : point) line.text += fixed(value + normal(random), 4) + ",";
    line.text.back() = '\n';
    if (uniform(random) >= how.loss) lines.push_back(std::move(line));
  }
}

inline std::string device_file(const std::vector<DeviceLine>& lines) {
  std::string text = "t_s,x_mm,y_mm,z_mm\n";
  for (const auto& line : lines) text += line.text;
  return text;
}

}  // namespace sweepd::test
