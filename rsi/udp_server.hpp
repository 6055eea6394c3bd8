#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "rsi/asio.hpp"

#include "rsi/datagram_queue.hpp"
#include "rsi/endpoint.hpp"
#include "rsi/reply.hpp"

namespace rsi {

/// The address of this machine from which it reaches `peer`; nothing if there is no way to it.
[[nodiscard]] std::optional<std::uint32_t> local_address_towards(const Endpoint& peer);

/// The robot's side of the socket: answers each telegram first, hands it over afterwards.
///
/// Of several datagrams that wait, all are handed over and the newest with an IPOC is answered: the
/// older ones are late anyway. Only one controller is answered: the configured one, or the first
/// that sends an IPOC. Datagrams of others are counted and dropped.
///
/// run() is the reply thread: from reception to reply it neither parses, allocates, locks, logs nor
/// touches a file. Everything else may be called from any thread.
class UdpServer {
 public:
  struct Options {
    Endpoint listen;                          ///< port 0: the system chooses one
    std::optional<std::uint32_t> controller;  ///< nothing: the first that speaks
    std::optional<Reply> reply;               ///< nothing: send nothing (ONLYSEND)
    std::size_t queue_bytes = 4U << 20;
  };

  struct Counts {
    std::uint64_t answered = 0;
    std::uint64_t superseded = 0;    ///< not answered, since a newer one waited behind
    std::uint64_t unanswerable = 0;  ///< no IPOC could be found
    std::uint64_t foreign = 0;       ///< not from the controller
    std::uint64_t send_failures = 0;
    std::uint64_t overflows = 0;  ///< answered, but the queue had no room to hand it over
  };

  /// Binds the socket, which no other program can then share. Throws std::runtime_error with what
  /// to do.
  explicit UdpServer(Options options);

  /// Where it listens, with the port that the system chose.
  [[nodiscard]] Endpoint local() const { return local_; }

  /// Serves until stop().
  void run();
  void stop();

  /// From any thread but the one that serves: returns once what was answered by now is in the
  /// queue. A reply leaves before its telegram is queued; that takes microseconds.
  void settle() const;

  /// Telegrams and replies in the order in which they came and went; replies have local() as their
  /// source.
  [[nodiscard]] DatagramQueue& datagrams() { return queue_; }

  /// The stream has ended: where no controller is configured, the next one that speaks is served.
  void forget_controller() noexcept { current_.store(options_.controller.value_or(0)); }

  [[nodiscard]] Counts counts() const noexcept;

 private:
  using Socket = boost::asio::ip::udp::socket;
  using Buffer = std::vector<char>;

  /// A datagram that may still be answered, and the buffer that it lies in.
  struct Pending {
    Datagram datagram;
    std::string_view ipoc;
  };

  void wait();
  void serve();
  bool receive(Buffer& buffer, Pending& received);
  bool from_controller(const Pending& received);
  void answer(const Pending& pending);

  Options options_;
  boost::asio::io_context context_{1};
  Socket socket_;
  Endpoint local_;
  DatagramQueue queue_;
  std::array<Buffer, 2> buffers_;
  std::atomic<bool> serving_{false};
  std::atomic<std::uint32_t> current_;  // the controller's address; 0: none yet
  std::atomic<std::uint64_t> answered_{0}, superseded_{0}, unanswerable_{0}, foreign_{0},
      send_failures_{0};
};

}  // namespace rsi
