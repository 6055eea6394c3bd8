#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>

#include "rsi/server.hpp"
#include "rsi/socket.hpp"
#include "rsi/tcp_framer.hpp"

namespace rsi {

/// A server for telegrams that come over TCP, as from RSI 2.x on KR C2 (port 6008). The controller
/// connects, and its stream is cut into telegrams (see tcp_framer.hpp); a reply has a length before
/// it if the telegram had one.
///
/// One connection is served. A new one of the same controller takes its place: a controller that
/// was switched off leaves the old one behind. Those of strangers are closed and counted as
/// foreign. A connection on which a reply does not leave whole and at once is closed, since what
/// follows could not be told apart.
///
/// A telegram is handed over as a datagram from the controller's end of the connection to local(),
/// with the time at which it was read: recordings hold UDP packets between these two, without
/// lengths and without what is between telegrams. What waits is read at once, and the drain rule of
/// Server holds for it.
class TcpServer : public Server {
 public:
  /// Listens; no other program can then have the port. Throws std::runtime_error with what to do.
  explicit TcpServer(Options options);

  [[nodiscard]] Transport transport() const noexcept override { return Transport::tcp; }
  void warm() noexcept override;
  void run() noexcept override;

 private:
  void accept_connections() noexcept;
  void receive() noexcept;
  void serve_received() noexcept;
  void disconnect() noexcept;
  [[nodiscard]] bool send(std::string_view reply, const Datagram& telegram) noexcept override;

  Socket listener_;
  Socket connection_;
  Endpoint peer_;
  bool broken_ = false;  // a reply did not leave: what has come is taken, then it is closed
  TcpFramer framer_;
  std::array<Datagram, kMostAtOnce> datagrams_;
  std::chrono::steady_clock::time_point accept_after_;
};

}  // namespace rsi
