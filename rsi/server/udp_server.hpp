#pragma once

#include <memory>
#include <optional>

#include "rsi/asio.hpp"

#include "rsi/server/server.hpp"

namespace rsi {

/// A server for telegrams that come over UDP, which is how RSI 2.3 and later send them.
///
/// Asio owns the socket. The reply thread blocks on its native handle: one recvmmsg takes all that
/// waits, each datagram with the time at which the kernel got it (SO_TIMESTAMPNS) and the number
/// that found the receive buffer full (SO_RXQ_OVFL). Asio hands out none of these three, and to
/// wait by Asio before makes a reply later by a fifth to a third (docs/benchmarks.md).
///
/// Where it listens on all addresses of this machine, a reply leaves from the address and by the
/// interface that the telegram came to. Where a controller is configured, what others send does not
/// get into the receive buffer.
class UdpServer : public Server {
 public:
  /// Binds the socket, which no other program can then share. Throws std::runtime_error with what
  /// to do.
  explicit UdpServer(Options options);
  ~UdpServer() override;

  [[nodiscard]] Transport transport() const noexcept override { return Transport::udp; }
  void warm() noexcept override;
  void run() noexcept override;

 private:
  struct Buffers;

  void wake() noexcept override;
  // NOLINTNEXTLINE(bugprone-exception-escape): see its definition
  [[nodiscard]] bool send(std::string_view reply, const Datagram& telegram) noexcept override;
  /// How many datagrams there were; nothing if the system did not say.
  [[nodiscard]] std::optional<std::size_t> receive(int flags) noexcept;

  /// The system's count of datagrams that it dropped before this one.
  void count_dropped(std::uint32_t until_this_datagram) noexcept;

  boost::asio::io_context context_{1};  // never runs
  boost::asio::ip::udp::socket socket_{context_};
  bool filtered_ = false;    // strangers do not get into the receive buffer
  bool everywhere_ = false;  // listens on all addresses of this machine
  std::unique_ptr<Buffers> buffers_;
};

}  // namespace rsi
