#pragma once

#include <cstdint>

#include "rsi/datagram.hpp"
#include "rsi/endpoint.hpp"

namespace rsi::test {

inline constexpr std::uint32_t kLoopback = 0x7f000001;

/// A controller, also after a restart, and its server, on one network.
inline constexpr Endpoint kController{0xc0a80114, 49153};
inline constexpr Endpoint kRestarted{0xc0a80114, 49154};
inline constexpr Endpoint kServer{0xc0a8010a, 49152};

/// When captures begin: with digits down to the nanosecond.
inline constexpr Timestamp kCaptured{1'700'000'000'123'456'789};

}  // namespace rsi::test
