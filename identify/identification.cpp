#include "identify/identification.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "identify/advice.hpp"
#include "identify/chain/chain_estimator.hpp"
#include "identify/chain/chain_start.hpp"
#include "identify/chain/chain_table.hpp"
#include "identify/chain/delay.hpp"
#include "identify/circle/circle_estimator.hpp"
#include "identify/dh/base_height.hpp"
#include "identify/dh/placed_axes.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/plausibility.hpp"
#include "identify/poses/finite_input.hpp"
#include "identify/poses/pose_doubts.hpp"
#include "identify/poses/pose_sag.hpp"
#include "identify/poses/target_exchange.hpp"
#include "identify/target_distances.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Sets `dh_covariance` and `dh_budget` of a result whose `dh` is the chain's, from the axes of
// that table.
void set_budget(Identification& found, const TableAxes& axes) {
  const std::size_t joints = found.dh.size();
  const auto count = static_cast<Index>(6 * joints);
  const std::vector<std::optional<Axis>> of_joints(
      axes.z.begin(), axes.z.begin() + static_cast<std::ptrdiff_t>(joints));
  MatrixXd jacobian = dh_jacobian(of_joints, axes.size_mm, found.specified);
  for (std::size_t i = 0; i < joints; ++i) {
    const auto numbers = numbers_of(found.dh[i]);
    for (std::size_t k = 0; k < numbers.size(); ++k)
      if (numbers[k]->knowledge != Knowledge::identified)
        jacobian.row(static_cast<Index>(5 * i + k)).setZero();
  }
  jacobian *= axes.by_estimate.topRows(count);
  const auto of_numbers = [&](const MatrixXd& covariance) -> MatrixXd {
    return jacobian * covariance * jacobian.transpose();
  };
  found.dh_covariance = of_numbers(found.chain->covariance);
  found.dh_budget.clear();
  for (const ChainEstimate::Part& part : found.chain->parts)
    found.dh_budget.push_back({part.cause, of_numbers(part.covariance).diagonal()});
}

/// A number that nothing tells from another one, by which way a joint turns, is not identified.
void leave_to_sense(Identification& found) {
  for (const OtherNumber& other : found.by_sense) {
    const auto leave = [&](std::vector<DhEstimate>& table) {
      DhNumber& number = table[other.row].*kDhNumbers[other.number].number;
      const bool differs =
          number.knowledge == Knowledge::identified &&
          std::any_of(other.differences.begin(), other.differences.end(),
                      [&](double difference) { return std::abs(difference) > number.sigma; });
      if (differs) number = {};
      return differs;
    };
    leave(found.circle_dh);
    if (found.chain && !found.chain->dh.empty()) leave(found.chain->dh);
    if (!leave(found.dh) || found.dh_covariance.size() == 0) continue;
    const auto at = static_cast<Index>(kDhNumbers.size() * other.row + other.number);
    found.dh_covariance.row(at).setZero();
    found.dh_covariance.col(at).setZero();
    for (Identification::Share& share : found.dh_budget) share.variances[at] = 0;
  }
}

/// As a reason; empty: all joints have theirs.
std::string axes_missing(const Identification& found) {
  std::vector<std::size_t> missing;
  for (std::size_t j = 0; j < found.joints.size(); ++j)
    if (!found.joints[j].axis) missing.push_back(j);
  return missing.empty() ? "" : "no axis for " + joints_named(missing);
}

/// What the circles tell by themselves.
Identification by_circles(CircleEstimate circles) {
  Identification found;
  static_cast<CircleEstimate&>(found) = std::move(circles);
  found.dh = found.circle_dh;
  const std::string missing = axes_missing(found);
  if (found.no_positions) {
    // Strokes that angles alone tell are something: partial, not failed.
    found.status = Status::partial;
    found.reason = "the data carry no positions";
    found.warnings.push_back({"no_positions", {}, found.reason});
  } else if (missing.empty()) {
    found.status = Status::complete;
  } else {
    const bool any = std::any_of(found.joints.begin(), found.joints.end(),
                                 [](const JointResult& joint) { return joint.axis.has_value(); });
    found.status = any ? Status::partial : Status::failed;
    found.reason = found.any_sweep ? missing : "no sweep of a single joint was seen";
  }
  return found;
}

/// Of the circles' table, what depends on where the base stands.
void leave_to_device(Identification& found, const Campaign& campaign) {
  std::vector<std::optional<Axis>> z;
  for (const JointResult& joint : found.joints) {
    const bool turned = campaign.specified && campaign.specified->positive[z.size()] < 0;
    z.push_back(joint.axis && turned ? joint.axis->reversed() : joint.axis);
  }
  const double size_mm = size_by_circles_mm(found);
  z = seen_from_base(std::move(z), size_mm, found.specified);
  found.dh = placed_table(z, found.specified, size_mm);
  leave_first_to_frame(found.dh, found.specified);
  leave_to_height(found.dh, z, size_mm, found.specified);
}

