#include "rsi/server/datagram_queue.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

namespace rsi {
namespace {

/// A second of telegrams and replies at a cycle of 4 ms.
constexpr std::size_t kTouched = 256 << 10;

/// In the place of a size: the next datagram is at the beginning of the memory.
constexpr auto kGoesOnInFront = std::numeric_limits<std::uint32_t>::max();

constexpr std::uint64_t place(std::uint64_t used) {
  return used >> 32;
}
constexpr std::uint64_t bytes(std::uint64_t used) {
  return used & 0xffffffff;
}

}  // namespace

// Not set to zero: what is not touched takes no memory.
DatagramQueue::DatagramQueue(std::size_t bytes) : size_(bytes), bytes_(new char[bytes]) {
  std::memset(bytes_.get(), 0, std::min(bytes, kTouched));
}

bool DatagramQueue::push(const Datagram& datagram, Handling handling) noexcept {
  Header header{datagram.time,        datagram.source,
                datagram.destination, static_cast<std::uint32_t>(datagram.payload.size()),
                datagram.cut,         handling};
  const std::uint64_t need = sizeof header + datagram.payload.size();
  const auto used = used_.load(std::memory_order_acquire);
  const bool empty = bytes(used) == 0;
  const auto end = empty ? 0 : place(used) + bytes(used);
  const bool in_front = end >= size_;
  auto at = in_front ? end - size_ : end;
  const auto room = (in_front ? place(used) : size_) - at;
  std::uint64_t skipped = 0;
  if (need > room) {
    if (empty || in_front || need > place(used)) {
      overflows_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    skipped = room;
    if (room >= sizeof header) {
      Header mark{};
      mark.size = kGoesOnInFront;
      std::memcpy(bytes_.get() + at, &mark, sizeof mark);
    }
    at = 0;
  }
  std::memcpy(bytes_.get() + at, &header, sizeof header);
  if (header.size > 0)
    std::memcpy(bytes_.get() + at + sizeof header, datagram.payload.data(), header.size);
  if (empty)
    used_.store(need, std::memory_order_release);
  else
    used_.fetch_add(skipped + need, std::memory_order_release);
  return true;
}

bool DatagramQueue::half_full() const noexcept {
  return bytes(used_.load(std::memory_order_relaxed)) > size_ / 2;
}

bool DatagramQueue::pop(Datagram& datagram, Handling* handling) {
  const auto used = used_.load(std::memory_order_acquire);
  if (bytes(used) == 0) return false;
  auto at = place(used);
  auto room = size_ - at;
  Header header;
  header.size = kGoesOnInFront;
  if (room >= sizeof header) std::memcpy(&header, bytes_.get() + at, sizeof header);
  if (header.size == kGoesOnInFront) {
    at = 0;
    std::memcpy(&header, bytes_.get(), sizeof header);
  } else {
    room = 0;
  }
  payload_.assign(bytes_.get() + at + sizeof header, header.size);
  const auto taken = room + sizeof header + header.size;
  const auto next = (place(used) + taken) % size_;
  // Modulo 2^64, so that what is less is taken away.
  used_.fetch_add(((next - place(used)) << 32) - taken, std::memory_order_release);
  datagram = {header.time, header.source, header.destination, payload_, header.cut};
  if (handling != nullptr) *handling = header.handling;
  return true;
}

}  // namespace rsi
