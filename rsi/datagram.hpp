#pragma once

#include <chrono>
#include <cstddef>
#include <string_view>

#include "rsi/endpoint.hpp"

namespace rsi {

/// Time of reception or sending, since the Unix epoch (UTC).
using Timestamp = std::chrono::nanoseconds;

/// What a datagram holds that travels in one Ethernet frame of 1,500 bytes, and in no pieces.
inline constexpr std::size_t kOneFrame = 1472;

/// One UDP datagram, seen live or in a capture. `payload` is a view: it stays valid only as long as
/// the object that handed the datagram out says.
struct Datagram {
  Timestamp time{};
  Endpoint source;
  Endpoint destination;
  std::string_view payload;
  bool cut = false;  ///< fewer bytes are here than were sent (capture snapped, buffer too small)
};

}  // namespace rsi
