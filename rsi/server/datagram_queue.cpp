#include "rsi/server/datagram_queue.hpp"

#include <array>
#include <cstring>

namespace rsi {

DatagramQueue::DatagramQueue(std::size_t bytes) : bytes_(bytes) {
  // Once round the ring: its pages are there before the first telegram is.
  const std::array<char, 4096> block{};
  std::array<char, 4096> out;
  for (std::size_t done = 0; done < bytes; done += bytes_.pop(out.data(), out.size()))
    bytes_.push(block.data(), block.size());
}

bool DatagramQueue::push(const Datagram& datagram, Handling handling) noexcept {
  const Header header{datagram.time,        datagram.source,
                      datagram.destination, static_cast<std::uint32_t>(datagram.payload.size()),
                      datagram.cut,         handling};
  if (bytes_.write_available() < sizeof header + datagram.payload.size()) {
    overflows_.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  std::array<char, sizeof header> raw;
  std::memcpy(raw.data(), &header, sizeof header);
  bytes_.push(raw.data(), raw.size());
  bytes_.push(datagram.payload.data(), datagram.payload.size());
  return true;
}

bool DatagramQueue::pop(Datagram& datagram, Handling* handling) {
  Header header;
  if (bytes_.read_available() < sizeof header) return false;
  std::array<char, sizeof header> raw;
  bytes_.pop(raw.data(), raw.size());
  std::memcpy(&header, raw.data(), sizeof header);
  payload_.resize(header.size);
  // The producer may be between its two pushes: the rest is a few instructions away.
  for (std::size_t have = 0; have < header.size;)
    have += bytes_.pop(payload_.data() + have, header.size - have);
  datagram = {header.time, header.source, header.destination, payload_, header.cut};
  if (handling != nullptr) *handling = header.handling;
  return true;
}

}  // namespace rsi
