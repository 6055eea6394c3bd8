#include "rsi/controller/controller_socket.hpp"

#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <poll.h>

#include "rsi/asio.hpp"

#include "rsi/telegram/tcp_framer.hpp"

namespace rsi {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

/// Of a flood so much is taken at once, so that it cannot hold up the cycle.
constexpr int kMostAtOnce = 64;

template <typename AsioSocket>
void bind_to(AsioSocket& socket, const Endpoint& local) {
  using Protocol = typename AsioSocket::protocol_type;
  error_code error;
  socket.open(Protocol::v4(), error);
  if (!error) socket.bind(to_asio<Protocol>(local), error);
  if (!error) socket.non_blocking(true, error);
  if (error)
    throw std::runtime_error("cannot send from " + text(local) + ": " + error.message() +
                             ": choose an address of this machine and a free port");
}

class UdpControllerSocket : public ControllerSocket {
 public:
  UdpControllerSocket(asio::io_context& context, const Endpoint& local, const Endpoint& server)
      : socket_(context), server_(to_asio<asio::ip::udp>(server)) {
    bind_to(socket_, local);
  }

  Endpoint local() const override { return from_asio(socket_.local_endpoint()); }

  error_code send(std::string_view telegram) override {
    error_code error;
    socket_.send_to(asio::buffer(telegram.data(), telegram.size()), server_, 0, error);
    return error;
  }

  void receive(const OnReply& on_reply) override {
    for (int i = 0; i < kMostAtOnce; ++i) {
      asio::ip::udp::endpoint source;
      error_code error;
      const auto size = socket_.receive_from(asio::buffer(received_), source, 0, error);
      if (error == asio::error::would_block) return;
      if (error) continue;  // such as a refusal by ICMP: reading it clears it
      on_reply({received_.data(), size}, from_asio(source));
    }
  }

  void async_wait(std::function<void(const error_code&)> handler) override {
    socket_.async_wait(asio::ip::udp::socket::wait_read, std::move(handler));
  }

  void close() override {
    error_code ignored;
    socket_.close(ignored);
  }

 private:
  asio::ip::udp::socket socket_;
  asio::ip::udp::endpoint server_;
  std::array<char, 65536> received_{};
};

class TcpControllerSocket : public ControllerSocket {
 public:
  TcpControllerSocket(asio::io_context& context, const Endpoint& local, const Endpoint& server,
                      LengthPrefix length)
      : socket_(context), server_(server), length_(length) {
    bind_to(socket_, local);
    connect();
  }

  Endpoint local() const override { return local_; }

  error_code send(std::string_view telegram) override {
    if (!broken().empty()) return asio::error::not_connected;
    const auto length = length_bytes(length_, static_cast<std::uint32_t>(telegram.size()));
    const std::array<asio::const_buffer, 2> parts{asio::buffer(length.bytes.data(), length.size),
                                                  asio::buffer(telegram.data(), telegram.size())};
    error_code error;
    const auto sent = socket_.send(parts, 0, error);
    if (error == asio::error::would_block || (!error && sent < asio::buffer_size(parts)))
      break_off("the server does not read what is sent to it");
    else if (error)
      break_off(error.message());
    return error;
  }

  void receive(const OnReply& on_reply) override {
    for (int i = 0; i < kMostAtOnce && broken().empty(); ++i) {
      const auto room = framer_.room();
      error_code error;
      const auto size = socket_.receive(asio::buffer(room.data(), room.size()), 0, error);
      if (error == asio::error::would_block) return;
      if (error == asio::error::eof) return break_off("the server closed the connection");
      if (error) return break_off(error.message());
      framer_.received(size);
      for (auto reply = framer_.next(); !reply.empty(); reply = framer_.next()) {
        if (framer_.prefix() != length_)
          return break_off("the length before a reply: expected " + std::string(text(length_)) +
                           ", found " + std::string(text(framer_.prefix())));
        on_reply(reply, server_);
      }
      if (framer_.skipped() > 0) return break_off("the server sent what is no reply");
    }
  }

  void async_wait(std::function<void(const error_code&)> handler) override {
    socket_.async_wait(asio::ip::tcp::socket::wait_read, std::move(handler));
  }

  void close() override {
    error_code ignored;
    socket_.close(ignored);
  }

 private:
  void connect() {
    // By hand: Asio's own call, which does not wait, needs the context to run.
    const auto address = to_asio<asio::ip::tcp>(server_);
    const int descriptor = socket_.native_handle();
    int failure = 0;
    if (::connect(descriptor, address.data(), static_cast<socklen_t>(address.size())) != 0)
      failure = errno;
    if (failure == EINPROGRESS) {
      constexpr int kLongestWaitMs = 5000;
      pollfd waiting{descriptor, POLLOUT, 0};
      socklen_t size = sizeof failure;
      if (poll(&waiting, 1, kLongestWaitMs) != 1)
        failure = ETIMEDOUT;
      else
        getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &failure, &size);
    }
    if (failure != 0)
      throw std::runtime_error("cannot connect to " + text(server_) +
                               " over TCP: " + std::generic_category().message(failure) +
                               ": start `sweepd run` there first, with the same Ethernet file, or "
                               "check address and port");
    error_code ignored;
    socket_.set_option(asio::ip::tcp::no_delay(true), ignored);
    local_ = from_asio(socket_.local_endpoint(ignored));
  }

  asio::ip::tcp::socket socket_;
  Endpoint server_;
  Endpoint local_;
  LengthPrefix length_;
  TcpFramer framer_{"Sen"};
};

}  // namespace

std::unique_ptr<ControllerSocket> ControllerSocket::udp(asio::io_context& context,
                                                        const Endpoint& local,
                                                        const Endpoint& server) {
  return std::make_unique<UdpControllerSocket>(context, local, server);
}

std::unique_ptr<ControllerSocket> ControllerSocket::tcp(asio::io_context& context,
                                                        const Endpoint& local,
                                                        const Endpoint& server,
                                                        LengthPrefix length) {
  return std::make_unique<TcpControllerSocket>(context, local, server, length);
}

}  // namespace rsi
