#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "identify/sweeps/sample.hpp"

namespace sweepd {

/// What those who look at the live page see of a tenth of a second.
struct LiveSlice {
  /// Where the robot was.
  struct Point {
    double t_s = 0;  ///< as in samples.csv
    bool has_position = false;
    std::array<float, 3> position_mm{};
    std::array<float, identify::kMostJoints> angles_deg{};  ///< of a linear joint its mm
  };
  static constexpr std::size_t kPoints = 4;

  std::uint64_t number = 0;   ///< counts up from 1
  std::uint64_t session = 0;  ///< the stream that it is of: RobotState::sessions
  double at_s = 0;            ///< by a clock that never jumps

  std::uint32_t cycles = 0;      ///< telegrams that are settled
  std::uint32_t late = 0;        ///< of these, answered later than a cycle after they came
  std::uint32_t superseded = 0;  ///< of these, without a reply as a newer one got it
  std::uint32_t unanswered = 0;  ///< of these, without any reply
  /// Telegram to reply, the median and the longest; difference from the pace, the largest.
  /// Negative: there was none.
  float latency_us = -1, latency_max_us = -1, jitter_us = -1;

  std::uint8_t joints = 0;  ///< how many angles count
  std::uint8_t count = 0;   ///< of points
  std::array<Point, kPoints> points{};
};

/// A stroke as it was recognised.
struct LiveSweep {
  std::uint64_t number = 0;  ///< counts up from 1
  std::uint64_t session = 0;
  std::string started;               ///< the session's name, as its folder has it
  std::optional<std::size_t> joint;  ///< from 1; by the plan where no angles tell it
  double start_s = 0, end_s = 0;
  double range = 0;  ///< degrees, of a linear joint mm
  bool linear = false;
  std::optional<std::array<double, 2>> ends;  ///< the joint's angle (way), where it is known
  int direction = 0;
  bool usable = false;
  std::string words;                       ///< what the log says of it
  std::vector<std::array<float, 3>> path;  ///< in mm, 32 points at most
};

/// The last minute of a robot for those who look at it, in fixed memory: 0.2 MB, and 128 sweeps.
///
/// One thread adds and never waits for a reader. Any number of threads read.
class LiveSlices {
 public:
  static constexpr std::size_t kSlices = 600;
  static constexpr std::size_t kSweeps = 128;

  /// False, and nothing is added, while somebody reads. Sweeps of earlier sessions go.
  [[nodiscard]] bool try_add(const LiveSlice& slice,
                             const std::vector<std::shared_ptr<const LiveSweep>>& sweeps);

  struct News {
    std::vector<LiveSlice> slices;  ///< the newest ones, in order
    std::vector<std::shared_ptr<const LiveSweep>> sweeps;
    std::uint64_t missed = 0;  ///< slices since `slice` that are not among them
  };
  /// What came after the slice and the sweep with these numbers, `most` slices of it.
  [[nodiscard]] News after(std::uint64_t slice, std::uint64_t sweep, std::size_t most) const;

  /// Whether slices are worth all their points.
  [[nodiscard]] bool watched() const noexcept { return viewers_ > 0; }
  /// Somebody looks for as long as this lives, which is not longer than the slices.
  class Viewer {
   public:
    explicit Viewer(const LiveSlices& slices) : viewers_(slices.viewers_) { ++viewers_; }
    ~Viewer() { --viewers_; }
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;

   private:
    std::atomic<int>& viewers_;
  };

 private:
  mutable std::atomic<int> viewers_{0};
  mutable std::mutex mutex_;
  std::vector<LiveSlice> ring_;  // number n at n modulo kSlices
  std::uint64_t newest_ = 0;
  std::deque<std::shared_ptr<const LiveSweep>> sweeps_;
};

}  // namespace sweepd
