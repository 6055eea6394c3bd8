#pragma once

#include <cstdint>
#include <random>

#include "rsi/asio.hpp"

namespace sweepd::test {

/// Of those that the kernel gives to nobody who asks for any: a test beside this one might be given
/// what was free a moment ago.
template <class Protocol>
std::uint16_t free_port_of() {
  std::random_device chance;
  std::uniform_int_distribution<std::uint16_t> any(20000, 32767);
  boost::asio::io_context context;
  for (;;) {
    const std::uint16_t port = any(chance);
    typename Protocol::socket socket(context, Protocol::v4());
    boost::system::error_code taken;
    socket.bind({boost::asio::ip::address_v4::loopback(), port}, taken);
    if (!taken) return port;
  }
}

}  // namespace sweepd::test
