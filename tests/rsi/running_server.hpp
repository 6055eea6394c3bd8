#pragma once

// A server on its thread, for the tests of both kinds.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>

#include "rsi/server.hpp"

namespace rsi::test {

inline constexpr std::uint32_t kLoopback = 0x7f000001;

inline Server::Options on_loopback() {
  Server::Options options;
  options.listen = {kLoopback, 0};
  options.reply.emplace("ImFree");
  return options;
}

/// A steady clock that stands still until it is set.
struct HandClock {
  static inline std::atomic<std::chrono::steady_clock::duration> time{std::chrono::hours(1)};
  static Callers::Time now() noexcept { return Callers::Time(time); }
};

inline std::string ipoc_element(std::uint64_t ipoc) {
  return "<IPOC>" + std::to_string(ipoc) + "</IPOC>";
}
inline std::string telegram(std::uint64_t ipoc) {
  return "<Rob Type=\"KUKA\"><DiL>0</DiL>" + ipoc_element(ipoc) + "</Rob>";
}
inline std::string reply(std::uint64_t ipoc) {
  return "<Sen Type=\"ImFree\">" + ipoc_element(ipoc) + "</Sen>";
}

/// Stopped at the end of the test.
template <typename AServer>
struct RunningServer {
  explicit RunningServer(Server::Options options) : server(std::move(options)) { start(); }
  ~RunningServer() { stop(); }

  void start() {
    thread = std::thread([this] {
      server.warm();
      server.run();
    });
  }
  /// The counts are final then: a reply arrives before it is counted.
  void stop() {
    if (!thread.joinable()) return;
    server.stop();
    thread.join();
  }

  /// The next datagram that was handed over; an empty one after ten seconds without.
  Datagram next() {
    Datagram datagram;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!server.datagrams().pop(datagram) && std::chrono::steady_clock::now() < deadline)
      std::this_thread::yield();
    return datagram;
  }

  /// The server has looked at its port at this time, and gone on.
  void look_at(std::chrono::steady_clock::duration time) {
    HandClock::time = time;
    for (const auto beats = server.beats(); server.beats() < beats + 3;) std::this_thread::yield();
  }

  AServer server;
  std::thread thread;
};

}  // namespace rsi::test
