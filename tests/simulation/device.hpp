#pragma once

#include <cstdint>
#include <random>

#include <Eigen/Geometry>

#include "tests/simulation/world.hpp"

namespace simulation {

/// Measures points with the errors of world.hpp, in the order of time.
class Device {
 public:
  /// `seconds`: from the first sample to the last, over which it drifts.
  Device(const Noise& noise, const Drift& drift, double seconds, std::uint32_t seed);

  /// A stroke begins: its errors have nothing to do with the last one's.
  void begin() { fresh_ = true; }
  /// What it says of a point of its frame.
  [[nodiscard]] Eigen::Vector3d measured(const Eigen::Vector3d& point_mm, double time_s);

 private:
  Eigen::Vector3d normal3(std::mt19937_64& random);

  Noise noise_;
  Drift drift_;
  double seconds_;
  std::mt19937_64 random_;
  std::mt19937_64 outliers_;
  std::mt19937_64 wandering_;
  std::normal_distribution<> normal_;
  Eigen::Vector3d error_ = Eigen::Vector3d::Zero();  ///< in standard deviations
  Eigen::Vector3d way_;                              ///< of the linear drift, unit
  Eigen::Vector3d wandered_mm_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d move_, turn_;  ///< unit
  double moved_mm_ = 0;
  double time_s_ = 0;
  bool fresh_ = true;
};

/// Where a robot's base stands in the frame of a device that was placed by chance: 2.5 to 4 m away,
/// turned about the vertical at will, tilted by some degrees.
[[nodiscard]] Eigen::Isometry3d random_place(std::uint32_t seed);

}  // namespace simulation
