#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include <boost/lockfree/spsc_queue.hpp>

#include "rsi/datagram.hpp"

namespace rsi {

/// What a server says of a datagram that it hands over.
struct Handling {
  bool sent = false;     ///< by the server itself
  bool streams = false;  ///< its source has sent several IPOCs in step (see callers.hpp)
};

/// Bounded queue of datagrams from one thread (the reply thread) to one other (acquisition).
/// All memory is taken and touched at construction: a push copies into it, without lock, allocation
/// or system call. The consumer is not woken: it looks every few milliseconds.
class DatagramQueue {
 public:
  /// Room for `bytes` of datagrams, each with some 40 bytes of its own.
  explicit DatagramQueue(std::size_t bytes);
  DatagramQueue(const DatagramQueue&) = delete;
  DatagramQueue& operator=(const DatagramQueue&) = delete;

  /// Producer's thread. False, and counted, if there is no room: nothing is waited for.
  bool push(const Datagram& datagram, Handling handling = {}) noexcept;

  /// Consumer's thread. The payload is valid until the next pop.
  bool pop(Datagram& datagram, Handling* handling = nullptr);

  /// Any thread: datagrams that found no room.
  [[nodiscard]] std::uint64_t overflows() const noexcept {
    return overflows_.load(std::memory_order_relaxed);
  }

 private:
  struct Header {
    Timestamp time;
    Endpoint source;
    Endpoint destination;
    std::uint32_t size;
    bool cut;
    Handling handling;
  };

  boost::lockfree::spsc_queue<char> bytes_;
  std::atomic<std::uint64_t> overflows_{0};
  std::string payload_;
};

}  // namespace rsi