/// Sets what follows from `found.chain`, which has converged.
void take_chain(Identification& found, const Campaign& campaign, Estimator estimator) {
  const std::size_t joints = found.joints.size();
  TableAxes axes = table_axes(*found.chain, campaign);
  found.estimator = estimator;
  found.chain->dh = table_of(axes, joints, found.specified);
  if (campaign.device_frame) axes = at_base(axes, joints, found.specified);
  found.dh = table_of(axes, joints, found.specified);
  found.row_to_tool = row_to_tool(axes, joints, found.specified, campaign.device_frame);
  found.tool = tool_pose(*found.chain, axes, found.dh, found.specified);
  if (campaign.device_frame) {
    found.robot_pose = robot_pose(axes, found.specified);
    leave_first_to_frame(found.dh, found.specified);
  }
  // What hangs on the height keeps its variance: results of one arm are compared at one height.
  set_budget(found, axes);
  if (campaign.device_frame)
    leave_to_height(found.dh, {axes.z.begin(), axes.z.begin() + static_cast<Index>(joints)},
                    axes.size_mm, found.specified);
  for (std::size_t j = 0; j < joints; ++j) found.joints[j].axis = found.chain->axes[j];
  const std::string missing = axes_missing(found);
  if (found.status != Status::failed || missing.empty())
    found.status = missing.empty() ? Status::complete : Status::partial;
  found.reason = missing;
}

Identification estimate(std::vector<Sweep> sweeps, const Campaign& campaign) {
  Identification found = by_circles(estimate_circles(std::move(sweeps), campaign));
  if (campaign.device_frame && !found.dh.empty()) leave_to_device(found, campaign);
  const auto axes = starting_axes(found);
  if (campaign.timed) found.delay = find_delay(found, axes, campaign);
  // One joint of several has no row yet, and nothing to tell what errs in its strokes from what
  // errs between them.
  const auto known =
      std::count_if(axes.begin(), axes.end(), [](const auto& axis) { return axis.has_value(); });
  if (campaign.joints > 1 && known < 2) return found;
  const double late_s = found.delay ? untold_delay_s(*found.delay) : 0;
  if (found.delay && is_significant(*found.delay)) {
    const CircleEstimate& circles = found;
    const CircleEstimate punctual = in_step(circles, axes, *found.delay);
    found.chain = estimate_chain(punctual, starting_axes(punctual), campaign, late_s);
    for (std::size_t j = 0; found.chain && j < found.joints.size(); ++j)
      if (double& sigma_rad = found.chain->angles[j].backlash_sigma_rad; sigma_rad > 0)
        sigma_rad = std::hypot(sigma_rad, play_by_delay_rad(found.joints[j], *found.delay,
                                                            found.chain->noise.position_mm,
                                                            campaign.resolution.time_s));
  }
  if (!found.chain) found.chain = estimate_chain(found, axes, campaign, late_s);
  if (!found.chain) return found;
  place_linear_axes(*found.chain, campaign, found.specified);
  if (found.chain->summary.converged) {
    if (campaign.device_frame && !found.dh.empty()) found.circle_dh = found.dh;  // from one base
    take_chain(found, campaign, Estimator::chain);
  } else {
    found.chain->dh =
        table_of(table_axes(*found.chain, campaign), found.joints.size(), found.specified);
  }
  for (std::size_t j = 0; j < found.joints.size(); ++j)
    if (const JointResult& joint = found.joints[j]; joint.axis && joint.circle)
      found.chain->angles[j].center_sigma_rad =
          joint.axis->point_sigma_mm() / joint.circle->radius_mm;
  return found;
}

/// Where targets stood, had the device not drifted as beside them the sweeps of one take show.
std::vector<Pose> without_drift(std::vector<Pose> poses, const std::vector<Sweep>& sweeps,
                                const ChainEstimate::SteadyDrift& drift) {
  if (!(drift.seconds > 0)) return poses;
  double begin_s = sweeps.front().first().time_s;
  for (const Sweep& sweep : sweeps) begin_s = std::min(begin_s, sweep.first().time_s);
  for (Pose& pose : poses)
    pose.sample.position_mm -= ((pose.sample.time_s - begin_s) / drift.seconds - 0.5) * drift.mm;
  return poses;
}

/// Why sweeps tell nothing beside poses.
std::string no_use_of_sweeps(const Identification& found) {
  std::vector<std::size_t> unknown;
  for (std::size_t j = 0; j < found.home_rad.size(); ++j)
    if (!found.home_rad[j]) unknown.push_back(j);
  if (!found.chain) return "no chain of axes was found in them";
  if (!unknown.empty())
    return "nothing tells the controller's angle at home of " + joints_named(unknown) +
           "; give angles with the sweeps, or the plan with its home";
  return "the fit of them did not come to its end (" + std::string(found.chain->summary.ending) +
         ")";
}

