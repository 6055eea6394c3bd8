#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"

namespace identify {

inline constexpr std::size_t kMostJoints = 12;

/// What was measured at one moment: where the target point was, and the joint angles where known.
struct Sample {
  double time_s = 0;
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();  ///< in the measurement frame
  /// Orientation of the tool: R = Rz(a) Ry(b) Rx(c). Compare rotations, never these three.
  std::array<double, 3> abc_rad{};
  /// The controller's actual angles; of a linear joint its way, mm * kDegree (see kLinear_mm).
  std::array<double, kMostJoints> angles_rad{};
  std::uint8_t joints = 0;  ///< how many of the angles are known; 0: none
  /// Another number once an external axis stands elsewhere.
  std::uint16_t external_place = 0;
  bool has_position = false;
  bool has_orientation = false;
};

/// The smallest change that the measured numbers can show: one unit of the last decimal that the
/// controller prints. Zero where numbers come at full precision.
struct Resolution {
  double position_mm = 0;
  double angle_rad = 0;
  double time_s = 0;  ///< of the stamps of a device with a clock of its own
};

/// Columns: the positions of those samples that have one, in their order.
[[nodiscard]] Eigen::Matrix3Xd positions(const std::vector<Sample>& samples);

/// Of the tool, R = Rz(a) Ry(b) Rx(c).
[[nodiscard]] inline Eigen::Matrix3d orientation(const Sample& sample) {
  const auto [a, b, c] = sample.abc_rad;
  return (Eigen::AngleAxisd(a, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(b, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(c, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

/// The angles of an orientation, as `abc_rad` has them.
[[nodiscard]] inline std::array<double, 3> abc_of(const Eigen::Matrix3d& r) {
  const double across = std::hypot(r(0, 0), r(1, 0));
  const double b = std::atan2(-r(2, 0), across);
  if (across < 1e-12) return {std::atan2(-r(0, 1), r(1, 1)), b, 0};  // only a and c together count
  return {std::atan2(r(1, 0), r(0, 0)), b, std::atan2(r(2, 1), r(2, 2))};
}

/// The axes about which small changes of the angles a, b, c turn this orientation, one a column.
/// Where b is 90 degrees, b's is of no use.
[[nodiscard]] inline Eigen::Matrix3d abc_axes(const Eigen::Matrix3d& r) {
  Eigen::Matrix3d axes;
  axes.col(0) = Eigen::Vector3d::UnitZ();
  axes.col(1) = Eigen::Vector3d::UnitZ().cross(r.col(0)).normalized();
  axes.col(2) = r.col(0);
  return axes;
}

/// Coordinate by coordinate, the median: a few points anywhere do not shift it far. Reorders
/// `points`, of which there must be one at least.
[[nodiscard]] inline Eigen::Vector3d median(std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d middle;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto at = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
    std::nth_element(
        points.begin(), at, points.end(),
        [k](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a(k) < b(k); });
    middle(k) = (*at)(k);
  }
  return middle;
}

/// What noise hides in a stream of positions without angles.
struct MotionLimit {
  double noise_mm = 0;      ///< of one coordinate of a position, as the stream showed it
  double slowest_mm_s = 0;  ///< slower motion of the target is not told from rest
  double shortest_mm = 0;   ///< arcs of less extent are not told from noise

  /// Whether noise makes it worse than it is at best.
  [[nodiscard]] bool by_noise() const { return slowest_mm_s > kUsualSlowest_mm_s; }
  static constexpr double kUsualSlowest_mm_s = 2;
  static constexpr double kUsualShortest_mm = 3;
};

}  // namespace identify
