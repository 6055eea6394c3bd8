#pragma once

#include <chrono>
#include <cstdint>

#include "rsi/controller/controller_link.hpp"

namespace rsi::test {

inline ControllerLink::Options link_options(
    const Endpoint& server, std::chrono::milliseconds cycle = std::chrono::milliseconds(2),
    std::uint64_t timeout = 100) {
  ControllerLink::Options options;
  options.controller = {.server = server, .cycle = cycle, .first_ipoc = 7000, .timeout = timeout};
  return options;
}

/// So many, each told by its position's X.
inline ControllerLink::Program cycles(std::uint64_t count) {
  return [count](std::uint64_t cycle, SignalValues& values) {
    values.RIst[0] = static_cast<double>(cycle);
    return cycle < count;
  };
}

}  // namespace rsi::test
