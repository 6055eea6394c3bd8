#include "rsi/datagram_queue.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

namespace rsi {

DatagramQueue::DatagramQueue(std::size_t bytes)
    : bytes_(bytes), event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (event_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

DatagramQueue::~DatagramQueue() {
  close(event_);
}

bool DatagramQueue::push(const Datagram& datagram) noexcept {
  const Header header{datagram.time, datagram.source, datagram.destination,
                      static_cast<std::uint32_t>(datagram.payload.size()), datagram.cut};
  if (bytes_.write_available() < sizeof header + datagram.payload.size()) {
    overflows_.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  std::array<char, sizeof header> raw;
  std::memcpy(raw.data(), &header, sizeof header);
  bytes_.push(raw.data(), raw.size());
  bytes_.push(datagram.payload.data(), datagram.payload.size());
  wake();
  return true;
}

bool DatagramQueue::pop(Datagram& datagram) {
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
  return true;
}

void DatagramQueue::wait(std::chrono::milliseconds longest) {
  pollfd wanted{event_, POLLIN, 0};
  if (poll(&wanted, 1, static_cast<int>(longest.count())) <= 0) return;
  std::uint64_t ignored = 0;
  [[maybe_unused]] const auto got = read(event_, &ignored, sizeof ignored);
}

void DatagramQueue::wake() noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = write(event_, &one, sizeof one);
}

}  // namespace rsi
