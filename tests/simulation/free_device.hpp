#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "identify/clock/angle_tape.hpp"
#include "identify/clock/motion_spans.hpp"
#include "tests/simulation/program.hpp"
#include "tests/simulation/robot.hpp"
#include "tests/simulation/world.hpp"

namespace simulation {

/// 0.02 mm in every direction.
[[nodiscard]] inline Noise tracker_noise() {
  Noise noise;
  noise.range_mm = noise.across_mm = 0.02;
  return noise;
}

/// A device that knows nothing of the controller, and is unkind: how its clock goes, and what it
/// loses.
struct FreeDevice {
  double rate_hz = 100;
  double ahead_s = 0;       ///< of the controller's clock, in the middle of the program
  double rate_ppm = 0;      ///< what its clock gains
  double jitter_s = 0;      ///< of its stamps: up to so much, either way
  double stamp_step_s = 0;  ///< its stamps are rounded to this; 0: they are not
  double loss = 0;          ///< this share of its samples
  std::vector<identify::Span> gaps = {};  ///< it sees nothing, by the controller's clock
  double step_s = 0;                      ///< its clock is set so much ahead,
  double step_at_s = 0;                   ///< at this time of the controller
  Noise noise = tracker_noise();
  Drift drift = {};  ///< of where it stands
  /// Of the arm that it sees: each joint follows its motor through its play, and stands while the
  /// motor crosses it. At first it is on either side.
  double play_arcsec = 0;
  std::optional<std::size_t> plays = {};  ///< this joint alone; nothing: all joints
};

/// A program as its controller tells it, and as the device sees the robot's targets do it.
struct TwoViews {
  identify::AngleTape tape;
  std::vector<identify::Measured> points;
};

struct Telling {
  double cycle_s = 0.004;
  double wobble_deg = 1e-4;
  int decimals = 4;  ///< of angles in degrees
};

[[nodiscard]] TwoViews two_views(const Robot& robot, const Program& program,
                                 const FreeDevice& device, std::uint32_t seed,
                                 const Telling& telling = {});

}  // namespace simulation
