#include "daemon/session.hpp"

#include <set>
#include <utility>

namespace sweepd {

Outcome Snapshot::identified() const {
  Outcome outcome{robot, source_kind, counts, identify::identify(sweeps, campaign)};
  if (campaign.specified) outcome.positive = campaign.specified->positive;
  outcome.limits = limits;
  if (sweeps_left_out > 0)
    outcome.identification.warnings.push_back(
        {"memory_limit",
         {},
         std::to_string(sweeps_left_out) + " later sweeps were not used: end the stream (RSI off) "
                                           "between campaigns, so that each gets its own result"});
  return outcome;
}

Session::Session(const RobotSetup& setup, Options options, Events events)
    : setup_(setup),
      options_(std::move(options)),
      events_(std::move(events)),
      pipeline_(setup.joints, setup.signals,
                {[this](const identify::Sample&, std::string_view row) {
                   if (samples_) samples_->append(row);
                 },
                 [this](const identify::Sweep& sweep) { keep(sweep); }}) {
  if (options_.folder.empty()) return;
  samples_.emplace(options_.folder / "samples.csv");
  samples_->append(pipeline_.csv_header());
  if (options_.record) trace_.emplace(options_.folder / "trace.pcap");
}

void Session::telegram(const rsi::Datagram& datagram) {
  record(datagram);
  pipeline_.telegram(datagram);
}

void Session::reply(const rsi::Datagram& datagram) {
  record(datagram);
}

void Session::flush() {
  if (samples_) samples_->flush();
  if (trace_) trace_->flush();
  complain_once();
}

void Session::finish() {
  pipeline_.finish();
  flush();
}

Snapshot Session::snapshot() const {
  return {setup_.name,
          options_.source_kind,
          pipeline_.counts(),
          campaign(setup_, pipeline_.resolution()),
          sweeps_,
          left_out_,
          setup_.description ? setup_.description->limits : std::vector<JointLimits>{}};
}

bool Session::worth_identifying() const {
  std::set<std::size_t> joints;
  std::size_t without_joint = 0;
  for (const auto& sweep : sweeps_) {
    if (sweep.defect != identify::SweepDefect::none) continue;
    if (sweep.joint)
      joints.insert(*sweep.joint);
    else
      ++without_joint;
  }
  return joints.size() >= setup_.joints || without_joint >= setup_.joints;
}

void Session::keep(const identify::Sweep& sweep) {
  if (events_.on_sweep) events_.on_sweep(sweep);
  if (kept_samples_ + sweep.samples->size() > kMostSamples) {
    ++left_out_;
    return;
  }
  kept_samples_ += sweep.samples->size();
  sweeps_.push_back(sweep);
}

void Session::record(const rsi::Datagram& datagram) {
  if (trace_) trace_->write(datagram);
}

void Session::complain_once() {
  if (!events_.on_trouble) return;
  if (samples_ && !samples_failed_ && !samples_->error().empty()) {
    samples_failed_ = true;
    events_.on_trouble(samples_->error());
  }
  if (trace_ && !trace_failed_ && !trace_->error().empty()) {
    trace_failed_ = true;
    events_.on_trouble(trace_->error());
  }
}

}  // namespace sweepd
