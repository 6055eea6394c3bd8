#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "rsi/datagram.hpp"

namespace rsi {

/// What a server says of a datagram that it hands over.
struct Handling {
  bool sent = false;     ///< by the server itself
  bool streams = false;  ///< its source has sent several IPOCs in step (see callers.hpp)
};

/// Bounded queue of datagrams from one thread (the reply thread) to one other (acquisition).
/// All memory is reserved at construction: a push copies into it, without lock, allocation or
/// system call. The consumer is not woken: it looks every few milliseconds.
///
/// A queue that was emptied begins at the beginning of its memory again. So a consumer that keeps
/// up needs the first part only, which is touched at construction. Behind that the system has to
/// find a page for some pushes.
class DatagramQueue {
 public:
  /// Room for `bytes` of datagrams, each with some 40 bytes of its own. Below 4 GiB.
  explicit DatagramQueue(std::size_t bytes);
  DatagramQueue(const DatagramQueue&) = delete;
  DatagramQueue& operator=(const DatagramQueue&) = delete;

  /// Producer's thread. False, and counted, if there is no room: nothing is waited for.
  bool push(const Datagram& datagram, Handling handling = {}) noexcept;

  /// Consumer's thread. The payload is valid until the next pop.
  bool pop(Datagram& datagram, Handling* handling = nullptr);

  /// Any thread: for a producer that can wait.
  [[nodiscard]] bool half_full() const noexcept;

  /// Any thread: datagrams that found no room.
  [[nodiscard]] std::uint64_t overflows() const noexcept {
    return overflows_.load(std::memory_order_relaxed);
  }

 private:
  struct Header {
    Timestamp time{};
    Endpoint source;
    Endpoint destination;
    std::uint32_t size = 0;  // of the payload behind it
    bool cut = false;
    Handling handling;
  };

  const std::uint64_t size_;
  const std::unique_ptr<char[]> bytes_;
  /// Where the oldest datagram begins (upper half), and how many bytes from there are in use. The
  /// producer adds to the bytes; the consumer takes from them and moves the place; of an empty
  /// queue the producer alone changes both.
  std::atomic<std::uint64_t> used_{0};
  std::atomic<std::uint64_t> overflows_{0};
  std::string payload_;
};

}  // namespace rsi
