#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/stream/sample_clock.hpp"
#include "daemon/stream/sample_reader.hpp"
#include "daemon/stream/sample_relay.hpp"
#include "identify/sweeps/segmentation.hpp"
#include "identify/sweeps/sweep.hpp"
#include "rsi/datagram.hpp"
#include "rsi/link/link.hpp"
#include "rsi/telegram/telegram.hpp"

namespace sweepd {

/// Hears what is found in a stream, in its order: what is not overridden is not listened to. On the
/// thread that brings the telegrams, or the one beside it: never on both at a time.
class StreamSink {
 public:
  virtual ~StreamSink() = default;

  /// A sample, and its row of samples.csv ("t_s,ipoc,x,y,z,…") without an end of line.
  virtual void sample(const identify::Sample& /*sample*/, std::string_view /*row*/) {}
  /// Before sample(), of telegrams with motor currents.
  virtual void currents(const identify::Sample& /*sample*/, const Currents& /*currents*/) {}
  virtual void sweep(const identify::Sweep& /*sweep*/) {}
};

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
/// Each telegram is parsed, counted, put in order and given a time; its sample goes to the sink and
/// to the segmentation, whose strokes go to the sink. One thread, unless it is asked for two. No
/// files, no log.
class Pipeline {
 public:
  /// The first `joints` axis angles count. `with_currents`: rows have motor currents.
  Pipeline(std::size_t joints, const SignalNames& signals, StreamSink& sink,
           bool with_currents = false);

  /// Before the first telegram: from now on sink and segmentation have a thread of their own, which
  /// does what is `beside` where it has to wait, also after finish(). What that thread throws is
  /// thrown by telegram() or finish().
  void use_two_threads(SampleRelay::Beside beside = {});

  /// A datagram that came from the controller, whatever it holds. False, and counted, if it is no
  /// usable telegram.
  bool telegram(const rsi::Datagram& datagram);
  /// What went to the controller: for the link alone.
  void reply(const rsi::Datagram& datagram) { link_.reply(datagram); }

  /// The stream has ended: what was held back goes through.
  void finish();
  /// Of two threads: until what is beside is done. Throws what the other one threw.
  void wait_for_beside() { relay_->wait_for_beside(); }

  [[nodiscard]] SourceCounts counts() const;
  [[nodiscard]] const rsi::Link& link() const { return link_; }
  [[nodiscard]] const identify::Resolution& resolution() const { return reader_.resolution(); }
  [[nodiscard]] const SampleReader::Incomplete& incomplete() const { return reader_.incomplete(); }
  /// What noise hides where telegrams carry no angles. With two threads, once it is finished.
  [[nodiscard]] std::optional<identify::MotionLimit> motion_limit() const {
    return segmenter_.limit();
  }
  [[nodiscard]] std::string csv_header() const { return "t_s,ipoc" + reader_.csv_header(); }

 private:
  struct Waiting {
    SeenSample seen;
    std::uint64_t ipoc = 0;
    std::string row;
  };
  static constexpr std::size_t kHeldBack = 4;

  void hold();
  void put_in_time(std::size_t at);
  void release(std::size_t keep);
  void work_on(const SeenSample& next);
  void report(const std::vector<identify::Sweep>& sweeps) const;

  StreamSink& sink_;
  rsi::Telegram telegram_;
  rsi::Link link_;
  SampleReader reader_;
  SampleClock clock_;
  identify::Segmenter segmenter_;
  std::array<std::uint64_t, rsi::kDefects> malformed_{};
  /// Samples wait until a few others have come: one that was overtaken still finds its place.
  std::array<Waiting, kHeldBack + 1> places_;
  /// All places: those where samples wait, in the order of IPOC, and behind them those that are
  /// free.
  std::array<std::uint8_t, kHeldBack + 1> order_{};
  std::size_t waiting_ = 0;
  std::unique_ptr<SampleRelay> relay_;  // the last one, so that its thread ends first
};

}  // namespace sweepd
