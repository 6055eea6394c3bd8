#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "identify/sweeps/sample.hpp"
#include "identify/sweeps/sweep.hpp"

namespace identify {

/// Recognises strokes in a stream of positions without angles: stretches of motion between rests
/// or reversals whose positions lie on a circle. All targets of one body are taken together: they
/// move and rest at once, each has a sweep of a stroke. Motion is judged by the slope of the
/// positions over +-0.1 s, against what measuring noise makes of rest: the noise is seen while the
/// stream runs, as what a parabola leaves of each window. A single position far beside those before
/// and behind it moves nothing. Strokes of less than half a degree are
/// motion, but never reported. Bounded memory while nothing moves; a stroke that outgrows
/// `most_samples` is ended there and goes on as another.
class PositionSegmenter {
 public:
  static constexpr std::size_t kMostSamples = 200'000;
  explicit PositionSegmenter(std::size_t most_samples = kMostSamples)
      : most_samples_(most_samples) {}

  /// How finely the positions are printed: thresholds never lie below it.
  void set_step(double position_mm) { step_mm_ = position_mm; }

  struct Seen {
    std::size_t target = 0;
    Sample sample;
  };
  /// The targets seen at one time; times in strict order, others are ignored. Returns the strokes
  /// that have just proved to be over. After a gap of more than kLongestGap_s a stroke has ended,
  /// and its end was not seen.
  [[nodiscard]] std::vector<Sweep> push(const std::vector<Seen>& frame);
  [[nodiscard]] std::vector<Sweep> finish();

  /// As the stream has shown it so far; nothing before a few pictures within 0.2 s were seen.
  [[nodiscard]] std::optional<MotionLimit> limit() const;

 private:
  struct Kept : Seen {
    bool stray = false;  ///< it tells nothing of motion; its stroke has it all the same
  };
  struct Frame {
    double time_s = 0;
    std::vector<Kept> seen;
  };
  /// Of a window, of all its targets.
  struct Slope {
    std::map<std::size_t, Eigen::Vector3d> velocity_mm_s;
    double speed_mm_s = 0;  ///< root mean square
    double noise_mm = 0;    ///< that a parabola leaves; 0: too few frames
    double sigma_mm_s = 0;  ///< of `speed_mm_s`, in units of the noise
  };

  /// Marks strays before the last frame.
  void look_for_strays();
  void decide(std::size_t centre);
  [[nodiscard]] Slope slope_at(std::size_t centre) const;
  void learn(const Slope& slope);
  [[nodiscard]] double noise_mm() const;
  void close(bool end_seen);
  void report(std::size_t target, const std::vector<Kept>& seen, bool begin_seen, bool end_seen);

  std::size_t most_samples_;
  double step_mm_ = 0;
  std::deque<Frame> window_;
  std::size_t undecided_ = 0;
  bool moves_ = false;
  bool blind_before_ = true;  ///< nothing is known of the time before the next frame
  bool begin_seen_ = false;   ///< that of the stroke under way
  std::map<std::size_t, Eigen::Vector3d> velocity_;
  std::vector<Frame> stroke_;
  std::vector<Sweep> ended_;
  double sigma_mm_s_ = 0;  ///< of the slope over a whole window, in units of the noise
  /// How often each size of noise was seen: eight to an octave, from 1e-6 mm.
  std::array<std::size_t, 320> sizes_{};
  std::size_t learnt_ = 0;
};

}  // namespace identify
