#include "daemon/stream/pipeline.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <utility>

#include "daemon/text/numbers.hpp"

namespace sweepd {
namespace {

/// A longer stroke is ended and goes on as another: two minutes of motion at 4 ms, 5 MB.
constexpr std::size_t kLongestStroke = 32'768;

void start_row(std::string& row, double time_s, std::uint64_t ipoc) {
  // Milliseconds are what IPOC counts; microseconds are more than a reception deserves.
  row.clear();
  append_fixed(row, time_s, 3);
  row += ',';
  std::array<char, 20> digits{};
  row.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), ipoc).ptr);
}

}  // namespace

std::uint64_t SourceCounts::malformed_in_all() const {
  return std::accumulate(malformed.begin(), malformed.end(), std::uint64_t{0});
}

Pipeline::Pipeline(std::size_t joints, const SignalNames& signals, StreamSink& sink,
                   bool with_currents)
    : sink_(sink),
      reader_(signals, joints, with_currents),
      segmenter_(std::min(joints, signals.angles.size()), kLongestStroke) {
  std::iota(order_.begin(), order_.end(), std::uint8_t{0});
}

void Pipeline::use_two_threads(SampleRelay::Beside beside) {
  relay_ = std::make_unique<SampleRelay>([this](const SeenSample& next) { work_on(next); },
                                         std::move(beside));
}

bool Pipeline::telegram(const rsi::Datagram& datagram) {
  auto defect = telegram_.parse(datagram.payload);
  if (datagram.cut && defect == rsi::Defect::none) defect = rsi::Defect::truncated;
  const auto arrival = link_.telegram(datagram, telegram_, defect);
  if (defect != rsi::Defect::none) {
    ++malformed_[static_cast<std::size_t>(defect)];
    return false;
  }
  if (arrival == rsi::Arrival::duplicate) return true;
  const bool restarted = arrival == rsi::Arrival::restart;
  if (restarted) finish();

  Waiting& waiting = places_[order_[waiting_]];
  waiting.seen.sample = reader_.read(telegram_);
  waiting.seen.currents = reader_.currents();
  waiting.ipoc = telegram_.ipoc();
  waiting.seen.sample.time_s =
      clock_.seconds(waiting.ipoc, datagram.time, link_.statistics().counts_ms(), restarted);
  hold();
  start_row(waiting.row, waiting.seen.sample.time_s, waiting.ipoc);
  reader_.append_csv(waiting.row);
  release(kHeldBack);
  return true;
}

void Pipeline::finish() {
  release(0);
  if (relay_) relay_->drain();
  report(segmenter_.finish());
}

SourceCounts Pipeline::counts() const {
  return {link_.statistics().counts(), malformed_, reader_.unusable(), link_.statistics().cycle()};
}

/// The first of the free places is taken.
void Pipeline::hold() {
  // All are of one run of RSI; their IPOC may pass over its greatest number.
  const auto is_later = [&](std::size_t before) {
    return static_cast<std::int64_t>(places_[order_[before]].ipoc -
                                     places_[order_[before + 1]].ipoc) > 0;
  };
  std::size_t at = waiting_++;
  for (; at > 0 && is_later(at - 1); --at) std::swap(order_[at - 1], order_[at]);
  if (at > 0 && at + 1 < waiting_) put_in_time(at);
}

/// Where the time is that of reception, one that was overtaken may be early or late by its pace.
void Pipeline::put_in_time(std::size_t at) {
  const Waiting& before = places_[order_[at - 1]];
  const Waiting& after = places_[order_[at + 1]];
  Waiting& between = places_[order_[at]];
  const double begin_s = before.seen.sample.time_s, end_s = after.seen.sample.time_s;
  double& time_s = between.seen.sample.time_s;
  if (time_s > begin_s && time_s < end_s) return;
  const auto share = static_cast<double>(between.ipoc - before.ipoc) /
                     static_cast<double>(after.ipoc - before.ipoc);
  time_s = begin_s + share * (end_s - begin_s);
}

void Pipeline::release(std::size_t keep) {
  while (waiting_ > keep) {
    SeenSample& next = places_[order_.front()].seen;
    next.row = places_[order_.front()].row;
    next.resolution = reader_.resolution();
    if (relay_)
      relay_->pass(next);
    else
      work_on(next);
    std::rotate(order_.begin(), order_.begin() + 1,
                order_.begin() + static_cast<std::ptrdiff_t>(waiting_--));
  }
}

void Pipeline::work_on(const SeenSample& next) {
  if (next.currents) sink_.currents(next.sample, *next.currents);
  sink_.sample(next.sample, next.row);
  segmenter_.set_resolution(next.resolution);
  report(segmenter_.push(next.sample));
}

void Pipeline::report(const std::vector<identify::Sweep>& sweeps) const {
  for (const auto& sweep : sweeps) sink_.sweep(sweep);
}

}  // namespace sweepd
