#pragma once

#include <chrono>
#include <string_view>

#include "rsi/endpoint.hpp"

namespace rsi {

/// Time of reception or sending, since the Unix epoch (UTC).
using Timestamp = std::chrono::nanoseconds;

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
