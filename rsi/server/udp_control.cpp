#include "rsi/server/udp_control.hpp"

#include <chrono>
#include <cstring>

namespace rsi {

void read_control(msghdr& message, Timestamp& time, in_pktinfo& came_to,
                  std::uint32_t& dropped) noexcept {
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level == IPPROTO_IP && part->cmsg_type == IP_PKTINFO)
      std::memcpy(&came_to, CMSG_DATA(part), sizeof came_to);
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SO_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
      time = std::chrono::seconds(stamp.tv_sec) + std::chrono::nanoseconds(stamp.tv_nsec);
    } else if (part->cmsg_type == SO_RXQ_OVFL) {
      std::memcpy(&dropped, CMSG_DATA(part), sizeof dropped);
    }
  }
}

}  // namespace rsi
