#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "daemon/plan/simulated_robot.hpp"
#include "daemon/settings/robot_description.hpp"
#include "daemon/settings/sweep_plan.hpp"
#include "identify/identification.hpp"
#include "identify/prediction.hpp"

namespace sweepd {

/// How a plan's sweeps will be measured.
struct Measurement {
  std::chrono::milliseconds cycle = rsi::kUsualCycle;  ///< of the controller, 1 to 1000
  int precision = rsi::kUsualPrecision;                ///< decimals of the controller's numbers
  double wobble_deg = kUsualWobble_deg;                ///< of every joint, standard deviation
  /// Another device's points in place of the controller's, isotropic: one a cycle, without angles
  /// and orientations, in a frame of the device's own.
  std::optional<double> position_sigma_mm;
};

/// A plan, run by the simulated robot and identified as a live campaign would be.
struct Rehearsal {
  identify::Campaign campaign;
  std::vector<identify::Sweep> strokes;  ///< all that were seen, positioning and too short ones
  /// One a sweep of the plan: its stroke, from start to end; nothing where none was seen.
  std::vector<std::optional<std::size_t>> stroke_of_sweep;
  identify::Identification identification;  ///< where the strokes that count stand by joints
  std::chrono::milliseconds duration{};

  /// What such campaigns find, on average over all wobbles.
  [[nodiscard]] identify::Prediction prediction(const Measurement& measurement) const;
};

/// Telegrams of the simulated robot go through the same pipeline as a controller's, in process. The
/// same arguments give the same rehearsal. Throws as SimulatedRobot does.
[[nodiscard]] Rehearsal rehearse(const RobotDescription& robot, const SweepPlan& plan,
                                 const Measurement& measurement, std::uint64_t seed = 1);

}  // namespace sweepd
