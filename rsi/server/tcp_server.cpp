#include "rsi/server/tcp_server.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <netinet/tcp.h>

#include "rsi/asio.hpp"

#include "rsi/server/port_owner.hpp"
#include "rsi/server/socket_options.hpp"
#include "rsi/server/udp_control.hpp"
#include "rsi/telegram/ipoc.hpp"

namespace rsi {
namespace {

using namespace std::chrono_literals;
using boost::asio::ip::tcp;
using boost::system::error_code;

/// No descriptors or memory: so long until the next connection is accepted.
constexpr auto kPause = 100ms;
/// Beside one that speaks a connection may be silent for so long.
constexpr auto kLongestWait = 10s;
constexpr int kBacklog = 16;
/// Replies that wait here are late: a controller that does not read them is soon noticed.
constexpr int kSendBuffer = 16 << 10;

using QuickAcknowledgement = SocketOption<IPPROTO_TCP, TCP_QUICKACK>;

/// What Asio calls, with the memory that it may take for it.
template <typename Function>
struct Handler {
  using allocator_type = std::pmr::polymorphic_allocator<std::byte>;

  [[nodiscard]] allocator_type get_allocator() const noexcept { return memory; }
  void operator()(const error_code& error) { function(error); }

  std::pmr::memory_resource* memory;
  Function function;
};

template <typename Function>
Handler<Function> handler(std::pmr::memory_resource& memory, Function function) {
  return {&memory, std::move(function)};
}

/// Replies leave at once and whole; a controller that vanished is noticed within seconds.
void set_options(tcp::socket& connection) noexcept {
  error_code ignored;
  connection.non_blocking(true, ignored);
  connection.set_option(tcp::no_delay(true), ignored);
  connection.set_option(QuickAcknowledgement(1), ignored);
  connection.set_option(tcp::socket::send_buffer_size(kSendBuffer), ignored);
  connection.set_option(tcp::socket::keep_alive(true), ignored);
  connection.set_option(SocketOption<IPPROTO_TCP, TCP_KEEPIDLE>(1), ignored);
  connection.set_option(SocketOption<IPPROTO_TCP, TCP_KEEPINTVL>(1), ignored);
  connection.set_option(SocketOption<IPPROTO_TCP, TCP_KEEPCNT>(3), ignored);
  connection.set_option(SocketOption<IPPROTO_TCP, TCP_USER_TIMEOUT, unsigned>(3000), ignored);
}

}  // namespace

TcpServer::TcpServer(Options options) : Server(std::move(options)) {
  const Endpoint listen_at = this->options().listen;
  error_code error;
  acceptor_.open(tcp::v4(), error);
  // Lets the port be had again while old connections to it die out; Linux still refuses it to a
  // second program that listens. Connections inherit the receive buffer and the wish for stamps.
  if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
  set_receive_buffer(enlarge_receive_buffer(acceptor_));
  error_code ignored;  // where it is missing, times are taken later
  acceptor_.set_option(SocketOption<SOL_SOCKET, SO_TIMESTAMPNS>(1), ignored);
  if (!error) acceptor_.bind(to_asio<tcp>(listen_at), error);
  if (!error) acceptor_.listen(kBacklog, error);
  if (!error) acceptor_.non_blocking(true, error);
  if (error) throw std::runtime_error(cannot_listen(Transport::tcp, listen_at, error.value()));
  set_local(from_asio(acceptor_.local_endpoint()));
}

void TcpServer::warm() noexcept {
  Server::warm();
  constexpr std::string_view kTelegram = "<Rob Type=\"KUKA\"><IPOC>1</IPOC></Rob>";
  for (auto& [socket, peer, local, broken, spoke, last_read, framer] : connections_) {
    const auto room = framer.room();
    std::memset(room.data(), 0, room.size());
    std::memcpy(room.data(), kTelegram.data(), kTelegram.size());
    framer.received(kTelegram.size());
    static_cast<void>(framer.next());
    framer.reset();
  }
  // There is no connection yet: these only take the way into the system, and Asio keeps the memory
  // of a socket that was closed for the next one.
  error_code ignored;
  for (auto& connection : connections_) connection.socket.open(tcp::v4(), ignored);
  static_cast<void>(send(kTelegram, {}));
  receive();
  for (auto& connection : connections_) close(connection);
}

// NOLINTNEXTLINE(bugprone-exception-escape): nothing but lack of memory throws
void TcpServer::run() noexcept {
  accept();
  while (!stopping()) {
    looking_ = clock();
    looked_ = now();
    context_.run_one_for(longest_look());
    beat();
    if (took_all() && !pausing_) heard_all_until(looking_);
    if (next_->socket.is_open() && looking_ - next_since_ >= kLongestWait && spoke_ >= next_since_)
      close(*next_);
  }
}

// NOLINTNEXTLINE(bugprone-exception-escape): as run()
bool TcpServer::took_all() noexcept {
  for (std::size_t taken = 0; taken < kMostAtOnce; ++taken)
    if (context_.poll_one() == 0) return true;
  return false;
}

void TcpServer::accept() noexcept {
  pausing_ = false;
  acceptor_.async_accept(
      accepted_->socket, accepted_from_, handler(memory_, [this](const error_code& error) {
        if (!error) {
          admit();
          return accept();
        }
        // The connection stays in the queue and would wake us at once.
        pausing_ = true;
        pause_.expires_after(kPause);
        pause_.async_wait(handler(memory_, [this](const error_code&) { accept(); }));
      }));
}

void TcpServer::admit() noexcept {
  accepted_->peer = from_asio(accepted_from_);
  if (!may_serve(accepted_->peer.address)) {
    add_foreign(1);
    return close(*accepted_);
  }
  if (next_->socket.is_open()) {  // they may have spoken
    receive();
    receive_next();
  }
  if (next_->socket.is_open() && !served_->spoke) std::swap(served_, next_);
  Connection*& place = served_->socket.is_open() ? next_ : served_;
  close(*place);
  std::swap(place, accepted_);
  set_options(place->socket);
  error_code ignored;
  place->local = local().address == 0 ? from_asio(place->socket.local_endpoint(ignored)) : local();
  next_since_ = looking_;
  wait(*place);
}

void TcpServer::wait(Connection& connection) noexcept {
  connection.socket.async_wait(tcp::socket::wait_read,
                               handler(memory_, [this, &connection](const error_code& closed) {
                                 if (closed) return;
                                 if (&connection == served_)
                                   receive();
                                 else
                                   receive_next();
                                 if (connection.socket.is_open()) wait(connection);
                               }));
}

std::optional<std::size_t> TcpServer::read(Connection& connection) noexcept {
  const auto room = connection.framer.room();
  UdpControl control{};
  iovec place{room.data(), room.size()};
  msghdr message{};
  message.msg_iov = &place;
  message.msg_iovlen = 1;
  message.msg_control = control.bytes.data();
  message.msg_controllen = control.bytes.size();
  // Asio hands out no stamps.
  const auto received = recvmsg(connection.socket.native_handle(), &message, MSG_DONTWAIT);
  if (received <= 0) {
    const bool nothing = received < 0 && (errno == EAGAIN || errno == EINTR);
    if (connection.broken || !nothing) return std::nullopt;
    return 0;
  }
  const auto bytes = static_cast<std::size_t>(received);
  connection.framer.received(bytes);
  TcpRead& came = connection.last_read;
  came = {.after = std::max(came.last, looked_), .taken = now(), .bytes = {room.data(), bytes}};
  in_pktinfo no_datagram{};
  std::uint32_t none_dropped = 0;
  read_control(message, came.last, no_datagram, none_dropped);
  if (came.last.count() == 0) came.last = came.taken;
  return bytes;
}

void TcpServer::receive() noexcept {
  const auto room = served_->framer.room().size();
  const auto received = read(*served_);
  if (!received) return close(*served_);
  if (*received == 0) return;
  serve_received();
  if (served_->broken && *received < room) return close(*served_);
  // The system forgets this wish. After the reply, which carries the acknowledgement, it costs no
  // packet; where none was sent, the controller must not wait for it (Nagle).
  error_code ignored;
  served_->socket.set_option(QuickAcknowledgement(1), ignored);
}

void TcpServer::receive_next() noexcept {
  if (!read(*next_)) return close(*next_);
  std::string_view telegram;
  do telegram = next_->framer.next();
  while (!telegram.empty() && find_ipoc(telegram).empty());
  if (telegram.empty()) return;
  receive();  // what the other one sent came before
  if (!may_serve(next_->peer.address)) {
    add_foreign(1);
    return close(*next_);
  }
  std::swap(served_, next_);
  close(*next_);
  serve_received(telegram);
}

void TcpServer::serve_received(std::string_view first) noexcept {
  std::size_t count = 0;
  do {
    for (count = 0; count < datagrams_.size(); ++count) {
      const auto telegram = first.empty() ? served_->framer.next() : std::exchange(first, {});
      if (telegram.empty()) break;
      datagrams_[count] = {served_->last_read.came(telegram), served_->peer, served_->local,
                           telegram, false};
      spoke_ = looking_;
      served_->spoke = true;
    }
    if (count > 0) serve({datagrams_.data(), count});
  } while (count == datagrams_.size());
  count_skipped();
}

void TcpServer::close(Connection& connection) noexcept {
  error_code ignored;
  connection.socket.close(ignored);
  connection.framer.reset();
  connection.last_read = {};
  connection.broken = connection.spoke = false;
  count_skipped();
}

void TcpServer::count_skipped() noexcept {
  std::uint64_t skipped = 0;
  for (const auto& connection : connections_) skipped += connection.framer.skipped();
  set_skipped(skipped);
}

bool TcpServer::send(std::string_view reply, const Datagram&) noexcept {
  if (served_->broken) return false;
  const auto length =
      length_bytes(served_->framer.prefix(), static_cast<std::uint32_t>(reply.size()));
  const std::array<boost::asio::const_buffer, 2> parts{
      boost::asio::buffer(length.bytes.data(), length.size),
      boost::asio::buffer(reply.data(), reply.size())};
  error_code error;
  const auto sent = served_->socket.send(parts, 0, error);
  served_->broken = error || sent != length.size + reply.size();
  return !served_->broken;
}

}  // namespace rsi
