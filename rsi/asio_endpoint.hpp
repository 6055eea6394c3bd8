#pragma once

#include "rsi/asio.hpp"

#include "rsi/endpoint.hpp"

namespace rsi {

/// For `boost::asio::ip::udp` or `tcp`. What the system's own calls take is its data() and size().
template <typename Protocol>
[[nodiscard]] typename Protocol::endpoint to_asio(const Endpoint& endpoint) {
  return {boost::asio::ip::address_v4(endpoint.address), endpoint.port};
}

/// Of an IPv4 endpoint; another one throws.
template <typename AsioEndpoint>
[[nodiscard]] Endpoint from_asio(const AsioEndpoint& endpoint) {
  return {endpoint.address().to_v4().to_uint(), endpoint.port()};
}

}  // namespace rsi
