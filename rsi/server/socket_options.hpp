#pragma once

#include <cstddef>

#include <sys/socket.h>

#include "rsi/asio.hpp"

namespace rsi {

/// An option of a socket that Asio has no type for: one of its SettableSocketOption.
template <int Level, int Name, typename Value = int>
class SocketOption {
 public:
  explicit SocketOption(const Value& value) noexcept : value_(value) {}

  template <typename Protocol>
  [[nodiscard]] int level(const Protocol&) const noexcept {
    return Level;
  }
  template <typename Protocol>
  [[nodiscard]] int name(const Protocol&) const noexcept {
    return Name;
  }
  template <typename Protocol>
  [[nodiscard]] const void* data(const Protocol&) const noexcept {
    return &value_;
  }
  template <typename Protocol>
  [[nodiscard]] std::size_t size(const Protocol&) const noexcept {
    return sizeof value_;
  }

 private:
  Value value_;
};

/// Half a minute of telegrams at a cycle of 4 ms, should this machine stop that long.
inline constexpr int kReceiveBuffer = 8 << 20;

/// Wishes for a receive buffer of kReceiveBuffer. What the system made of it, in its own counting.
template <typename Socket>
// NOLINTNEXTLINE(bugprone-exception-escape): throws only if an int has another size
std::size_t enlarge_receive_buffer(Socket& socket) noexcept {
  using Forced = SocketOption<SOL_SOCKET, SO_RCVBUFFORCE>;
  boost::asio::socket_base::receive_buffer_size size(kReceiveBuffer);
  boost::system::error_code error;
  // The first needs a privilege, the second is cut to net.core.rmem_max.
  socket.set_option(Forced(kReceiveBuffer), error);
  if (error) socket.set_option(size, error);
  socket.get_option(size, error);
  return 2 * static_cast<std::size_t>(size.value());  // Asio halves what Linux says
}

}  // namespace rsi
