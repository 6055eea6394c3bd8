#pragma once

#include <array>
#include <cstdint>

#include <netinet/in.h>
#include <sys/socket.h>
#include <time.h>

#include "rsi/datagram.hpp"

namespace rsi {

/// Room for what the kernel says beside a datagram.
struct alignas(cmsghdr) UdpControl {
  std::array<char, CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(in_pktinfo)) +
                       CMSG_SPACE(sizeof(std::uint32_t))>
      bytes;
};

/// Takes what the kernel says beside a datagram: when it came, to which address and interface, and
/// how many were dropped so far. What it does not say stays as it was.
void read_control(msghdr& message, Timestamp& time, in_pktinfo& came_to,
                  std::uint32_t& dropped) noexcept;

}  // namespace rsi
