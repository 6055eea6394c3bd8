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
