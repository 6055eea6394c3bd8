#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/live_slices.hpp"
#include "identify/sweeps/sweep.hpp"
#include "rsi/link/link.hpp"

namespace sweepd {

/// Fills the slices of one robot while RSI streams: one point in a tenth of a second, which costs
/// next to nothing, and up to four while somebody looks. One thread, which never waits here: while
/// a reader copies, the slice goes on.
class LiveFeed {
 public:
  explicit LiveFeed(LiveSlices& to) : to_(to) {}

  /// `started`: as its folder is named.
  void begin_session(std::string started);
  /// One came from the controller, whatever it held.
  void telegram() { ++telegrams_; }
  void sample(const identify::Sample& sample);
  /// `joint` counts from 0.
  void sweep(const identify::Sweep& sweep, std::optional<std::size_t> joint, bool linear,
             std::string words);
  /// About ten times a second while the session lasts, and at its end. `at_s`: see LiveSlice.
  void tick(const rsi::Link& link, bool expects_replies, double at_s);

 private:
  void take_cycles(const rsi::Link& link, bool expects_replies);

  LiveSlices& to_;
  LiveSlice slice_;  // that is being filled
  std::vector<std::shared_ptr<const LiveSweep>> sweeps_;
  std::uint64_t session_ = 0;
  std::string started_;
  std::uint64_t sweep_number_ = 0;
  std::size_t telegrams_ = 0;  // not in a slice yet
  double next_point_s_ = 0;
};

}  // namespace sweepd
