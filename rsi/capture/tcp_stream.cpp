#include "rsi/capture/tcp_stream.hpp"

#include <algorithm>
#include <utility>

namespace rsi {
namespace {

/// From one sequence number to another, either way: they count on from 0 behind the largest.
std::int32_t distance(std::uint32_t from, std::uint32_t to) {
  return static_cast<std::int32_t>(to - from);
}

}  // namespace

void TcpStream::take(std::uint32_t sequence, bool begins, std::string_view bytes,
                     const Sink& telegram) {
  if (begins || !joined_) {
    framer_.reset();
    waiting_.clear();
    joined_ = true;
    next_ = begins ? sequence + 1 : sequence;
    if (begins) return;
  }
  if (bytes.empty() || distance(next_, sequence + static_cast<std::uint32_t>(bytes.size())) <= 0)
    return;
  auto& waits = waiting_[sequence];
  if (waits.size() < bytes.size()) waits = bytes;
  go_on(telegram);
  if (waiting_.size() <= kMostWaiting) return;
  const auto nearest =
      std::min_element(waiting_.begin(), waiting_.end(), [this](const auto& a, const auto& b) {
        return distance(next_, a.first) < distance(next_, b.first);
      });
  missed_ += static_cast<std::uint64_t>(distance(next_, nearest->first));
  next_ = nearest->first;
  framer_.reset();
  go_on(telegram);
}

void TcpStream::go_on(const Sink& telegram) {
  for (auto at = waiting_.begin(); at != waiting_.end();) {
    const auto known = -std::int64_t{distance(next_, at->first)};
    if (known < 0) {
      ++at;
      continue;
    }
    const std::string bytes = std::move(at->second);
    waiting_.erase(at);
    if (static_cast<std::size_t>(known) < bytes.size())
      append(std::string_view(bytes).substr(static_cast<std::size_t>(known)), telegram);
    at = waiting_.begin();
  }
}

void TcpStream::append(std::string_view bytes, const Sink& telegram) {
  next_ += static_cast<std::uint32_t>(bytes.size());
  while (!bytes.empty()) {
    const auto room = framer_.room();
    const auto size = std::min(room.size(), bytes.size());
    std::copy_n(bytes.begin(), size, room.begin());
    bytes.remove_prefix(size);
    framer_.received(size);
    for (auto whole = framer_.next(); !whole.empty(); whole = framer_.next()) telegram(whole);
  }
}

}  // namespace rsi
