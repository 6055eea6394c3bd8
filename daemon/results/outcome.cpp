#include "daemon/results/outcome.hpp"

#include <string>

#include "rsi/counted.hpp"

namespace sweepd {
namespace {

std::string text(const KeptSweeps::LeftOut& left_out, std::size_t kept) {
  std::string text = std::to_string(kept) + " of " +
                     rsi::counted(kept + left_out.sweeps, "sweep was", "sweeps were") +
                     " used, spread over the whole stream";
  if (left_out.sample_stride > 1)
    text += ", with one of " + std::to_string(left_out.sample_stride) + " samples";
  if (left_out.kinds)
    text += "; that is none of some kinds (joint, way, home), of which there are too many";
  return text +
         ": memory holds no more; end the stream (RSI off) between campaigns, so that each gets "
         "its own result of all its sweeps";
}

}  // namespace

Outcome outcome_of(const Snapshot& snapshot) {
  const identify::Campaign& campaign = snapshot.campaign;
  Outcome outcome{snapshot.robot, snapshot.source_kind, snapshot.counts,
                  identify::identify(snapshot.sweeps, campaign, snapshot.poses)};
  if (campaign.specified) outcome.positive = campaign.specified->positive;
  outcome.limits = snapshot.limits;
  outcome.currents = snapshot.currents;
  outcome.angle_step_rad = campaign.resolution.angle_rad;
  outcome.motion_limit = campaign.motion_limit;
  if (snapshot.left_out.sweeps > 0 || snapshot.left_out.sample_stride > 1)
    outcome.identification.warnings.push_back(
        {"memory_limit", {}, text(snapshot.left_out, snapshot.sweeps.size())});
  return outcome;
}

}  // namespace sweepd
