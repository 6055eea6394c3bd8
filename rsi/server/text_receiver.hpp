#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "rsi/asio.hpp"

#include "rsi/server/datagram_queue.hpp"
#include "rsi/server/port_owner.hpp"

namespace rsi {

/// Receives lines of text from a measuring device, over UDP or TCP, and answers nothing. Whatever
/// floods it waits in the system's buffer, and is dropped there: it looks a hundred times a second,
/// and takes a bounded number of datagrams each time. Datagrams have the kernel's time stamps.
///
/// Over TCP one connection is read, the newest; whole lines are handed over as datagrams, with the
/// time at which they were read. Lines that are longer than kLongestLine are left out.
class TextReceiver {
 public:
  static constexpr std::size_t kQueueBytes = 1 << 20;
  /// Bytes, with its end: no line of numbers is as long.
  static constexpr std::size_t kLongestLine = 8192;
  static constexpr std::chrono::milliseconds kBetweenLooks{10};
  static constexpr std::size_t kMostInALook = 100;
  /// Datagrams: more than any device sends.
  static constexpr std::size_t kMostInASecond =
      kMostInALook * (std::chrono::seconds(1) / kBetweenLooks);

  /// Listens. Throws std::runtime_error with what to do.
  TextReceiver(Transport transport, const Endpoint& listen);
  TextReceiver(const TextReceiver&) = delete;
  TextReceiver& operator=(const TextReceiver&) = delete;

  /// Receives until stop(); one thread, which ought to have a low priority.
  void run() noexcept;
  /// Any thread.
  void stop() noexcept { context_.stop(); }

  /// What came; for one thread.
  [[nodiscard]] DatagramQueue& datagrams() noexcept { return queue_; }
  /// That were dropped by the system or here, as there was no room. Any thread.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_ + queue_.overflows(); }
  /// Lines that were left out as they are too long. Any thread.
  [[nodiscard]] std::uint64_t too_long() const noexcept { return too_long_; }
  [[nodiscard]] const Endpoint& local() const noexcept { return local_; }

 private:
  using udp = boost::asio::ip::udp;
  using tcp = boost::asio::ip::tcp;

  void begin_again();
  void wait_for_datagrams();
  void take_datagrams();
  void accept();
  void read();
  void take_bytes(std::size_t count);
  /// Whole lines; returns where the last one that is none yet begins.
  std::size_t hand_over(Timestamp time, const Endpoint& source, std::string_view text);
  void pause();

  boost::asio::io_context context_{1};
  udp::socket socket_{context_};
  tcp::acceptor acceptor_{context_};
  tcp::socket accepted_{context_};
  tcp::socket connection_{context_};
  boost::asio::steady_timer pause_{context_};  // between looks
  boost::asio::steady_timer again_{context_};  // until the next connection is accepted
  Endpoint local_;
  Endpoint peer_;
  DatagramQueue queue_{kQueueBytes};
  std::array<char, 65536> bytes_{};
  std::string lines_;              // over TCP: what came of them
  bool in_long_line_ = false;      // what comes up to its end is left out
  std::uint64_t connections_ = 0;  // what was begun for an earlier one does not go on
  std::uint32_t system_dropped_ = 0;
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<std::uint64_t> too_long_{0};
};

}  // namespace rsi
