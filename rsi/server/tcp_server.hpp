#pragma once

#include <array>
#include <cstddef>
#include <memory_resource>
#include <optional>
#include <string_view>

#include "rsi/asio.hpp"

#include "rsi/server/server.hpp"
#include "rsi/server/tcp_read.hpp"
#include "rsi/telegram/tcp_framer.hpp"

namespace rsi {

/// A server for telegrams that come over TCP, as from RSI 2.x on KR C2 (port 6008). The controller
/// connects, and its stream is cut into telegrams (see tcp_framer.hpp); a reply has a length before
/// it if the telegram had one.
///
/// One connection is served. A new one waits, and takes its place with its first telegram: a
/// controller that was switched off leaves the old one behind, and one that says nothing must not
/// end a stream. One waits at most, and no longer than ten seconds beside one that speaks. Where
/// neither has said anything, a third takes the place of the older one. Those of strangers are
/// closed and counted as foreign. A connection on which a reply does not leave whole
/// and at once is closed, since what follows could not be told apart.
///
/// A telegram is handed over as a datagram from the controller's end of the connection to local(),
/// with the time at which the kernel got its last byte (SO_TIMESTAMPNS; see tcp_read.hpp):
/// recordings hold UDP packets between these two, without lengths and without what is between
/// telegrams. What waits is read at once, and the drain rule of Server holds for it.
class TcpServer : public Server {
 public:
  /// Listens; no other program can then have the port. Throws std::runtime_error with what to do.
  explicit TcpServer(Options options);

  [[nodiscard]] Transport transport() const noexcept override { return Transport::tcp; }
  void warm() noexcept override;
  // NOLINTNEXTLINE(bugprone-exception-escape): see its definition
  void run() noexcept override;

 private:
  using tcp = boost::asio::ip::tcp;
  struct Connection {
    tcp::socket socket;
    Endpoint peer{};
    Endpoint local{};
    bool broken = false;  // a reply did not leave: what has come is taken, then it is closed
    bool spoke = false;
    TcpRead last_read{};
    TcpFramer framer{};
  };

  /// Takes what else has come. False if that is too much for now: a flood of connections.
  // NOLINTNEXTLINE(bugprone-exception-escape): see its definition
  [[nodiscard]] bool took_all() noexcept;
  void accept() noexcept;
  /// The one that was accepted.
  void admit() noexcept;
  /// Takes what comes there, until it is closed.
  void wait(Connection& connection) noexcept;
  /// How many bytes came; nothing if the connection is to be closed.
  [[nodiscard]] std::optional<std::size_t> read(Connection& connection) noexcept;
  void receive() noexcept;
  void receive_next() noexcept;
  /// All that has come whole; `first` was taken from the framer before.
  void serve_received(std::string_view first = {}) noexcept;
  void close(Connection& connection) noexcept;
  void count_skipped() noexcept;
  void wake() noexcept override { context_.stop(); }
  [[nodiscard]] bool send(std::string_view reply, const Datagram& telegram) noexcept override;

  // What Asio waits for is kept here: it takes no other memory.
  std::array<std::byte, 16 << 10> room_{};
  std::pmr::monotonic_buffer_resource fixed_{room_.data(), room_.size()};
  std::pmr::unsynchronized_pool_resource memory_{&fixed_};
  boost::asio::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  tcp::endpoint accepted_from_;
  boost::asio::steady_timer pause_{context_};  // until the next one is accepted
  bool pausing_ = false;
  std::array<Connection, 3> connections_{Connection{tcp::socket(context_)},
                                         Connection{tcp::socket(context_)},
                                         Connection{tcp::socket(context_)}};
  Connection* served_ = &connections_[0];
  Connection* next_ = &connections_[1];      // waits
  Connection* accepted_ = &connections_[2];  // is to come
  Callers::Time looking_;
  Timestamp looked_{};  // the same by the system's clock
  Callers::Time next_since_;
  Callers::Time spoke_;  // the one that is served
  std::array<Datagram, kMostAtOnce> datagrams_;
};

}  // namespace rsi
