#pragma once

#include <chrono>
#include <optional>

namespace sweepd {

/// When a robot's next interim result is due. The first one of a session is at once. Those of all
/// robots together take a twentieth of one processor, however many robots stream and however long.
/// One thread.
class InterimPace {
 public:
  using Steady = std::chrono::steady_clock;

  void begin_session() { last_.reset(); }
  void begin(Steady::time_point now) { last_ = now; }

  /// `took`: what the newest one took; zero where none has come to its end. `streaming`: robots.
  [[nodiscard]] bool due(Steady::time_point now, Steady::duration took, int streaming) const {
    if (!last_) return true;
    return took > took.zero() && now - *last_ >= kRest * streaming * took;
  }

 private:
  static constexpr int kRest = 20;

  std::optional<Steady::time_point> last_;  // of the session
};

}  // namespace sweepd
