#include "daemon/service/robot_tally.hpp"

#include <utility>

namespace sweepd {
namespace {

LinkVerdict verdict_on(const rsi::LinkReport& report) {
  const rsi::Verdict verdict = rsi::verdict(report);
  return {verdict.grade, std::string(verdict.worst())};
}

}  // namespace

void RobotTally::begin_session(StreamState stream, std::shared_ptr<const Recording> recording) {
  ++state_.sessions;
  state_.stream = std::move(stream);
  recordings_.push_back(std::move(recording));
}

void RobotTally::sweep(const identify::Sweep& sweep, std::string words) {
  state_.last_sweep = std::move(words);
  SweepCounts& counts = state_.sweeps[sweep.joint ? *sweep.joint + 1 : 0];
  ++(sweep.defect == identify::SweepDefect::none ? counts.usable : counts.not_usable);
}

void RobotTally::end_session(const rsi::LinkReport& report) {
  ended_.add(report);
  state_.verdict = verdict_on(report);
  state_.stream.reset();
}

const RobotState& RobotTally::state(const rsi::Server::Counts& server, bool recording_paused,
                                    const std::optional<rsi::Link::Reports>& under_way) {
  state_.server = server;
  state_.recording_paused = recording_paused;
  LinkTotals link = ended_;
  if (under_way && state_.stream) {
    link.add(under_way->settled);
    const rsi::LinkReport& now = under_way->now;
    state_.verdict = verdict_on(now);
    state_.stream->cycle = now.cycle;
    state_.stream->latency_p50 = now.latency.quantile(0.5);
    state_.stream->latency_p99 = now.latency.quantile(0.99);
    state_.stream->latency_max = now.latency.max();
  }
  link.never_less(state_.link);
  state_.link = std::move(link);
  add_recordings();
  return state_;
}

void RobotTally::add_recordings() {
  std::erase_if(recordings_, [&](const auto& recording) {
    const bool finished = recording->finished();  // before it is read
    if (finished) recorded_ += recording->counts();
    return finished;
  });
  state_.recording = recorded_;
  for (const auto& recording : recordings_) state_.recording += recording->counts();
}

}  // namespace sweepd
