#pragma once

#include <cstddef>
#include <utility>

#include <netinet/in.h>
#include <sys/socket.h>

#include "rsi/endpoint.hpp"

namespace rsi {

/// Half a minute of telegrams at a cycle of 4 ms, should this machine stop that long.
inline constexpr int kReceiveBuffer = 8 << 20;

/// A socket of the system, closed at its end of life. No socket: -1.
class Socket {
 public:
  Socket() = default;
  explicit Socket(int descriptor) noexcept : descriptor_(descriptor) {}
  Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Socket& operator=(Socket&& other) noexcept;
  ~Socket();

  [[nodiscard]] int get() const noexcept { return descriptor_; }
  [[nodiscard]] bool open() const noexcept { return descriptor_ >= 0; }

  template <typename Value>
  bool set(int level, int option, const Value& value) const noexcept {
    return setsockopt(descriptor_, level, option, &value, sizeof value) == 0;
  }

  /// Wishes for a receive buffer of so many bytes. What the system made of it, in its own counting.
  std::size_t enlarge_receive_buffer(int bytes) const noexcept;

 private:
  int descriptor_ = -1;
};

[[nodiscard]] sockaddr_in to_system(const Endpoint& endpoint) noexcept;
[[nodiscard]] Endpoint from_system(const sockaddr_in& address) noexcept;

}  // namespace rsi
