#include "rsi/server/text_receiver.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "rsi/asio_endpoint.hpp"
#include "rsi/server/server.hpp"
#include "rsi/server/socket_options.hpp"
#include "rsi/server/udp_control.hpp"

namespace rsi {
namespace {

using namespace std::chrono_literals;
using boost::system::error_code;

constexpr auto kBetweenLooks = 10ms;
/// In one look: 10,000 datagrams a second are more than any device sends.
constexpr std::size_t kMostInALook = 100;
/// Some hundred datagrams, as the system counts them.
constexpr int kReceiveBytes = 256 << 10;
/// No line of numbers is as long as what fits into one network frame of most.
constexpr std::size_t kMostPayload = 8192;

}  // namespace

TextReceiver::TextReceiver(Transport transport, const Endpoint& listen) {
  error_code error;
  if (transport == Transport::udp) {
    socket_.open(udp::v4(), error);
    if (!error) socket_.bind(to_asio<udp>(listen), error);
    if (error) throw std::runtime_error(cannot_listen(transport, listen, error.value()));
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
    if (error) throw std::runtime_error(cannot_listen(transport, listen, error.value()));
    local_ = from_asio(acceptor_.local_endpoint());
    accept();
  }
}

void TextReceiver::run() noexcept {
  while (!context_.stopped()) {
    try {
      context_.run();
      return;
    } catch (const std::exception&) {  // no memory: on with the next one
    }
  }
}

void TextReceiver::wait_for_datagrams() {
  socket_.async_wait(udp::socket::wait_read, [this](const error_code& error) {
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
    const auto taken = std::min(static_cast<std::size_t>(size), kMostPayload);
    queue_.push({time.count() == 0 ? now() : time,
                 from_asio(source),
                 local_,
                 {bytes_.data(), taken},
                 taken < static_cast<std::size_t>(size)});
  }
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
    error_code ignored;
    connection_.close(ignored);
    connection_ = std::exchange(accepted_, tcp::socket(context_));
    peer_ = {};
    if (const auto peer = connection_.remote_endpoint(ignored); !ignored) peer_ = from_asio(peer);
    lines_.clear();
    ++connections_;
    read();
    accept();
  });
}

void TextReceiver::read() {
  connection_.async_read_some(
      boost::asio::buffer(bytes_),
      [this, of = connections_](const error_code& error, std::size_t count) {
        if (of != connections_) return;
        if (error) {
          error_code ignored;
          connection_.close(ignored);
          return;
        }
        take_bytes(count);
        // One that floods is made to wait.
        if (count > kMostPayload)
          pause();
        else
          read();
      });
}

void TextReceiver::take_bytes(std::size_t count) {
  const auto time = now();
  lines_.append(bytes_.data(), count);
  std::size_t begin = 0;
  while (true) {
    const auto end = lines_.rfind('\n', begin + kMostPayload - 1);
    if (end == std::string::npos || end < begin) break;
    queue_.push(
        {time, peer_, local_, std::string_view(lines_).substr(begin, end + 1 - begin), false});
    begin = end + 1;
  }
  lines_.erase(0, begin);
  if (lines_.size() > kLongestLine) {
    lines_.clear();
    ++dropped_;
  }
}

void TextReceiver::pause() {
  pause_.expires_after(kBetweenLooks);
  pause_.async_wait([this, of = connections_](const error_code& error) {
    if (error || of != connections_) return;
    if (socket_.is_open())
      wait_for_datagrams();
    else if (connection_.is_open())
      read();
  });
}

}  // namespace rsi
