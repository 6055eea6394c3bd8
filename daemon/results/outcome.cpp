#include "daemon/results/outcome.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "daemon/stream/device_take.hpp"
#include "daemon/text/numbers.hpp"
#include "identify/clock/joined_take.hpp"
#include "rsi/counted.hpp"
#include "rsi/link/link_verdict.hpp"

namespace sweepd {
namespace {

/// What a stream has that there was no memory for. `summed`: sweeps that count all the same.
std::string text(const KeptSweeps::LeftOut& left_out, std::size_t kept, std::size_t summed) {
  std::string text = std::to_string(kept) + " of " +
                     rsi::counted(kept + left_out.sweeps, "sweep is", "sweeps are") +
                     " kept, spread over the whole stream";
  if (left_out.sample_stride > 1)
    text += ", with one of " + std::to_string(left_out.sample_stride) + " samples";
  if (summed > 0)
    text += "; " + rsi::counted(summed, "other counts", "others count") +
            " in the chain's estimate by their sums";
  if (left_out.kinds)
    text += "; of some kinds (joint, way, home) there is none, since there are too many";
  return text +
         ": memory holds no more; end the stream (RSI off) between campaigns, so that each gets "
         "its own result of all its sweeps";
}

/// Of a device's positions and a controller's angles. Nothing where they could not be joined; then
/// `problem` says why.
std::optional<Outcome> joined_outcome(const Snapshot& snapshot, std::string& problem) {
  const DeviceTake& device = *snapshot.device;
  identify::Campaign campaign = snapshot.campaign;
  campaign.device_frame = true;
  campaign.two_clocks = true;
  campaign.resolution.position_mm = device.step_mm;
  campaign.motion_limit.reset();
  if (device.points.empty()) {
    problem =
        "none came. See whether it measures and sends to this port, and whether its lines have "
        "these columns";
    return std::nullopt;
  }
  auto take = identify::joined(device.angles, device.points, campaign);
  problem = take.problem;
  if (!problem.empty()) return std::nullopt;
  campaign.resolution.time_s = take.stamp_step_s;
  JoinedClocks joined{take.clock,    take.sweeps.size(), take.poses.size(),
                      take.restless, take.left_out_s,    take.fastest_mm_s};
  Outcome outcome{snapshot.robot, snapshot.source_kind, snapshot.counts,
                  identify::identify(take.sweeps, campaign, std::move(take.poses))};
  auto& found = outcome.identification;
  if (found.poses && !found.poses->fit.converged && !take.sweeps.empty()) {
    found = identify::identify(std::move(take.sweeps), campaign);
    found.warnings.push_back(
        {"poses_not_used", {}, "the rests are not used: the fit of them did not come to its end"});
  }
  joined.clock = identify::refined(take.clock, found.delay);
  found.delay.reset();  // it is the clocks'
  std::erase_if(found.warnings, [](const identify::Warning& warning) {
    return warning.code == "angles_not_used";  // stamps have jitter: that is how it should be
  });
  outcome.points =
      PointCounts{device.points.size(), joined.sweeps, device.files, joined.poses, device.targets};
  constexpr std::size_t kRestless = 4;  // one of so many rests is too much
  if (kRestless * joined.restless > joined.restless + joined.poses) {
    found.doubts.push_back(
        {"restless",
         {},
         "in " + std::to_string(joined.restless) + " of " +
             rsi::counted(joined.restless + joined.poses, "rest") +
             " of the robot the device saw its target move: check that the trace belongs to this "
             "take, and that target and device stand firmly"});
    if (found.doubts.size() == 1) apply_doubts(found);
  }
  if (std::abs(joined.clock.rate) > identify::kMostRate)
    found.warnings.push_back(
        {"frame_rate",
         {},
         "the device's clock gains " + fixed(1e6 * joined.clock.rate, 0) +
             " ppm on the controller's, and no clock does: its times were made with a wrong frame "
             "rate. They are corrected by what its motions show; correct the export"});
  outcome.joined = joined;
  return outcome;
}

Outcome plain_outcome(const Snapshot& snapshot) {
  Outcome outcome{snapshot.robot, snapshot.source_kind, snapshot.counts,
                  identify::identify(snapshot.sweeps, snapshot.campaign, snapshot.poses)};
  if (snapshot.sweeps.empty() && !snapshot.poses.empty())  // nobody meant to sweep a joint
    std::erase_if(outcome.identification.warnings, [](const identify::Warning& warning) {
      return warning.code == "joint_never_moved";
    });
  return outcome;
}

/// With what a device saw beside the controller, if there was one.
Outcome first_outcome(const Snapshot& snapshot) {
  if (!snapshot.device) return plain_outcome(snapshot);
  std::string problem;
  if (auto both = joined_outcome(snapshot, problem)) return std::move(*both);
  if (snapshot.device->required) {
    Outcome failed{snapshot.robot, snapshot.source_kind, snapshot.counts, {}};
    failed.points = PointCounts{snapshot.device->points.size(), 0, snapshot.device->files, 0,
                                snapshot.device->targets};
    failed.identification.reason = problem;
    failed.identification.joints.resize(snapshot.campaign.joints);
    failed.identification.home_rad.resize(snapshot.campaign.joints);
    return failed;
  }
  Outcome outcome = plain_outcome(snapshot);
  outcome.identification.warnings.push_back(
      {"device_left_out", {}, "the device's points are left out: " + problem});
  return outcome;
}

/// What is wrong with the stream itself, whatever was made of it.
void doubt_stream(const SourceCounts& counts, identify::Identification& found) {
  identify::Warning doubt{"two_senders", {}, rsi::text_of_two_senders(counts.link)};
  if (counts.link.telegrams == 0 && counts.malformed_in_all() > 0)
    doubt = {"malformed",
             {},
             "none of " + rsi::counted(counts.malformed_in_all(), "datagram") +
                 " held a whole telegram: " + rsi::kNoWholeTelegram};
  if (doubt.message.empty()) return;
  found.doubts.insert(found.doubts.begin(), std::move(doubt));
  apply_doubts(found);
}

/// The engine does not know what the telegrams hold.
void advise_on_positions(const std::string& advice, identify::Identification& found) {
  for (identify::Warning& warning : found.warnings) {
    if (warning.code != "no_positions") continue;
    const bool is_reason = found.reason == warning.message;
    warning.message += ": " + advice;
    if (is_reason) found.reason = warning.message;
  }
}

}  // namespace

Outcome outcome_of(const Snapshot& snapshot) {
  const identify::Campaign& campaign = snapshot.campaign;
  Outcome outcome = first_outcome(snapshot);
  advise_on_positions(snapshot.without_positions, outcome.identification);
  doubt_stream(snapshot.counts, outcome.identification);
  if (campaign.specified) outcome.positive = campaign.specified->positive;
  outcome.limits = snapshot.limits;
  outcome.currents = snapshot.currents;
  outcome.angle_step_rad = campaign.resolution.angle_rad;
  if (!snapshot.missing_signals.empty())
    outcome.identification.warnings.push_back({"missing_signals", {}, snapshot.missing_signals});
  if (!outcome.joined) outcome.motion_limit = campaign.motion_limit;
  if (!outcome.joined && (snapshot.left_out.sweeps > 0 || snapshot.left_out.sample_stride > 1))
    outcome.identification.warnings.push_back(
        {"memory_limit",
         {},
         text(snapshot.left_out, snapshot.sweeps.size(),
              outcome.identification.chain ? outcome.identification.chain->summed : 0)});
  return outcome;
}

Described described(const Outcome& outcome) {
  using identify::AngleTrust;
  const auto& found = outcome.identification;
  if (found.estimator == identify::Estimator::axes) return Described::arm;
  if (outcome.joined) return Described::arm;
  if (!outcome.points) return Described::controller_model;
  if (found.poses) return found.poses->computed ? Described::controller_model : Described::arm;
  const bool from_angles =
      found.chain && std::any_of(found.chain->angles.begin(), found.chain->angles.end(),
                                 [](const identify::AngleEvidence& joint) {
                                   return joint.trust == AngleTrust::trusted;
                                 });
  return from_angles ? Described::controller_model : Described::arm;
}

std::string_view text(Described described) noexcept {
  return described == Described::arm ? "arm" : "controller_model";
}

std::string explanation(const Outcome& outcome) {
  constexpr double kFewDecimals_rad = 0.005 * identify::kDegree;
  constexpr std::string_view kScale =
      "The device's own scale is not in the uncertainties: where it is off by 0.01 %, a length of "
      "1 m is off by 0.1 mm, and positions do not show it.";
  if (described(outcome) == Described::controller_model && outcome.identification.poses &&
      outcome.angle_step_rad > kFewDecimals_rad)
    return "the controller's model, as far as anyone can tell: the positions agree with the "
           "angles to the printed decimals. Angles of so few decimals hide what a device measures: "
           "if one measured the positions, write the angles with three decimals or more, or "
           "measure several targets at each rest.";
  if (described(outcome) == Described::controller_model)
    return "the controller's model: its positions are computed from its angles. It tells machine "
           "data, TOOL and BASE, and whether an elastic model is active. It does not tell how the "
           "arm is: for that, measure it with a device.";
  if (outcome.identification.estimator == identify::Estimator::axes)
    return "the arm as the given axes have it. Nothing here tells where they are from, and what "
           "they leave out.";
  if (outcome.identification.poses)
    return "the arm as a device measured it: for calibration, and to compare with its model. "
           "Where joints are seen to give way to weight, the table of what joints do says so. What "
           "the poses do not show of it is not in the uncertainties. " +
           std::string(kScale);
  const auto& chain = outcome.identification.chain;
  const std::string_view elastic =
      !chain || !(chain->effects.sag_rad > 0)
          ? "Elastic deformation is not in the uncertainties: sag_arcsec in the robot description "
            "puts it there, and so do static poses and sweeps from a second home."
      : chain->effects.sag_told
          ? "Elastic deformation is in the uncertainties as far as the robot description states it "
            "(sag_arcsec)."
          : "Elastic deformation is in the uncertainties as far as sweeps from several homes show "
            "it.";
  const bool told =
      chain && std::any_of(chain->angles.begin(), chain->angles.end(),
                           [](const identify::AngleEvidence& joint) { return joint.samples > 0; });
  const std::string_view play =
      told ? ""
           : "What joints play by is not in the uncertainties: only angles beside the positions "
             "show it. ";
  return "the arm as a device measured it: for calibration, and to compare with its model. " +
         std::string(elastic) + " " + std::string(play) + std::string(kScale);
}

}  // namespace sweepd
