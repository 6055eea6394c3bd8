#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "rsi/asio.hpp"

#include "rsi/server/datagram_queue.hpp"
#include "rsi/server/port_owner.hpp"

namespace rsi {

/// Receives lines of text from a measuring device, over UDP or TCP, and answers nothing. Whatever
/// floods it waits in the system's buffer, and is dropped there: it looks a hundred times a second,
/// and takes a bounded number of datagrams each time. Datagrams have the kernel's time stamps.
///
/// Over TCP connections are read beside each other: a device that comes again may have left one
/// behind, and what else connects must not end what the device says. One more than kMostConnections
/// takes the place of that which has said nothing for longest. Whole lines are handed over as
/// datagrams, with the time at which they were read. Lines that are longer than kLongestLine are
/// left out.
class TextReceiver {
 public:
  static constexpr std::size_t kQueueBytes = 1 << 20;
  /// Bytes, with its end: no line of numbers is as long.
  static constexpr std::size_t kLongestLine = 8192;
  static constexpr std::size_t kMostConnections = 4;
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

  struct Connection {
    Connection(boost::asio::io_context& context, tcp::socket from);
    tcp::socket socket;
    boost::asio::steady_timer pause;  // between looks at one that floods
    Endpoint peer;
    std::chrono::steady_clock::time_point heard;  // or accepted
    std::string lines;                            // what came of them
    bool in_long_line = false;                    // what comes up to its end is left out
  };
  using Shared = std::shared_ptr<Connection>;  // what waits for one that is closed has it, too

  void begin_again();
  void wait_for_datagrams();
  void take_datagrams();
  void pause();
  void accept();
  void admit();
  void read(const Shared& connection);
  void close(const Shared& connection);
  void take_bytes(Connection& from, std::size_t count);
  /// Whole lines; returns where the last one that is none yet begins.
  std::size_t hand_over(Timestamp time, const Endpoint& source, std::string_view text);

  boost::asio::io_context context_{1};
  udp::socket socket_{context_};
  tcp::acceptor acceptor_{context_};
  tcp::socket accepted_{context_};
  std::vector<Shared> connections_;
  boost::asio::steady_timer pause_{context_};  // between looks for datagrams
  boost::asio::steady_timer again_{context_};  // until the next connection is accepted
  Endpoint local_;
  DatagramQueue queue_{kQueueBytes};
  std::array<char, 65536> bytes_{};
  std::uint32_t system_dropped_ = 0;
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<std::uint64_t> too_long_{0};
};

}  // namespace rsi