/// With the poses in place of the chain's estimate, or beside it.
void take_poses(Identification& found, const std::vector<Pose>& poses, const Campaign& campaign) {
  std::string reason;
  const std::string no_use = no_use_of_sweeps(found);
  found.poses = estimate_poses(poses, campaign, found.chain ? &*found.chain : nullptr,
                               found.home_rad, reason);
  if (!found.poses) {
    found.warnings.push_back({"poses_not_used", {}, reason});
    if (found.status == Status::failed) found.reason = reason;
    return;
  }
  if (found.any_sweep && !found.poses->with_sweeps)
    found.warnings.push_back({"sweeps_not_used",
                              {},
                              "the numbers are by the poses alone, not by the sweeps: " + no_use});
  const PoseModel& model = found.poses->fit.model;
  for (std::size_t j = 0; j < model.home_rad.size(); ++j) {
    found.home_rad[j] = model.home_rad[j];
    if (campaign.specified)
      found.specified[j] = specified_row(*campaign.specified, j, model.home_rad[j]);
  }
  found.doubt.clear();  // what a sweep alone left open, angles tell
  found.by_sense.clear();
  const std::optional<ChainEstimate> sweeps = std::move(found.chain);
  found.chain = found.poses->chain;
  if (sweeps)
    static_cast<SweepEvidence&>(*found.chain) = static_cast<const SweepEvidence&>(*sweeps);
  place_linear_axes(*found.chain, campaign, found.specified);
  if (found.poses->fit.converged) {
    if (found.status == Status::failed) found.status = Status::partial;
    take_chain(found, campaign, Estimator::poses);
  } else {
    found.status = Status::failed;
    found.reason =
        "the fit of the poses did not come to its end: check that angles and positions "
        "belong together";
  }
  std::erase_if(found.warnings, [](const Warning& warning) {  // the poses moved them
    return warning.code == "joint_never_moved";
  });
  if (auto exchanged =
          exchanged_targets(*found.poses, poses, campaign, sweeps ? &*sweeps : nullptr)) {
    found.doubts.push_back(*std::move(exchanged));
    return;
  }
  for (auto& doubt : doubts_of(*found.poses, poses, campaign))
    found.doubts.push_back(std::move(doubt));
  for (auto& advice : advice_on(*found.poses, poses)) found.warnings.push_back(std::move(advice));
}

/// Of sweeps from one home nothing tells how far joints gave way, and they are believed far too
/// much beside poses, which do. Sweeps of joints that may give way say little against that.
Identification with_poses(const std::vector<Sweep>& sweeps, const std::vector<Pose>& poses,
                          const Campaign& campaign) {
  const auto with_sag = [&](const std::vector<double>& sag_rad) {
    Campaign elastic = campaign;
    elastic.sag_rad = sag_rad;
    Identification found = estimate(sweeps, elastic);
    const bool drifts = campaign.two_clocks && found.chain && found.chain->steady_drift;
    take_poses(found, drifts ? without_drift(poses, sweeps, *found.chain->steady_drift) : poses,
               campaign);
    return found;
  };
  const auto uses_sweeps = [](const Identification& found) {
    return found.poses && found.poses->with_sweeps;
  };
  if (sweeps.empty()) return with_sag(campaign.sag_rad);
  std::vector<double> granted_rad = campaign.sag_rad;
  granted_rad.resize(campaign.joints);
  std::vector<double> loose_rad = granted_rad;
  for (double& sag_rad : loose_rad) sag_rad = std::max(sag_rad, kMayGive_rad);
  Identification found = with_sag(loose_rad);
  if (!uses_sweeps(found)) return with_sag(campaign.sag_rad);
  constexpr int kMostRounds = 3;
  for (int round = 0; round < kMostRounds && uses_sweeps(found); ++round) {
    if (!grant_sag(*found.poses, granted_rad) && round > 0) break;
    found = with_sag(granted_rad);
  }
  return found;
}

/// Where the specified table had to tell which way about its axis a joint's angle rises, its
/// strokes went the other way, too.
void follow_axis(JointResult& joint) {
  if (!joint.axis || joint.sense_by == SenseBy::angles || !(joint.circle || joint.line)) return;
  const auto& taken = joint.circle ? joint.circle->normal : joint.line->direction;
  if (joint.axis->direction.dot(taken) > 0) return;
  for (Sweep& sweep : joint.sweeps) sweep.direction = -sweep.direction;
}

}  // namespace

Identification identify(std::vector<Sweep> sweeps, const Campaign& campaign,
                        std::vector<Pose> poses) {
  std::vector<Warning> of_input;
  leave_out_not_finite(sweeps, poses, of_input);
  poses = without_copies(std::move(poses), of_input);
  Identification found =
      poses.empty() ? estimate(std::move(sweeps), campaign) : with_poses(sweeps, poses, campaign);
  found.warnings.insert(found.warnings.end(), of_input.begin(), of_input.end());
  name_undetermined(found);
  leave_to_sense(found);
  for (JointResult& joint : found.joints) follow_axis(joint);
  if (found.status != Status::failed && !found.doubt.empty()) {
    found.status = Status::partial;
    found.reason += (found.reason.empty() ? "" : "; ") + found.doubt;
  }
  if (campaign.timed)
    if (auto moved = changed_distances(found)) found.doubts.push_back(*std::move(moved));
  judge_plausibility(found, campaign);
  apply_doubts(found);
  add_advice(found, campaign);
  leave_out_consequences(found);
  return found;
}

}  // namespace identify
