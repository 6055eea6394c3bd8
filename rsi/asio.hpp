#pragma once

// The only door to Boost.Asio: Boost 1.74 uses std::exchange in its C++20 coroutine header without
// including <utility>, so that must come first.
#include <utility>

// g++ 12 sees null pointers in Asio's epoll reactor where there are none.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wnull-dereference"
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#pragma GCC diagnostic pop

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
