#pragma once

// Datagrams of a controller and of what answers it, put together for link reports: each with the
// time stamp that a test gives it.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "rsi/datagram.hpp"
#include "tests/rsi/addresses.hpp"

namespace rsi::test {

using namespace std::chrono_literals;

inline constexpr Timestamp kStart = 1'735'689'600s;  // 2025-01-01T00:00:00Z

inline std::string telegram_text(std::uint64_t ipoc, std::optional<std::uint64_t> delay = 0) {
  const std::string late = delay ? "<Delay D=\"" + std::to_string(*delay) + "\"/>" : "";
  return "<Rob Type=\"KUKA\"><DiL>0</DiL>" + late + "<IPOC>" + std::to_string(ipoc) +
         "</IPOC></Rob>\n";
}

inline std::string reply_text(std::uint64_t ipoc) {
  return "<Sen Type=\"ImFree\"><IPOC>" + std::to_string(ipoc) + "</IPOC></Sen>";
}

/// Feeds `Watcher` (telegram and reply of Datagrams). Times are since the start, by the clock that
/// stamps: `clock_off` is added to all.
template <typename Watcher>
class LinkStream {
 public:
  explicit LinkStream(Watcher& watcher) : watcher_(watcher) {}

  void telegram(std::chrono::nanoseconds at, std::uint64_t ipoc,
                std::optional<std::uint64_t> delay = 0) {
    datagram(at, telegram_text(ipoc, delay));
  }
  void datagram(std::chrono::nanoseconds at, const std::string& payload, bool cut = false) {
    watcher_.telegram({kStart + at + clock_off, controller, kServer, payload, cut});
  }
  void reply(std::chrono::nanoseconds at, std::uint64_t ipoc) {
    reply_datagram(at, reply_text(ipoc));
  }
  void reply_datagram(std::chrono::nanoseconds at, const std::string& payload) {
    watcher_.reply({kStart + at + clock_off, kServer, controller, payload, false});
  }
  /// Cycles of 4 ms from number `first` to before `end`, each answered after `latency`.
  void cycles(std::uint64_t first, std::uint64_t end,
              std::chrono::nanoseconds latency = std::chrono::microseconds(50)) {
    for (std::uint64_t k = first; k < end; ++k) {
      telegram(at(k), ipoc(k));
      reply(at(k) + latency, ipoc(k));
    }
  }
  static std::chrono::nanoseconds at(std::uint64_t k) {
    return std::chrono::milliseconds(4 * static_cast<std::int64_t>(k));
  }
  static std::uint64_t ipoc(std::uint64_t k) { return 1'000'000 + 4 * k; }

  std::chrono::nanoseconds clock_off{};
  Endpoint controller = kController;

 private:
  Watcher& watcher_;
};

}  // namespace rsi::test
