#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "rsi/asio.hpp"

#include "rsi/link/latency_histogram.hpp"

namespace sweepd::test {

/// A controller that never stops, whatever becomes of its replies: a telegram each cycle, on a
/// thread of its own, and a record of all that it sent.
class Streamer {
 public:
  using Clock = std::chrono::steady_clock;

  struct Options {
    std::chrono::milliseconds cycle{4};
    std::size_t padding = 0;  ///< blanks in each telegram
    /// Whether it sends in this cycle, counted from 0.
    std::function<bool(std::uint64_t cycle)> speaks = [](std::uint64_t) { return true; };
  };
  struct Sent {
    std::uint64_t ipoc = 0;
    Clock::time_point at;
    std::optional<Clock::duration> answered_after;
  };

  Streamer(std::uint16_t port, Options options);
  ~Streamer();
  Streamer(const Streamer&) = delete;
  Streamer& operator=(const Streamer&) = delete;

  [[nodiscard]] std::vector<Sent> sent() const;
  /// What was sent, after the last telegram and its reply.
  std::vector<Sent> stop();

 private:
  void run();
  void send(std::uint64_t cycle);
  void receive_until(Clock::time_point time);

  Options options_;
  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_;
  mutable std::mutex mutex_;
  std::vector<Sent> sent_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// How the telegrams between two moments were answered.
struct Answers {
  std::uint64_t telegrams = 0;
  std::uint64_t unanswered = 0;
  rsi::LatencyHistogram latency;

  [[nodiscard]] std::string text() const;  ///< a line of figures
};
Answers answers(const std::vector<Streamer::Sent>& sent, Streamer::Clock::time_point from,
                Streamer::Clock::time_point to);

}  // namespace sweepd::test
