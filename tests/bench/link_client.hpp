#pragma once

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <string_view>
#include <system_error>
#include <vector>

#include <sys/socket.h>

#include "rsi/asio.hpp"

namespace bench {

/// Sends to a server of the loopback interface, waits for what it answers, and keeps how long that
/// took.
class Client {
 public:
  explicit Client(std::uint16_t port) : socket_(context_, boost::asio::ip::udp::v4()) {
    socket_.connect({boost::asio::ip::address_v4::loopback(), port});
    const timeval longest{1, 0};
    setsockopt(socket_.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof longest);
  }

  /// The reply is valid until the next call.
  std::string_view exchange(std::string_view telegram) {
    using Clock = std::chrono::steady_clock;
    const auto sent = Clock::now();
    socket_.send(boost::asio::buffer(telegram.data(), telegram.size()));
    const auto size = recv(socket_.native_handle(), buffer_.data(), buffer_.size(), 0);
    const auto received = Clock::now();
    if (size < 0)
      throw std::system_error(errno, std::generic_category(), "no answer within a second");
    turnarounds_.push_back(received - sent);
    return {buffer_.data(), static_cast<std::size_t>(size)};
  }

  std::vector<std::chrono::nanoseconds>& turnarounds() { return turnarounds_; }

 private:
  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_;
  std::array<char, 65536> buffer_{};
  std::vector<std::chrono::nanoseconds> turnarounds_;
};

}  // namespace bench
