#include "daemon/stream/pipeline.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <utility>

#include "daemon/text/numbers.hpp"

namespace sweepd {
namespace {

constexpr std::size_t kHeldBack = 4;

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
      segmenter_(std::min(joints, signals.angles.size()), kLongestStroke) {}

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

  Waiting waiting{reader_.read(telegram_), std::move(spare_row_), reader_.currents()};
  waiting.sample.time_s =
      clock_.seconds(telegram_.ipoc(), datagram.time, link_.statistics().step(), restarted);
  start_row(waiting.row, waiting.sample.time_s, telegram_.ipoc());
  reader_.append_csv(waiting.row);
  hold(std::move(waiting));
  release(kHeldBack);
  return true;
}

void Pipeline::finish() {
  release(0);
  report(segmenter_.finish());
}

SourceCounts Pipeline::counts() const {
  return {link_.statistics().counts(), malformed_, reader_.unusable(), link_.statistics().cycle()};
}

void Pipeline::hold(Waiting waiting) {
  auto place = waiting_.end();
  while (place != waiting_.begin() && std::prev(place)->sample.time_s > waiting.sample.time_s)
    --place;
  waiting_.insert(place, std::move(waiting));
}

void Pipeline::release(std::size_t keep) {
  for (; waiting_.size() > keep; waiting_.pop_front()) {
    Waiting& next = waiting_.front();
    if (next.currents) sink_.currents(next.sample, *next.currents);
    sink_.sample(next.sample, next.row);
    segmenter_.set_resolution(reader_.resolution());
    report(segmenter_.push(next.sample));
    spare_row_ = std::move(next.row);
  }
}

void Pipeline::report(const std::vector<identify::Sweep>& sweeps) const {
  for (const auto& sweep : sweeps) sink_.sweep(sweep);
}

}  // namespace sweepd
