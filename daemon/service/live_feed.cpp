#include "daemon/service/live_feed.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <utility>

#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

constexpr double kWatchedPoint_s = 0.025;
constexpr double kPoint_s = 0.1;
constexpr std::size_t kPath = 32;

/// Whether the next telegram's rise counts from this one.
bool leads(const rsi::Cycle& cycle) {
  return cycle.arrival == rsi::Arrival::in_order || cycle.arrival == rsi::Arrival::restart;
}

std::array<float, 3> place(const identify::Sample& sample) {
  const auto mm = sample.position_mm.cast<float>();
  return {mm.x(), mm.y(), mm.z()};
}

}  // namespace

void LiveFeed::begin_session(std::string started) {
  started_ = std::move(started);
  const auto number = slice_.number;
  slice_ = {};
  slice_.number = number;
  slice_.session = ++session_;
  sweeps_.clear();
  telegrams_ = 0;
  next_point_s_ = 0;
}

void LiveFeed::sample(const identify::Sample& sample) {
  if (sample.time_s < next_point_s_ || slice_.count == LiveSlice::kPoints) return;
  next_point_s_ = sample.time_s + (to_.watched() ? kWatchedPoint_s : kPoint_s);
  slice_.joints = sample.joints;
  auto& point = slice_.points[slice_.count++];
  point.t_s = sample.time_s;
  point.has_position = sample.has_position;
  point.position_mm = place(sample);
  for (std::size_t j = 0; j < sample.joints; ++j)
    point.angles_deg[j] = static_cast<float>(degrees(sample.angles_rad[j]));
}

void LiveFeed::sweep(const identify::Sweep& sweep, std::optional<std::size_t> joint, bool linear,
                     std::string words) {
  auto live = std::make_shared<LiveSweep>();
  live->number = ++sweep_number_;
  live->session = session_;
  live->started = started_;
  if (joint) live->joint = *joint + 1;
  live->start_s = sweep.first().time_s;
  live->end_s = sweep.last().time_s;
  live->range = degrees(sweep.range_rad);
  live->linear = linear;
  if (joint && *joint < sweep.first().joints)
    live->ends = {degrees(sweep.first().angles_rad[*joint]),
                  degrees(sweep.last().angles_rad[*joint])};
  live->direction = sweep.direction;
  live->usable = sweep.defect == identify::SweepDefect::none;
  live->words = std::move(words);
  const auto& samples = *sweep.samples;
  const std::size_t points = std::min(kPath, samples.size());
  for (std::size_t i = 0; i < points; ++i) {
    const auto& sample = samples[points > 1 ? i * (samples.size() - 1) / (points - 1) : 0];
    if (sample.has_position) live->path.push_back(place(sample));
  }
  if (sweeps_.size() < LiveSlices::kSweeps) sweeps_.push_back(std::move(live));
}

void LiveFeed::tick(const rsi::Link& link, bool expects_replies, double at_s) {
  take_cycles(link, expects_replies);
  LiveSlice slice = slice_;
  ++slice.number;
  slice.at_s = at_s;
  if (!to_.try_add(slice, sweeps_)) return;
  sweeps_.clear();
  slice_ = {};
  slice_.number = slice.number;
  slice_.session = slice.session;
}

void LiveFeed::take_cycles(const rsi::Link& link, bool expects_replies) {
  const auto all = link.last(telegrams_ + 1);  // with the one before them
  auto first = all.end() - static_cast<std::ptrdiff_t>(std::min(telegrams_, all.size()));
  auto end = all.end();
  const auto unit = link.statistics().unit();
  const auto cycle = link.statistics().cycle().value_or(std::chrono::nanoseconds(0));
  // The reply to the newest ones, or to one that supersedes them, may be on its way.
  while (first != end && expects_replies && !std::prev(end)->replied &&
         (end == all.end() || all.back().received - std::prev(end)->received < 2 * cycle))
    --end;
  telegrams_ = static_cast<std::size_t>(all.end() - end);
  std::vector<double> latencies;
  for (auto now = first; now != end; ++now) {
    if (!now->counts()) continue;
    ++slice_.cycles;
    if (now->replied) latencies.push_back(us(*now->replied - now->received));
    if (now->replied || expects_replies)
      switch (rsi::fate(all, static_cast<std::size_t>(now - all.begin()), cycle)) {
        case rsi::Fate::in_time:
          break;
        case rsi::Fate::late:
          ++slice_.late;
          break;
        case rsi::Fate::superseded:
          ++slice_.superseded;
          break;
        case rsi::Fate::unanswered:
          ++slice_.unanswered;
      }
    if (now->rise == 0 || now->arrival != rsi::Arrival::in_order) continue;
    const auto before = std::find_if(std::make_reverse_iterator(now), all.rend(), leads);
    if (before == all.rend()) continue;
    const auto pace = now->received - before->received;
    const auto off = pace - static_cast<std::int64_t>(now->rise) * unit;
    slice_.jitter_us = std::max(slice_.jitter_us, static_cast<float>(std::abs(us(off))));
  }
  if (latencies.empty()) return;
  const auto middle = latencies.begin() + static_cast<std::ptrdiff_t>(latencies.size() / 2);
  std::nth_element(latencies.begin(), middle, latencies.end());
  slice_.latency_us = static_cast<float>(*middle);
  const auto longest = *std::max_element(latencies.begin(), latencies.end());
  slice_.latency_max_us = std::max(slice_.latency_max_us, static_cast<float>(longest));
}

}  // namespace sweepd
