#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "identify/geometry/angle.hpp"
#include "identify/sweeps/position_segmentation.hpp"
#include "identify/sweeps/sample.hpp"
#include "identify/sweeps/sweep.hpp"
#include "identify/sweeps/window.hpp"

namespace identify {

// How streams are looked at, whatever tells motion in them: the same for angles and positions.

/// Speed is that over so much before and after.
inline constexpr double kHalfWindow_s = 0.1;
/// A flicker of one step of the last decimal within the window is no motion; two steps are. Steps a
/// second above which something moves, and below which it rests again.
inline constexpr double kStartSteps_1_s = 2.0 / (2 * kHalfWindow_s);
inline constexpr double kStopSteps_1_s = 1.2 / (2 * kHalfWindow_s);
/// A longer gap ends a stroke.
inline constexpr double kLongestGap_s = 0.25;
/// Less is motion, but no stroke.
inline constexpr double kShortestStroke_rad = 0.5 * kDegree;
/// The ends of a stroke that cover less than this share of it are rest, seen through the window.
inline constexpr double kRest = 5e-4;

/// Recognises single-joint strokes in a stream of samples, one sample at a time.
///
/// With angles, a stroke is where exactly one joint moves, without turning back; without, see
/// PositionSegmenter. Motion is judged by the speed over the window with hysteresis, so a stroke is
/// reported half a window after its end.
///
/// From the first sample with angles on the stream is one with angles, and samples without are
/// passed over. Bounded memory while nothing moves; a stroke that outgrows `most_samples` is ended
/// there and goes on as another.
class Segmenter {
 public:
  /// The first `joints` angles of each sample count (at most kMostJoints).
  explicit Segmenter(std::size_t joints,
                     std::size_t most_samples = PositionSegmenter::kMostSamples);

  /// How finely the numbers are printed, as far as is known by now: thresholds never lie below it.
  void set_resolution(const Resolution& resolution) {
    resolution_ = resolution;
    by_positions_.set_step(resolution.position_mm);
  }

  /// Samples in strict order of time; others are ignored. Returns the strokes, hardly ever more
  /// than one, that have just proved to be over.
  [[nodiscard]] std::vector<Sweep> push(const Sample& sample);

  /// The stream has ended or broken off: returns what was under way.
  [[nodiscard]] std::vector<Sweep> finish();

  /// Of a stream without angles, as far as is known by now.
  [[nodiscard]] std::optional<MotionLimit> limit() const { return by_positions_.limit(); }

 private:
  /// What moves: nothing of use, or one joint in one direction.
  struct Motion {
    int joint = kNothing;
    int sign = 0;
    friend bool operator==(const Motion&, const Motion&) = default;
  };
  static constexpr int kNothing = -1;

  void decide(const Sample& centre);
  [[nodiscard]] Motion joint_motion(const Sample& first, const Sample& last);
  void close();
  /// The stroke without rest at its ends, in memory of its own: `stroke_` keeps its.
  [[nodiscard]] std::shared_ptr<const std::vector<Sample>> trimmed() const;
  [[nodiscard]] double travel(const Sample& from, const Sample& to) const;
  void judge_by_angles(Sweep& sweep) const;

  std::size_t joints_;
  std::size_t most_samples_;
  Resolution resolution_;
  std::optional<bool> with_angles_;
  Window<Sample> window_;
  std::size_t undecided_ = 0;  // index in window_ of the first sample without a verdict
  std::array<bool, kMostJoints> joint_moves_{};
  Motion motion_;
  std::vector<Sample> stroke_;
  std::vector<Sweep> ended_;
  PositionSegmenter by_positions_;
};

/// Strokes below this range or number of samples are reported as defective.
inline constexpr double kShortestRange_rad = 5 * kDegree;
inline constexpr std::size_t kFewestSamples = 20;

}  // namespace identify
