#include "daemon/service/live_slices.hpp"

#include <algorithm>

namespace sweepd {

bool LiveSlices::try_add(const LiveSlice& slice,
                         const std::vector<std::shared_ptr<const LiveSweep>>& sweeps) {
  const std::unique_lock now(mutex_, std::try_to_lock);
  if (!now) return false;
  if (ring_.empty()) ring_.resize(kSlices);
  ring_[slice.number % kSlices] = slice;
  newest_ = slice.number;
  for (const auto& sweep : sweeps) sweeps_.push_back(sweep);
  while (!sweeps_.empty() &&
         (sweeps_.size() > kSweeps || sweeps_.front()->session != slice.session))
    sweeps_.pop_front();
  return true;
}

LiveSlices::News LiveSlices::after(std::uint64_t slice, std::uint64_t sweep,
                                   std::size_t most) const {
  most = std::min(most, kSlices);
  News news;
  news.slices.reserve(most);
  const std::lock_guard now(mutex_);
  if (slice >= newest_) return news;
  const auto count = std::min<std::uint64_t>({newest_ - slice, newest_, most});
  news.missed = newest_ - slice - count;
  for (auto number = newest_ - count + 1; number <= newest_; ++number)
    news.slices.push_back(ring_[number % kSlices]);
  for (const auto& known : sweeps_)
    if (known->number > sweep) news.sweeps.push_back(known);
  return news;
}

}  // namespace sweepd
