#include "rsi/capture/copy_filter.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

namespace rsi {
namespace {

/// Copies that a packet has at most: more are a flood.
constexpr unsigned kMostTimes = 8;

/// Of those that may be open at once; cycles are 4 ms, so mostly they are six.
constexpr std::size_t kMostOpen = 64;

std::size_t hash_of(const Datagram& datagram, std::uint16_t identification) {
  std::size_t hash = std::hash<std::string_view>()(datagram.payload);
  const auto mix = [&hash](std::uint64_t value) { hash = (hash ^ value) * 0x9e3779b97f4a7c15U; };
  mix(identification);
  mix(std::uint64_t{datagram.source.address} << 16 | datagram.source.port);
  mix(std::uint64_t{datagram.destination.address} << 16 | datagram.destination.port);
  return hash;
}

}  // namespace

unsigned CopyFilter::Direction::add(Timestamp time, std::size_t hash) {
  // Of several interfaces the stamps may be out of order by a little.
  const auto group = std::find_if(open_.rbegin(), open_.rend(), [&](const Group& open) {
    return open.hash == hash && std::chrono::abs(time - open.first) <= kTogether;
  });
  if (group != open_.rend()) return group->count++;
  open_.push_back({time, hash, 1});
  return 0;
}

void CopyFilter::Direction::close(Timestamp now, bool all) {
  const auto closes = [&](const Group& group) {
    return all || open_.size() > kMostOpen || std::chrono::abs(now - group.first) > kTogether;
  };
  bool news = false;
  for (; !open_.empty() && closes(open_.front()); open_.pop_front()) {
    told_.push_back(std::min(open_.front().count, kMostTimes));
    if (told_.size() > kDecides) told_.pop_front();
    news = true;
  }
  if (!news) return;
  std::array<std::size_t, kMostTimes + 1> often{};
  for (const unsigned count : told_) ++often[count];
  times_ = static_cast<unsigned>(std::max_element(often.begin() + 1, often.end()) - often.begin());
}

void CopyFilter::take(const Datagram& datagram, std::uint16_t identification, bool answers) {
  for (auto& direction : directions_) direction.close(datagram.time, false);
  const auto before =
      directions_[answers ? 1 : 0].add(datagram.time, hash_of(datagram, identification));
  if (decided_) return judge(datagram, before, answers);
  held_.push_back({datagram, std::string(datagram.payload), before, answers});
  if (directions_[0].told() + directions_[1].told() >= kDecides) settle();
}

void CopyFilter::settle() {
  if (decided_ || held_.empty()) return;
  // The newest may still get their copies: they tell nothing yet.
  for (auto& direction : directions_) direction.close(held_.back().datagram.time, false);
  if (directions_[0].told() + directions_[1].told() < kDecides)
    for (auto& direction : directions_) direction.close({}, true);
  decided_ = true;
  for (auto& held : std::exchange(held_, {})) {
    held.datagram.payload = held.payload;
    judge(held.datagram, held.before, held.answers);
  }
}

unsigned CopyFilter::times() const noexcept {
  return std::max(directions_[0].times(), directions_[1].times());
}

void CopyFilter::judge(const Datagram& datagram, unsigned before, bool answers) {
  if (before % directions_[answers ? 1 : 0].times() != 0)
    ++copies_;
  else
    pass_(datagram);
}

}  // namespace rsi
