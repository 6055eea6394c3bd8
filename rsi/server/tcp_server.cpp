#include "rsi/server/tcp_server.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <netinet/tcp.h>
#include <poll.h>
#include <sys/uio.h>
#include <unistd.h>

#include "rsi/server/port_owner.hpp"
#include "rsi/telegram/ipoc.hpp"

namespace rsi {
namespace {

using namespace std::chrono_literals;

/// No descriptors or memory: so long until the next connection is accepted.
constexpr auto kPause = 100ms;
/// Beside one that speaks a connection may be silent for so long.
constexpr auto kLongestWait = 10s;
constexpr int kBacklog = 16;
/// Of a flood of connections so many are looked at before telegrams again.
constexpr int kMostAccepted = 16;
/// Replies that wait here are late: a controller that does not read them is soon noticed.
constexpr int kSendBuffer = 16 << 10;

/// Replies leave at once and whole; a controller that vanished is noticed within seconds.
void set_options(const Socket& connection) noexcept {
  connection.set(IPPROTO_TCP, TCP_NODELAY, 1);
  connection.set(IPPROTO_TCP, TCP_QUICKACK, 1);
  connection.set(SOL_SOCKET, SO_SNDBUF, kSendBuffer);
  connection.set(SOL_SOCKET, SO_KEEPALIVE, 1);
  connection.set(IPPROTO_TCP, TCP_KEEPIDLE, 1);
  connection.set(IPPROTO_TCP, TCP_KEEPINTVL, 1);
  connection.set(IPPROTO_TCP, TCP_KEEPCNT, 3);
  connection.set(IPPROTO_TCP, TCP_USER_TIMEOUT, 3000U);
}

Socket accept_from(const Socket& listener, Endpoint& peer) noexcept {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  Socket connection(accept4(listener.get(), reinterpret_cast<sockaddr*>(&address), &size,
                            SOCK_NONBLOCK | SOCK_CLOEXEC));
  peer = from_system(address);
  return connection;
}

/// Where it was connected to.
Endpoint local_end(const Socket& connection) noexcept {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(connection.get(), reinterpret_cast<sockaddr*>(&address), &size);
  return from_system(address);
}

}  // namespace

TcpServer::TcpServer(Options options)
    : Server(std::move(options)),
      listener_(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  const Endpoint listen_at = this->options().listen;
  auto address = to_system(listen_at);
  socklen_t size = sizeof address;
  auto* const system_address = reinterpret_cast<sockaddr*>(&address);
  // Lets the port be had again while old connections to it die out; Linux still refuses it to a
  // second program that listens. Connections inherit the receive buffer.
  listener_.set(SOL_SOCKET, SO_REUSEADDR, 1);
  set_receive_buffer(listener_.enlarge_receive_buffer(kReceiveBuffer));
  if (!listener_.open() || bind(listener_.get(), system_address, size) != 0 ||
      listen(listener_.get(), kBacklog) != 0 ||
      getsockname(listener_.get(), system_address, &size) != 0)
    throw std::runtime_error(cannot_listen(Transport::tcp, listen_at, errno));
  set_local(from_system(address));
}

void TcpServer::warm() noexcept {
  Server::warm();
  constexpr std::string_view kTelegram = "<Rob Type=\"KUKA\"><IPOC>1</IPOC></Rob>";
  for (auto* framer : {&served_.framer, &next_.framer}) {
    const auto room = framer->room();
    std::memset(room.data(), 0, room.size());
    std::memcpy(room.data(), kTelegram.data(), kTelegram.size());
    framer->received(kTelegram.size());
    static_cast<void>(framer->next());
    framer->reset();
  }
  // There is no connection yet: these two only take the way into the system.
  receive();
  static_cast<void>(send(kTelegram, {}));
  served_.broken = false;
}

void TcpServer::run() noexcept {
  while (!stopping()) {
    looking_ = clock();
    const bool accepts = std::chrono::steady_clock::now() >= accept_after_;
    // poll leaves out what is -1.
    std::array<pollfd, 3> waiting{pollfd{served_.socket.get(), POLLIN, 0},
                                  pollfd{next_.socket.get(), POLLIN, 0},
                                  pollfd{accepts ? listener_.get() : -1, POLLIN, 0}};
    const int ready =
        poll(waiting.data(), waiting.size(), static_cast<int>(longest_look().count()));
    beat();
    if (ready < 0 && errno != EINTR) usleep(1000);  // one that lasts must not take the processor
    if (ready == 0 && accepts) heard_all_until(looking_);
    if (ready > 0 && waiting[0].revents != 0) receive();
    if (ready > 0 && waiting[1].revents != 0) receive_next();
    if (ready > 0 && waiting[2].revents != 0) accept_connections();
    if (next_.socket.open() && looking_ - next_since_ >= kLongestWait && spoke_ >= next_since_)
      close(next_);
  }
}

void TcpServer::accept_connections() noexcept {
  for (int i = 0; i < kMostAccepted; ++i) {
    Endpoint peer;
    Socket connection = accept_from(listener_, peer);
    if (!connection.open()) {
      if (errno == ECONNABORTED || errno == EINTR) continue;
      // The connection stays in the queue and would wake us at once.
      if (errno != EAGAIN) accept_after_ = std::chrono::steady_clock::now() + kPause;
      return;
    }
    if (!may_serve(peer.address)) {
      add_foreign(1);
      continue;
    }
    if (next_.socket.open()) receive_next();  // it may have spoken
    Connection& place = served_.socket.open() ? next_ : served_;
    close(place);
    set_options(connection);
    place.local = local().address == 0 ? local_end(connection) : local();
    place.socket = std::move(connection);
    place.peer = peer;
    next_since_ = looking_;
  }
}

std::optional<std::size_t> TcpServer::read(Connection& connection) noexcept {
  const auto room = connection.framer.room();
  const auto received = recv(connection.socket.get(), room.data(), room.size(), MSG_DONTWAIT);
  if (received > 0) {
    connection.framer.received(static_cast<std::size_t>(received));
    return static_cast<std::size_t>(received);
  }
  if (received < 0 && !connection.broken && (errno == EAGAIN || errno == EINTR)) return 0;
  return std::nullopt;
}

void TcpServer::receive() noexcept {
  const auto room = served_.framer.room().size();
  const auto received = read(served_);
  if (!received) return close(served_);
  if (*received == 0) return;
  serve_received();
  if (served_.broken && *received < room) return close(served_);
  // The system forgets this wish. After the reply, which carries the acknowledgement, it costs no
  // packet; where none was sent, the controller must not wait for it (Nagle).
  served_.socket.set(IPPROTO_TCP, TCP_QUICKACK, 1);
}

void TcpServer::receive_next() noexcept {
  if (!read(next_)) return close(next_);
  std::string_view telegram;
  do telegram = next_.framer.next();
  while (!telegram.empty() && find_ipoc(telegram).empty());
  if (telegram.empty()) return;
  if (!may_serve(next_.peer.address)) {
    add_foreign(1);
    return close(next_);
  }
  std::swap(served_, next_);
  close(next_);
  serve_received(telegram);
}

void TcpServer::serve_received(std::string_view first) noexcept {
  const Timestamp time = now();
  std::size_t count = 0;
  do {
    for (count = 0; count < datagrams_.size(); ++count) {
      const auto telegram = first.empty() ? served_.framer.next() : std::exchange(first, {});
      if (telegram.empty()) break;
      datagrams_[count] = {time, served_.peer, served_.local, telegram, false};
      spoke_ = looking_;
    }
    if (count > 0) serve({datagrams_.data(), count});
  } while (count == datagrams_.size());
  set_skipped(served_.framer.skipped() + next_.framer.skipped());
}

void TcpServer::close(Connection& connection) noexcept {
  connection.socket = Socket();
  connection.framer.reset();
  connection.broken = false;
  set_skipped(served_.framer.skipped() + next_.framer.skipped());
}

bool TcpServer::send(std::string_view reply, const Datagram&) noexcept {
  if (served_.broken) return false;
  const auto length =
      length_bytes(served_.framer.prefix(), static_cast<std::uint32_t>(reply.size()));
  std::array<iovec, 2> parts{iovec{const_cast<char*>(length.bytes.data()), length.size},
                             iovec{const_cast<char*>(reply.data()), reply.size()}};
  msghdr message{};
  message.msg_iov = parts.data();
  message.msg_iovlen = parts.size();
  const auto sent = sendmsg(served_.socket.get(), &message, MSG_DONTWAIT | MSG_NOSIGNAL);
  served_.broken = sent != static_cast<ssize_t>(length.size + reply.size());
  return !served_.broken;
}

}  // namespace rsi
