#include "identify/identification.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "identify/advice.hpp"
#include "identify/chain/chain_estimator.hpp"
#include "identify/chain/chain_start.hpp"
#include "identify/chain/chain_table.hpp"
#include "identify/chain/delay.hpp"
#include "identify/circle/circle_estimator.hpp"
#include "identify/dh/placed_axes.hpp"
#include "identify/dh_budget.hpp"
#include "identify/plausibility.hpp"
#include "identify/undetermined.hpp"

namespace identify {
namespace {

/// Counted from 1, as a list.
std::string without_axis(const Identification& found) {
  std::string missing;
  for (std::size_t j = 0; j < found.joints.size(); ++j)
    if (!found.joints[j].axis) missing += (missing.empty() ? "" : ", ") + std::to_string(j + 1);
  return missing;
}

/// What the circles tell by themselves.
Identification by_circles(CircleEstimate circles) {
  Identification found;
  static_cast<CircleEstimate&>(found) = std::move(circles);
  found.dh = found.circle_dh;
  const std::string missing = without_axis(found);
  if (found.no_positions) {
    // Strokes that angles alone tell are something: partial, not failed.
    found.status = Status::partial;
    found.reason =
        "the data carry no positions: on a KUKA controller, add DEF_RIst to the SEND list of the "
        "Ethernet file";
    found.warnings.push_back({"no_positions", {}, found.reason});
  } else if (missing.empty()) {
    found.status = Status::complete;
  } else {
    const bool any = std::any_of(found.joints.begin(), found.joints.end(),
                                 [](const JointResult& joint) { return joint.axis.has_value(); });
    found.status = any ? Status::partial : Status::failed;
    found.reason =
        found.any_sweep ? "no axis for joint " + missing : "no sweep of a single joint was seen";
  }
  return found;
}

Identification estimate(std::vector<Sweep> sweeps, const Campaign& campaign) {
  Identification found = by_circles(estimate_circles(std::move(sweeps), campaign));
  if (campaign.timed) {
    const auto axes = starting_axes(found);
    found.delay = find_delay(found, axes);
    if (found.delay && is_significant(*found.delay))
      found.chain = estimate_chain(in_step(found, axes, *found.delay), campaign);
  }
  if (!found.chain) found.chain = estimate_chain(found, campaign);
  if (!found.chain) return found;
  const std::size_t joints = found.joints.size();
  place_linear_axes(*found.chain, campaign, found.specified);
  const TableAxes axes = table_axes(*found.chain, campaign);
  found.chain->dh = table_of(axes, joints, found.specified);
  if (!found.chain->summary.converged) return found;
  found.estimator = Estimator::chain;
  found.dh = found.chain->dh;
  found.row_to_tool = row_to_tool(axes, joints, found.specified);
  if (campaign.device_frame) {
    found.robot_pose = robot_pose(axes, found.specified);
    leave_first_to_frame(found.dh, found.specified);
  }
  set_budget(found, axes);
  found.tool = tool_pose(*found.chain, axes, found.chain->dh, found.specified);
  for (std::size_t j = 0; j < joints; ++j) found.joints[j].axis = found.chain->axes[j];
  const std::string missing = without_axis(found);
  if (found.status != Status::failed || missing.empty())
    found.status = missing.empty() ? Status::complete : Status::partial;
  found.reason = missing.empty() ? "" : "no axis for joint " + missing;
  return found;
}

}  // namespace

Identification identify(std::vector<Sweep> sweeps, const Campaign& campaign) {
  Identification found = estimate(std::move(sweeps), campaign);
  name_undetermined(found);
  if (found.status == Status::complete && !found.doubt.empty()) {
    found.status = Status::partial;
    found.reason = found.doubt;
  }
  judge_plausibility(found, campaign);
  apply_doubts(found);
  add_advice(found, campaign);
  return found;
}

void apply_doubts(Identification& found) {
  if (found.doubts.empty() || found.status == Status::failed) return;
  found.status = Status::doubtful;
  found.reason = found.doubts.front().message + (found.reason.empty() ? "" : "; " + found.reason);
}

std::string_view text(Status status) noexcept {
  switch (status) {
    case Status::complete:
      return "complete";
    case Status::doubtful:
      return "doubtful";
    case Status::partial:
      return "partial";
    case Status::failed:
      return "failed";
  }
  return "";
}

std::string_view text(Estimator estimator) noexcept {
  switch (estimator) {
    case Estimator::circle:
      return "circle";
    case Estimator::chain:
      return "chain";
    case Estimator::axes:
      return "axes";
  }
  return "";
}

}  // namespace identify
