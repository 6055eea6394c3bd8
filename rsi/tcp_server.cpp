#include "rsi/tcp_server.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <netinet/tcp.h>
#include <poll.h>
#include <sys/uio.h>
#include <unistd.h>

#include "rsi/port_owner.hpp"

namespace rsi {
namespace {

using namespace std::chrono_literals;

/// No descriptors or memory: so long until the next connection is accepted.
constexpr auto kPause = 100ms;
constexpr int kBacklog = 16;
/// Of a flood of connections so many are looked at before telegrams again.
constexpr int kMostAccepted = 16;
/// As much as a UdpServer asks for.
constexpr int kReceiveBuffer = 8 << 20;
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
  const auto room = framer_.room();
  std::memset(room.data(), 0, room.size());
  std::memcpy(room.data(), kTelegram.data(), kTelegram.size());
  framer_.received(kTelegram.size());
  static_cast<void>(framer_.next());
  framer_.reset();
  // There is no connection yet: these two only take the way into the system.
  receive();
  static_cast<void>(send(kTelegram, {}));
  broken_ = false;
}

void TcpServer::run() noexcept {
  while (!stopping()) {
    const auto looking = clock();
    const bool accepts = std::chrono::steady_clock::now() >= accept_after_;
    // poll leaves out what is -1.
    std::array<pollfd, 2> waiting{pollfd{connection_.get(), POLLIN, 0},
                                  pollfd{accepts ? listener_.get() : -1, POLLIN, 0}};
    const int ready =
        poll(waiting.data(), waiting.size(), static_cast<int>(longest_look().count()));
    beat();
    if (ready < 0 && errno != EINTR) usleep(1000);  // one that lasts must not take the processor
    if (ready == 0 && accepts) heard_all_until(looking);
    if (ready <= 0) continue;
    if (waiting[0].revents != 0) receive();
    if (waiting[1].revents != 0) accept_connections();
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
    disconnect();
    set_options(connection);
    connection_ = std::move(connection);
    peer_ = peer;
  }
}

void TcpServer::receive() noexcept {
  const auto room = framer_.room();
  const auto received = recv(connection_.get(), room.data(), room.size(), MSG_DONTWAIT);
  if (received <= 0) {
    if (received == 0 || broken_ || (errno != EAGAIN && errno != EINTR)) disconnect();
    return;
  }
  framer_.received(static_cast<std::size_t>(received));
  serve_received();
  if (broken_ && static_cast<std::size_t>(received) < room.size()) return disconnect();
  // The system forgets this wish. After the reply, which carries the acknowledgement, it costs no
  // packet; where none was sent, the controller must not wait for it (Nagle).
  connection_.set(IPPROTO_TCP, TCP_QUICKACK, 1);
}

void TcpServer::serve_received() noexcept {
  const Timestamp time = now();
  std::size_t count = 0;
  do {
    for (count = 0; count < datagrams_.size(); ++count) {
      const auto telegram = framer_.next();
      if (telegram.empty()) break;
      datagrams_[count] = {time, peer_, local(), telegram, false};
    }
    if (count > 0) serve({datagrams_.data(), count});
  } while (count == datagrams_.size());
  set_skipped(framer_.skipped());
}

void TcpServer::disconnect() noexcept {
  connection_ = Socket();
  framer_.reset();
  set_skipped(framer_.skipped());
  broken_ = false;
}

bool TcpServer::send(std::string_view reply, const Datagram&) noexcept {
  if (broken_) return false;
  const auto length = length_bytes(framer_.prefix(), static_cast<std::uint32_t>(reply.size()));
  std::array<iovec, 2> parts{iovec{const_cast<char*>(length.bytes.data()), length.size},
                             iovec{const_cast<char*>(reply.data()), reply.size()}};
  msghdr message{};
  message.msg_iov = parts.data();
  message.msg_iovlen = parts.size();
  const auto sent = sendmsg(connection_.get(), &message, MSG_DONTWAIT | MSG_NOSIGNAL);
  broken_ = sent != static_cast<ssize_t>(length.size + reply.size());
  return !broken_;
}

}  // namespace rsi
