#pragma once

// Outcomes as a campaign leaves them, for tests of what is written about them.

#include <cmath>

#include "daemon/results/outcome.hpp"
#include "daemon/text/units.hpp"
#include "identify/sweeps/segmentation.hpp"
#include "tests/identify/simulated_campaign.hpp"

namespace sweepd::test {

/// The samples are printed with four decimals first.
inline Outcome outcome_of(std::vector<identify::Sample> samples, identify::Campaign campaign) {
  const auto printed = [](double value) { return std::round(value * 1e4) / 1e4; };
  for (auto& sample : samples) {
    for (double& value : sample.position_mm) value = printed(value);
    for (double& value : sample.angles_rad) value = radians(printed(degrees(value)));
  }
  campaign.resolution = {1e-4, radians(1e-4)};
  identify::Segmenter segmenter(campaign.joints);
  segmenter.set_resolution(campaign.resolution);
  std::vector<identify::Sweep> sweeps;
  const auto keep = [&](const std::vector<identify::Sweep>& found) {
    sweeps.insert(sweeps.end(), found.begin(), found.end());
  };
  for (const auto& sample : samples) keep(segmenter.push(sample));
  keep(segmenter.finish());
  Outcome outcome;
  outcome.robot = "kr5-arc";
  outcome.counts.link.telegrams = samples.size();
  outcome.counts.cycle = std::chrono::milliseconds(4);
  outcome.identification = identify::identify(sweeps, campaign);
  return outcome;
}

inline identify::Campaign kr5_campaign() {
  identify::Campaign campaign;
  campaign.specified = identify::test::kr5_arc();
  return campaign;
}

/// All joints of a KR 5 arc, with a specified table.
inline Outcome complete_outcome() {
  static const Outcome once = [] {
    identify::test::Campaign campaign(identify::test::kr5_arc(), {.wobble_deg = 1e-4});
    campaign.sweep_all_90();
    return outcome_of(campaign.samples(), kr5_campaign());
  }();
  return once;
}

/// Joints 1, 2 and 4.
inline Outcome partial_outcome() {
  static const Outcome once = [] {
    identify::test::Campaign campaign(identify::test::kr5_arc(), {.wobble_deg = 1e-4});
    campaign.rest().sweep(0, -45, 45).sweep(1, -60, -130).sweep(3, 90, 0);
    return outcome_of(campaign.samples(), kr5_campaign());
  }();
  return once;
}

/// Nothing moved.
inline Outcome failed_outcome() {
  identify::test::Campaign campaign(identify::test::kr5_arc());
  campaign.rest(2);
  return outcome_of(campaign.samples(), kr5_campaign());
}

/// As complete, of a robot about which nothing is known beforehand.
inline Outcome unspecified_outcome() {
  static const Outcome once = [] {
    identify::test::Campaign campaign(identify::test::kr5_arc(), {.wobble_deg = 1e-4});
    campaign.sweep_all_90();
    return outcome_of(campaign.samples(), {});
  }();
  return once;
}

}  // namespace sweepd::test
