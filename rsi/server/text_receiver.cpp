#include "rsi/server/text_receiver.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>

#include "rsi/asio.hpp"

#include "rsi/server/server.hpp"
#include "rsi/server/socket_options.hpp"
#include "rsi/server/udp_control.hpp"

namespace rsi {
namespace {

using namespace std::chrono_literals;
using boost::system::error_code;

/// Some hundred datagrams, as the system counts them.
constexpr int kReceiveBytes = 256 << 10;
/// How a person gets another port.
constexpr std::string_view kOtherPort = "choose another port here and at the device";

}  // namespace

TextReceiver::TextReceiver(Transport transport, const Endpoint& listen) {
  error_code error;
  if (transport == Transport::udp) {
    socket_.open(udp::v4(), error);
    if (!error) socket_.bind(to_asio<udp>(listen), error);
    if (error)
      throw std::runtime_error(cannot_listen(transport, listen, error.value(), kOtherPort));
    error_code ignored;
    socket_.set_option(boost::asio::socket_base::receive_buffer_size(kReceiveBytes), ignored);
    socket_.set_option(SocketOption<SOL_SOCKET, SO_TIMESTAMPNS>(1), ignored);
    socket_.set_option(SocketOption<SOL_SOCKET, SO_RXQ_OVFL>(1), ignored);
    local_ = from_asio(socket_.local_endpoint());
    wait_for_datagrams();
  } else {
    acceptor_.open(tcp::v4(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(to_asio<tcp>(listen), error);
    if (!error) acceptor_.listen(1, error);
    if (error)
      throw std::runtime_error(cannot_listen(transport, listen, error.value(), kOtherPort));
    local_ = from_asio(acceptor_.local_endpoint());
    accept();
  }
}

void TextReceiver::run() noexcept {
  for (bool failed = false; !context_.stopped(); failed = true) {
    try {
      if (failed) begin_again();
      context_.run();
      return;
    } catch (const std::exception&) {  // no memory
      std::this_thread::sleep_for(kBetweenLooks);
    }
  }
}

/// What threw waits for nothing any more, and the end of a line may be lost with it.
void TextReceiver::begin_again() {
  error_code ignored;
  socket_.cancel(ignored);
  acceptor_.cancel(ignored);
  pause_.cancel();
  again_.cancel();
  if (socket_.is_open()) return wait_for_datagrams();
  for (const Shared& connection : connections_) {
    connection->socket.cancel(ignored);
    connection->pause.cancel();
    connection->lines.clear();
    connection->in_long_line = true;
    read(connection);
  }
  accept();
}

void TextReceiver::wait_for_datagrams() {
  socket_.async_wait(udp::socket::wait_read, [this](const error_code& error) {
    if (error == boost::asio::error::operation_aborted) return;
    if (!error) take_datagrams();
    pause();
  });
}

void TextReceiver::take_datagrams() {
  for (std::size_t i = 0; i < kMostInALook; ++i) {
    udp::endpoint source;
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): the system fills it in
    UdpControl control;
    iovec place{bytes_.data(), bytes_.size()};
    msghdr message{};
    message.msg_name = source.data();
    message.msg_namelen = static_cast<socklen_t>(source.capacity());
    message.msg_iov = &place;
    message.msg_iovlen = 1;
    message.msg_control = control.bytes.data();
    message.msg_controllen = control.bytes.size();
    const auto size = recvmsg(socket_.native_handle(), &message, MSG_DONTWAIT);
    if (size < 0) return;
    Timestamp time{};
    in_pktinfo ignored{};
    std::uint32_t dropped = system_dropped_;
    read_control(message, time, ignored, dropped);
    dropped_ += dropped - std::exchange(system_dropped_, dropped);
    if (time.count() == 0) time = now();
    std::string_view text(bytes_.data(), static_cast<std::size_t>(size));
    if (text.size() > kLongestLine) text.remove_prefix(hand_over(time, from_asio(source), text));
    if (text.size() > kLongestLine)
      ++too_long_;
    else if (!text.empty() || size == 0)
      queue_.push({time, from_asio(source), local_, text, false});
  }
}

void TextReceiver::pause() {
  pause_.expires_after(kBetweenLooks);
  pause_.async_wait([this](const error_code& error) {
    if (!error) wait_for_datagrams();
  });
}

TextReceiver::Connection::Connection(boost::asio::io_context& context, tcp::socket from)
    : socket(std::move(from)), pause(context), heard(std::chrono::steady_clock::now()) {
  error_code error;
  socket.non_blocking(true, error);
  if (const auto other = socket.remote_endpoint(error); !error) peer = from_asio(other);
}

void TextReceiver::accept() {
  acceptor_.async_accept(accepted_, [this](const error_code& error) {
    if (error == boost::asio::error::operation_aborted) return;
    if (error) {  // no descriptors or memory
      again_.expires_after(kBetweenLooks);
      return again_.async_wait([this](const error_code& ended) {
        if (!ended) accept();
      });
    }
    admit();
    accept();
  });
}

void TextReceiver::admit() {
  const auto connection =
      std::make_shared<Connection>(context_, std::exchange(accepted_, tcp::socket(context_)));
  if (connections_.size() == kMostConnections)
    close(*std::min_element(connections_.begin(), connections_.end(),
                            [](const Shared& a, const Shared& b) { return a->heard < b->heard; }));
  connections_.push_back(connection);
  read(connection);
}

void TextReceiver::read(const Shared& connection) {
  connection->socket.async_wait(
      tcp::socket::wait_read, [this, connection](const error_code& error) {
        if (error == boost::asio::error::operation_aborted) return;
        error_code failed = error;
        const std::size_t count =
            error ? 0 : connection->socket.read_some(boost::asio::buffer(bytes_), failed);
        if (failed && failed != boost::asio::error::would_block) return close(connection);
        if (count > 0) take_bytes(*connection, count);
        if (count <= kLongestLine) return read(connection);
        // One that floods is made to wait.
        connection->pause.expires_after(kBetweenLooks);
        connection->pause.async_wait([this, connection](const error_code& ended) {
          if (!ended) read(connection);
        });
      });
}

void TextReceiver::close(const Shared& connection) {
  error_code ignored;
  connection->pause.cancel();
  connection->socket.close(ignored);
  std::erase(connections_, Shared(connection));
}

void TextReceiver::take_bytes(Connection& from, std::size_t count) {
  from.heard = std::chrono::steady_clock::now();
  std::string_view fresh(bytes_.data(), count);
  if (from.in_long_line) {
    const auto end = fresh.find('\n');
    if (end == fresh.npos) return;
    fresh.remove_prefix(end + 1);
    from.in_long_line = false;
  }
  from.lines.append(fresh);
  from.lines.erase(0, hand_over(now(), from.peer, from.lines));
  if (from.lines.size() < kLongestLine) return;
  from.lines.clear();
  from.in_long_line = true;
  ++too_long_;
}

std::size_t TextReceiver::hand_over(Timestamp time, const Endpoint& source, std::string_view text) {
  for (std::size_t begin = 0;;) {
    auto end = text.rfind('\n', begin + kLongestLine - 1);
    if (end != text.npos && end >= begin) {
      queue_.push({time, source, local_, text.substr(begin, end + 1 - begin), false});
    } else {
      end = text.find('\n', begin);
      if (end == text.npos) return begin;
      ++too_long_;
    }
    begin = end + 1;
  }
}

}  // namespace rsi
