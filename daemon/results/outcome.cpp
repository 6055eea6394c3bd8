#include "daemon/results/outcome.hpp"

#include "rsi/counted.hpp"

namespace sweepd {

Outcome outcome_of(const Snapshot& snapshot) {
  const identify::Campaign& campaign = snapshot.campaign;
  Outcome outcome{snapshot.robot, snapshot.source_kind, snapshot.counts,
                  identify::identify(snapshot.sweeps, campaign)};
  if (campaign.specified) outcome.positive = campaign.specified->positive;
  outcome.limits = snapshot.limits;
  outcome.motion_limit = campaign.motion_limit;
  if (snapshot.sweeps_left_out > 0)
    outcome.identification.warnings.push_back(
        {"memory_limit",
         {},
         rsi::counted(snapshot.sweeps_left_out, "later sweep was", "later sweeps were") +
             " not used: end the stream (RSI off) "
             "between campaigns, so that each gets its own result"});
  return outcome;
}

}  // namespace sweepd
