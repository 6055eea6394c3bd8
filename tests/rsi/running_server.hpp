#pragma once

// A server on its thread, for the tests of both kinds.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>

#include <sys/socket.h>
#include <sys/time.h>

#include "rsi/server/server.hpp"
#include "tests/catch.hpp"
#include "tests/rsi/addresses.hpp"

namespace rsi::test {

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

/// Streams alone whose beginning was heard are answered, by the hand clock, which is at one hour.
inline Server::Options from_the_beginning() {
  Server::Options options = on_loopback();
  options.only_from_the_beginning = true;
  HandClock::time = std::chrono::hours(1);
  options.clock = HandClock::now;
  return options;
}

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
  /// Whether that took as long as a server looks at its port that nothing wakes (100 ms). A busy
  /// machine takes as long now and then, and not mostly.
  bool stops_late() {
    const auto start = std::chrono::steady_clock::now();
    stop();
    return std::chrono::steady_clock::now() - start > std::chrono::milliseconds(80);
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

/// Of the next telegram of `controller` and its reply.
template <typename AServer>
void check_handed_over(RunningServer<AServer>& running, std::uint64_t ipoc,
                       const Endpoint& controller) {
  const Datagram received = running.next();
  CHECK(received.payload == telegram(ipoc));
  CHECK(received.source == controller);
  CHECK(received.destination == running.server.local());
  const auto received_at = received.time;
  const Datagram sent = running.next();
  CHECK(sent.payload == reply(ipoc));
  CHECK(sent.source == running.server.local());
  CHECK(sent.destination == controller);
  CHECK(sent.time >= received_at);
}

/// Its recv() waits no longer: Asio's own call would, past this time-out.
template <typename Socket>
void wait_ten_seconds(Socket& socket) {
  const timeval ten_seconds{10, 0};
  setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &ten_seconds, sizeof ten_seconds);
}

/// At most so many bytes; none if nothing comes for ten seconds.
template <typename Socket>
std::string received_by(Socket& socket, std::size_t bytes, int flags = 0) {
  std::string text(bytes, '\0');
  const auto size = ::recv(socket.native_handle(), text.data(), text.size(), flags);
  text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return text;
}

}  // namespace rsi::test
