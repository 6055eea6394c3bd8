#pragma once

#include <cstddef>
#include <vector>

#include "identify/clock/angle_tape.hpp"
#include "identify/sweeps/sample.hpp"

namespace identify {

/// Speed is that over so much before and after: rests of 0.3 s are seen.
inline constexpr double kMotionWindow_s = 0.06;

/// A stretch of time.
struct Span {
  double begin_s = 0;
  double end_s = 0;

  [[nodiscard]] double middle_s() const { return (begin_s + end_s) / 2; }
  [[nodiscard]] double seconds() const { return end_s - begin_s; }
};

/// Two views of one motion differ in length by little, beside what noise hides of motions' ends: so
/// much at most.
inline constexpr double kMostHidden_s = 0.25;
/// And so far their middles may be apart, to begin with.
inline constexpr double kSameMove_s = 0.15;

/// The device's view and the controller's, of which the device sees `least_s` to `most_s` less.
[[nodiscard]] bool alike(const Span& device, const Span& controller, double least_s, double most_s);
/// Whether all of it, and a little beside, was looked at.
[[nodiscard]] bool is_within(const std::vector<Span>& seen, const Span& span);

/// When something moved, by one clock. Motion begins and ends too early and too late by as much, at
/// most by the window: its middle is right.
struct Motion {
  std::vector<Span> moves;  ///< from rest to rest, both of which were seen
  std::vector<Span> rests;  ///< between moves, and at the ends of what was seen
  std::vector<Span> seen;   ///< without a gap
  /// Slower motion is hidden by the noise of the device, or by its last decimal; 0: nothing that
  /// matters is.
  double hidden_below_mm_s = 0;
};

/// What the target of a device was seen to do.
struct Measured {
  std::size_t target = 0;
  Sample sample;  ///< with a position, by the device's clock
};

/// When any joint moved. `step_rad`: one unit of the last decimal.
[[nodiscard]] Motion motion_of(const AngleTape& tape, double step_rad);

/// When the targets moved, each by itself: a position that is far off its neighbours moves nothing,
/// and what noise hides is rest. In the order of time, target by target.
[[nodiscard]] Motion motion_of(const std::vector<Measured>& points, double step_mm);

/// The times of this target's points, and its positions, in strict order of time.
struct TargetTrack {
  std::vector<double> time_s;
  std::vector<Eigen::Vector3d> position_mm;
};
[[nodiscard]] std::vector<TargetTrack> tracks_of(const std::vector<Measured>& points);

}  // namespace identify
