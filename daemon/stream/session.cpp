#include "daemon/stream/session.hpp"

#include <set>
#include <utility>

namespace sweepd {

Session::Session(const RobotSetup& setup, std::string source_kind, StreamSink& sink)
    : setup_(setup),
      source_kind_(std::move(source_kind)),
      sink_(sink),
      pipeline_(setup.joints, setup.signals, *this) {}

Snapshot Session::snapshot() const {
  auto known = campaign(setup_, pipeline_.resolution());
  known.motion_limit = pipeline_.motion_limit();
  return {setup_.name, source_kind_, pipeline_.counts(), std::move(known),
          sweeps_,     left_out_,    setup_.limits()};
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

void Session::sweep(const identify::Sweep& sweep) {
  sink_.sweep(sweep);
  if (kept_samples_ + sweep.samples->size() > kMostSamples) {
    ++left_out_;
    return;
  }
  kept_samples_ += sweep.samples->size();
  sweeps_.push_back(sweep);
}

}  // namespace sweepd
