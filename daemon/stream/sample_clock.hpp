#pragma once

#include <cstdint>
#include <optional>

#include "rsi/datagram.hpp"

namespace sweepd {

/// Gives samples their time in seconds since the first one.
///
/// A controller's IPOC counts milliseconds: a clock without the network's jitter. Some simulators
/// raise it by one a telegram; then the time of reception is all there is. After a restart the time
/// goes on by the time of reception, at least half a second later. Times depend on the datagrams
/// alone, so that a replay gives those of the live run.
class SampleClock {
 public:
  /// `step`: the IPOC's step as learned so far; `restarted`: this telegram is the first of a new
  /// run.
  [[nodiscard]] double seconds(std::uint64_t ipoc, rsi::Timestamp received,
                               std::optional<std::uint64_t> step, bool restarted);

 private:
  bool started_ = false;
  rsi::Timestamp first_received_{};
  double run_start_s_ = 0;
  std::uint64_t run_ipoc_ = 0;
  rsi::Timestamp run_received_{};
  double latest_s_ = 0;
};

}  // namespace sweepd
