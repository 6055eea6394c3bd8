#include "rsi/link/link_statistics.hpp"

#include <algorithm>
#include <bit>
#include <iterator>
#include <string_view>

#include "rsi/words.hpp"

namespace rsi {

using namespace std::chrono_literals;

std::chrono::nanoseconds ipoc_unit(std::span<std::chrono::nanoseconds> per_count) noexcept {
  constexpr std::chrono::nanoseconds kMillisecond = 1ms;
  constexpr std::chrono::nanoseconds kTolerance = 250us;
  if (per_count.empty()) return kMillisecond;
  const auto half = static_cast<std::ptrdiff_t>(per_count.size() / 2);
  // To count is enough to know that the median is near, and costs a tenth of looking for it.
  std::ptrdiff_t less = 0, more = 0;
  for (const auto time : per_count) {
    less += time < kMillisecond - kTolerance ? 1 : 0;
    more += time > kMillisecond + kTolerance ? 1 : 0;
  }
  if (less <= half && more < std::ssize(per_count) - half) return kMillisecond;
  const auto middle = per_count.begin() + half;
  std::nth_element(per_count.begin(), middle, per_count.end());
  if (*middle == std::chrono::nanoseconds(0)) return kMillisecond;
  return std::min<std::chrono::nanoseconds>(*middle, 1h);
}

namespace {

/// Whether `ipoc` was counted before `other`. By their difference, so that 0 follows the greatest
/// number.
bool older(std::uint64_t ipoc, std::uint64_t other) {
  return other - ipoc - 1 < std::uint64_t{1} << 63;
}

/// No controller sends sooner after its last telegram.
constexpr std::chrono::nanoseconds kFastest = 500us;

/// Whether the IPOC rose by more than its unit permits in this time. Its pace may be a quarter off.
bool is_ahead(std::uint64_t rise, std::chrono::nanoseconds unit, std::chrono::nanoseconds since) {
  return static_cast<std::int64_t>(rise) * unit / 4 * 3 > since;
}

/// Longer ones say no more, and their sums do not overflow.
std::chrono::nanoseconds clamped(std::chrono::nanoseconds time) {
  constexpr std::chrono::nanoseconds kLong = 1h;
  return std::clamp(time, -kLong, kLong);
}

/// A hash of all bytes. Four words at a time: std::hash waits for each one before the next, which
/// is a tenth of all the work on a telegram.
std::uint64_t hash_of(std::string_view content) {
  const auto add = [](std::uint64_t& sum, std::uint64_t word) {
    sum = std::rotl((sum ^ word) * 0x9e37'79b9'7f4a'7c15, 29);
  };
  std::array<std::uint64_t, 4> sums{1, 2, 3, content.size()};
  for (; content.size() >= 32; content.remove_prefix(32))
    for (std::size_t k = 0; k < sums.size(); ++k) add(sums[k], word_at(content.data() + 8 * k));
  for (; content.size() >= 8; content.remove_prefix(8)) add(sums[0], word_at(content.data()));
  add(sums[1], word_at(content.data(), content.size()));
  for (const std::uint64_t sum : {sums[1], sums[2], sums[3]}) add(sums[0], sum);
  return sums[0];
}

}  // namespace

Arrival LinkStatistics::add(const Datagram& datagram, std::uint64_t ipoc,
                            std::optional<std::uint64_t> delay) {
  Seen came{ipoc, {}, datagram.time};
  if (!datagram.cut) came.content = hash_of(datagram.payload);
  const Arrival arrival = run_.distinct == 0 ? Arrival::in_order : judge(came, datagram.source);
  if (arrival == Arrival::restart && datagram.cut && run_.whole > 0) return Arrival::stray;
  ++counts_.telegrams;
  if (delay && !counts_.late_replies) counts_.late_replies = 0;
  if (arrival == Arrival::duplicate) {
    ++counts_.duplicated;
    return arrival;
  }
  if (arrival == Arrival::completed) {
    complete(came);
    return arrival;
  }
  if (arrival == Arrival::reordered) ++counts_.reordered;
  if (arrival == Arrival::restart) {
    ++counts_.restarts;
    if (datagram.source != source_) {
      if (datagram.source == source_before_) {
        ++counts_.alternations;
        counts_.alternating = {datagram.source, source_};
      }
      source_before_ = source_;
    }
    counts_.lost += lost_in_run();
    run_ = {};
    delay_.reset();
  }
  if (run_.distinct == 0) {
    run_ = {.oldest = ipoc, .newest = ipoc};
    milestones_.fill({ipoc, datagram.time});
    lag_ = 0ns;
  } else if (arrival == Arrival::in_order) {
    learn_pace(ipoc - run_.newest, {ipoc, datagram.time});
  }
  source_ = datagram.source;
  same_machine_ = source_.address == datagram.destination.address || source_.address >> 24 == 127;
  recent_[run_.distinct++ % kRecent] = came;
  if (!datagram.cut) ++run_.whole;
  if (older(ipoc, run_.oldest)) run_.oldest = ipoc;
  if (older(run_.newest, ipoc)) run_.newest = ipoc;
  if (delay && arrival != Arrival::reordered) count_late(ipoc, *delay);
  return arrival;
}

LinkCounts LinkStatistics::counts() const {
  LinkCounts counts = counts_;
  counts.lost += lost_in_run();
  return counts;
}

std::chrono::nanoseconds LinkStatistics::unit() const {
  auto per_count = per_count_;
  const auto unit =
      ipoc_unit({per_count.data(),
                 static_cast<std::size_t>(std::min<std::uint64_t>(paces_, per_count.size()))});
  const auto step = static_cast<std::int64_t>(this->step().value_or(0));
  const auto span = static_cast<std::int64_t>(milestones_.size()) * step * unit;
  return has_times_ && step > 0 && 2 * tick_ > span ? 1ms : unit;
}

bool LinkStatistics::counts_ms() const {
  constexpr auto kUneven = 20ms;
  if (step() == 1 && (!has_times_ || paces_ < kTells)) return false;
  if (paces_ >= kTells) return unit_ == 1ms || hurries();
  const Milestone& before = milestones_[next_milestone_ % milestones_.size()];
  const auto since = clamped(newest().time - before.time);
  const auto telegrams =
      static_cast<std::int64_t>(std::min<std::uint64_t>(run_.distinct, milestones_.size() + 1)) - 1;
  return !has_times_ || since < telegrams * kFastest ||
         !is_ahead(newest().ipoc - before.ipoc, 1ms, since + kUneven);
}

bool LinkStatistics::hurries() const {
  return step() && static_cast<std::int64_t>(*step()) * unit_ < kFastest;
}

std::optional<std::chrono::nanoseconds> LinkStatistics::cycle() const {
  const auto step = this->step();
  if (!step || (*step == 1 && !has_times_)) return std::nullopt;
  return static_cast<std::int64_t>(*step) * unit();
}

std::optional<std::uint64_t> LinkStatistics::step_of_run() const {
  const auto step = this->step();
  if (!step || run_.votes == 0) return step;
  return run_.votes >= kTellsStep ? run_.rise : std::max(*step, run_.rise);
}

std::uint64_t LinkStatistics::lost_in_run() const {
  const auto step = step_of_run();
  if (!step || run_.distinct == 0) return 0;
  const std::uint64_t cycles = (run_.newest - run_.oldest) / *step + 1;
  return cycles > run_.distinct ? cycles - run_.distinct : 0;
}

Arrival LinkStatistics::judge(const Seen& came, const Endpoint& source) const {
  if (!older(run_.newest, came.ipoc))
    return source == source_ ? judge_fallen(came) : Arrival::restart;
  const std::uint64_t rise = came.ipoc - run_.newest;
  const bool other = source != source_ && rise != step();
  return rise > kLongestGap || other || ran_ahead(came) ? Arrival::restart : Arrival::in_order;
}

bool LinkStatistics::ran_ahead(const Seen& came) const {
  constexpr auto kUneven = 200ms;
  if (!has_times_ || paces_ < kTells || run_.distinct < kTells || hurries()) return false;
  const auto since = clamped(came.time - newest().time);
  // A clock that was set back tells nothing.
  return since >= 0ns && is_ahead(came.ipoc - run_.newest, unit_, since + lag_ + kUneven);
}

Arrival LinkStatistics::judge_fallen(const Seen& came) const {
  const std::uint64_t step = step_of_run().value_or(1);
  if (const Seen* before = seen(came.ipoc)) {
    if (!before->content && came.content) return Arrival::completed;
    const bool other = before->content && came.content && *before->content != *came.content;
    const bool long_ago = std::chrono::abs(came.time - before->time) > kCopyWithin;
    // An IPOC that only stands still has not begun anew.
    const bool fell = came.ipoc != run_.newest;
    return (fell ? other || long_ago : other && long_ago) ? Arrival::restart : Arrival::duplicate;
  }
  const std::uint64_t fall = run_.newest - came.ipoc;
  const bool sure = run_.in_step >= kSureOfStep && 2 * run_.in_step > run_.distinct;
  const bool in_step = !sure || fall % step == 0;
  const bool recent = fall / step < kRecent;
  const bool before_first =
      older(came.ipoc, run_.oldest) && (run_.oldest - came.ipoc) / step > kBeforeFirst;
  return in_step && recent && !before_first ? Arrival::reordered : Arrival::restart;
}

const LinkStatistics::Seen* LinkStatistics::seen(std::uint64_t ipoc) const {
  const auto end = recent_.begin() + static_cast<std::ptrdiff_t>(std::min(run_.distinct, kRecent));
  const auto found =
      std::find_if(recent_.begin(), end, [&](const Seen& seen) { return seen.ipoc == ipoc; });
  return found == end ? nullptr : &*found;
}

void LinkStatistics::complete(const Seen& came) {
  const auto place = std::find_if(recent_.begin(), recent_.end(), [&](const Seen& seen) {
    return seen.ipoc == came.ipoc && !seen.content;
  });
  if (place != recent_.end()) *place = came;
  ++run_.whole;
}

void LinkStatistics::learn_pace(std::uint64_t rise, const Milestone& now) {
  const auto since_newest = clamped(now.time - newest().time);
  if (since_newest > 0ns) tick_ = std::min(tick_, since_newest);
  lag_ = std::max(0ns, clamped(lag_ + since_newest - static_cast<std::int64_t>(rise) * unit_));
  Milestone& before = milestones_[next_milestone_++ % milestones_.size()];
  const auto since = now.time - before.time;
  has_times_ = has_times_ || since != std::chrono::nanoseconds(0);
  if (since >= std::chrono::nanoseconds(0)) {
    per_count_[paces_++ % kPaces] = since / static_cast<std::int64_t>(now.ipoc - before.ipoc);
    if (paces_ == kTells || paces_ % kRecent == 0) unit_ = unit();
  }
  before = now;
  if (rise > kLargestStep) return;
  const std::uint64_t lead = steps_[usual_step_];
  if (++steps_[rise] > lead || (steps_[rise] == lead && rise < usual_step_)) usual_step_ = rise;
  if (run_.votes == 0) run_.rise = rise;
  rise == run_.rise ? ++run_.votes : --run_.votes;
  if (rise == step_of_run()) ++run_.in_step;
}

void LinkStatistics::count_late(std::uint64_t ipoc, std::uint64_t delay) {
  // Delay counts a run of late replies, and is 0 behind it: where a cycle with 0 fits in between, a
  // new run has begun. Else what it rose by is new: also where it counts all since RSI began, or
  // missed replies and not cycles.
  if (!delay_) {
    counts_.missed_before += delay;
    delay_before_ = delay;
  } else {
    const std::uint64_t cycles =
        std::max<std::uint64_t>(1, (ipoc - delay_ipoc_) / step_of_run().value_or(1));
    const bool goes_on = delay >= *delay_ && delay >= cycles;
    if (!goes_on || delay == *delay_) delay_before_ = goes_on ? delay : 0;
    const std::uint64_t counted = goes_on ? *delay_ : 0;
    *counts_.late_replies += delay - counted;
    if (delay > counted && counted == delay_before_) ++counts_.late_runs;
    counts_.longest_late_run = std::max(counts_.longest_late_run, delay - delay_before_);
  }
  delay_ = delay;
  delay_ipoc_ = ipoc;
}

}  // namespace rsi
