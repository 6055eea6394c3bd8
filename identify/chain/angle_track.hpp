#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "identify/chain/chain.hpp"
#include "identify/circle/circle_estimate.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/sweeps/campaign.hpp"

namespace identify {

/// A stroke's angles as told, by time, and as seen about its joint's axis.
struct AngleTrack {
  /// Counts joints and their targets: each target has a place of its own about the axis.
  std::size_t group = 0;
  int direction = 0;
  bool linear = false;
  std::vector<double> time_s, told_rad;  ///< of all samples
  std::vector<std::size_t> begins;       ///< of pieces without a gap: places in the two
  std::vector<double> at_s, seen_rad;    ///< of those that are no outliers
  double reach_mm = 0;                   ///< the circle's radius; of a linear joint kLinear_mm
  double middle_rad = 0, half_rad = 0;   ///< of the range that the group was seen in
  double off_home_rad = 0;               ///< of the joint locked farthest off home
  double stamps_s = 0;                   ///< stamps_off_s() of its samples
  double printed_rad = 0;                ///< told_level_rad() of its angles
  /// Standard deviation of told()'s speeds, as angles are printed in steps, or uneven.
  double speed_noise_rad_s = 0;
  /// How fast the joint was seen to turn at each of `at_s`, with no more noise, where positions
  /// tell that in half of the time that told() needs; else none.
  std::vector<double> seen_speed_rad_s;

  struct Told {
    double angle_rad = 0;
    double speed_rad_s = 0;
  };
  /// Where the told angle has come at a time, and how fast it turns; nothing outside the stroke,
  /// nor where nothing was told for so long that the joint may have rested or turned round.
  [[nodiscard]] std::optional<Told> told(double at) const;
};

/// Angles about an axis, counted on from one to the next.
class AngleAbout {
 public:
  explicit AngleAbout(const ChainAxis& axis)
      : axis_(axis), x_(axis.direction.unitOrthogonal()), y_(axis.direction.cross(x_)) {}

  double next(const Eigen::Vector3d& point) {
    const Eigen::Vector3d arm = point - axis_.point_mm;
    if (axis_.linear) return axis_.direction.dot(arm) / kLinear_mm;
    const double angle = std::atan2(y_.dot(arm), x_.dot(arm));
    last_ += wrapped(angle - last_);
    return last_;
  }
  /// Off the circle with this height and radius (or the line), across the motion.
  [[nodiscard]] std::array<double, 2> place(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d arm = point - axis_.point_mm;
    if (axis_.linear) return {x_.dot(arm), y_.dot(arm)};
    const double height = axis_.direction.dot(arm);
    return {height, (arm - height * axis_.direction).norm()};
  }

 private:
  ChainAxis axis_;
  Eigen::Vector3d x_, y_;
  double last_ = 0;
};

/// What a stroke's stamps that are rounded to this step are off by on average: a standard
/// deviation. An even clock's go on by whole steps, all off alike, until one interval differs.
[[nodiscard]] double stamps_off_s(const std::vector<Sample>& samples, double step_s);

/// Of each stroke; more tell nothing new of something so smooth.
inline constexpr std::size_t kMostTracked = 400;

/// `axis`: of the joint, along positive rotation; `step_rad`: in which angles are printed. Nothing
/// where too few samples have both.
[[nodiscard]] std::optional<AngleTrack> angle_track(const Sweep& sweep, std::size_t joint,
                                                    const ChainAxis& axis, double step_rad = 0,
                                                    std::size_t most = kMostTracked);

/// Those of all sweeps that the circles used and whose direction is known; of one group, the seen
/// angles count from the same place. `axes`: one a joint. Of two clocks all samples, as each has
/// the jitter of its own stamp; and of the moves to a sweep's start and back, too.
[[nodiscard]] std::vector<AngleTrack> angle_tracks(
    const CircleEstimate& circles, const std::vector<std::optional<ChainAxis>>& axes,
    const Campaign& campaign);

}  // namespace identify
