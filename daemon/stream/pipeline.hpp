#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "daemon/stream/sample_clock.hpp"
#include "daemon/stream/sample_reader.hpp"
#include "identify/sweeps/segmentation.hpp"
#include "rsi/datagram.hpp"
#include "rsi/link/link_statistics.hpp"
#include "rsi/telegram/telegram.hpp"

namespace sweepd {

/// What came in, and in what state.
struct SourceCounts {
  rsi::LinkCounts link;
  std::array<std::uint64_t, rsi::kDefects> malformed{};  ///< by rsi::Defect; `none` stays 0
  std::uint64_t unusable_values = 0;  ///< signals that should be numbers and are not
  std::optional<std::chrono::nanoseconds> cycle;

  [[nodiscard]] std::uint64_t malformed_in_all() const;
};

/// From datagrams of the controller to sweeps: the one path of live and replayed data.
///
/// Each telegram is parsed, counted, put in order and given a time; its sample goes to `on_sample`
/// and to the segmentation, whose strokes go to `on_sweep`. One thread. No files, no log.
class Pipeline {
 public:
  struct Observer {
    /// A sample in its order, and its row "t_s,ipoc,x,y,z,…" without an end of line.
    std::function<void(const identify::Sample&, std::string_view row)> on_sample;
    std::function<void(const identify::Sweep&)> on_sweep;
    /// Whatever came, and what it was parsed to.
    std::function<void(const rsi::Datagram&, const rsi::Telegram&, rsi::Defect)> on_telegram = {};
  };

  /// The first `joints` axis angles count.
  Pipeline(std::size_t joints, const SignalNames& signals, Observer observer);

  /// A datagram that came from the controller, whatever it holds. False, and counted, if it is no
  /// usable telegram.
  bool telegram(const rsi::Datagram& datagram);

  /// The stream has ended: what was held back goes through.
  void finish();

  [[nodiscard]] SourceCounts counts() const;
  [[nodiscard]] const identify::Resolution& resolution() const { return reader_.resolution(); }
  /// What noise hides where telegrams carry no angles.
  [[nodiscard]] std::optional<identify::MotionLimit> motion_limit() const {
    return segmenter_.limit();
  }
  [[nodiscard]] std::string csv_header() const { return "t_s,ipoc" + reader_.csv_header(); }

 private:
  struct Waiting {
    identify::Sample sample;
    std::string row;
  };

  void hold(Waiting waiting);
  void release(std::size_t keep);
  void report(const std::vector<identify::Sweep>& sweeps) const;

  Observer observer_;
  rsi::Telegram telegram_;
  rsi::LinkStatistics link_;
  SampleReader reader_;
  SampleClock clock_;
  identify::Segmenter segmenter_;
  std::array<std::uint64_t, rsi::kDefects> malformed_{};
  /// Samples wait until a few others have come: one that was overtaken still finds its place.
  std::deque<Waiting> waiting_;
  std::string spare_row_;  // keeps its memory
};

}  // namespace sweepd
