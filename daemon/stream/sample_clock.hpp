#pragma once

#include <cstdint>

#include "rsi/datagram.hpp"

namespace sweepd {

/// Gives samples their time in seconds since the first one.
///
/// A controller's IPOC counts milliseconds: a clock without the network's jitter. Some simulators
/// raise it otherwise; then the time of reception is all there is, and a telegram that was
/// overtaken has the time of its IPOC at the pace of the others. Which of the two it is may only be
/// known after a while: then time goes on from the newest sample, without a jump. After a restart
/// the time goes on by the time of reception, at least half a second later. Times depend on the
/// datagrams alone, so that a replay gives those of the live run.
class SampleClock {
 public:
  /// `counts_ms`: what LinkStatistics::counts_ms() says so far; `restarted`: this telegram is the
  /// first of a new run.
  [[nodiscard]] double seconds(std::uint64_t ipoc, rsi::Timestamp received, bool counts_ms,
                               bool restarted);

 private:
  struct Moment {
    double seconds = 0;
    std::uint64_t ipoc = 0;
    rsi::Timestamp received{};
  };

  bool started_ = false;
  bool counts_ms_ = true;
  rsi::Timestamp first_received_{};
  Moment since_;   // times are counted from here
  Moment newest_;  // sample
};

}  // namespace sweepd
