#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "identify/chain/chain_estimate.hpp"

namespace simulation {

/// Errors of the positions: of the device that measures them. Standard deviations; each of three
/// directions.
struct Noise {
  double range_mm = 0;     ///< along the line from the device, which is its frame's origin
  double across_mm = 0;    ///< in the two directions across it
  double correlation = 0;  ///< of a sample's error with that of the one before: AR(1)
  double outlier_share = 0;
  double outlier_mm = 5;        ///< how far off, in any direction
  std::optional<int> decimals;  ///< of the mm that it prints; nothing: all
};

/// How the device wanders from the first sample to the last.
struct Drift {
  double linear_mm = 0;  ///< in any direction
  double walk_mm = 0;    ///< a random walk: root mean square of where it ends
  double sway_mm = 0;    ///< to and fro, in any direction: half of its way
  double sways = 1;      ///< so often over all sweeps
  double warm_mm = 0;    ///< as what warms up, in a fifth of the time by 1/e: all of its way
  /// It is moved once, in any direction, by so much, and turned about itself: by so much, 3 m away.
  double moved_mm = 0;
  double moved_at = 0.5;  ///< of all the time: before the next stroke
};

/// How locked joints stand elsewhere than at home.
struct HomeError {
  double sigma_deg = 0;  ///< each locked joint; of linear ones ten times as many mm
  /// Drawn anew for each stroke, for each stand (when another joint sweeps), or when the joint
  /// itself has swept.
  identify::HomeLasts lasts = identify::HomeLasts::stroke;
  double creep_deg = 0;  ///< and how far each goes on evenly behind it while a stroke runs, sigma
  bool seen = false;     ///< by the encoders; else it is play behind them
  /// Each joint after its own strokes, until it is swept again; the encoders see it.
  double stray_sigma_deg = 0;
  std::optional<std::size_t> joint;  ///< only this one's; nothing: all joints'
};

/// Where the arm is beyond what the encoder says.
struct Gears {
  double first_arcsec = 0;   ///< amplitude of sin(q + phase), every joint with a phase of its own
  double second_arcsec = 0;  ///< of sin(2 q + phase)
  /// Play: the arm is behind its motor by half of it.
  double backlash_arcsec = 0;
  std::optional<std::size_t> joint;  ///< only this one's; nothing: all joints'
  /// Of the phases, where several campaigns are of one robot; nothing: the campaign's.
  std::optional<std::uint32_t> seed = {};
  /// Locked joints stand in their play as their last move left them, the one that led home from
  /// their sweep; before it, either way. The true table has them in the middle. Else all came home
  /// rising, in the true table, too.
  bool play_as_left = false;
  /// Before each of its strokes the sweeping joint settles elsewhere behind its motor, and stays so
  /// through it: standard deviation.
  double settles_deg = 0;
};

/// When angles were read: `late_s` before the position of the same sample, and later by the
/// device's clock, which goes wrong by `rate_ppm`.
struct Delay {
  double late_s = 0;
  double rate_ppm = 0;
};

/// What bends arcs, as a smooth random function of the joint's angle in each of the radial, axial
/// and tangential direction: Chebyshev polynomials of the arc, order m with a standard deviation as
/// max(1, m)^-power. Nothing at home, which all arcs share.
struct ArcShape {
  double rms_mm = 0;  ///< each direction, expected over the arc before home is made nothing
  double power = 2;
};

/// Everything that may go wrong in a simulated campaign. All zero: exact data. Every source of
/// errors draws its numbers by itself: a knob turned leaves the others' errors as they are.
struct World {
  /// Positions are the controller's, computed from its encoders: no error of the gears is in them.
  bool controller = false;
  bool orientations = false;    ///< are known, the controller's
  bool angles = false;          ///< are known, the controller's
  bool placed = false;          ///< the device stands some metres away, and its frame is its own
  std::optional<int> decimals;  ///< of what a controller prints, mm and degrees; nothing: all
  std::optional<int> time_decimals;  ///< of the stamps, s; nothing: all
  double wobble_deg = 0;  ///< of every joint's servo, a sample, sigma; the encoders see it
  Noise noise;
  Drift drift;
  HomeError home;
  Gears gears;
  double sag_arcsec = 0;  ///< of the elastic joints, at the worst pose (gravity.hpp)
  bool sag_told = false;  ///< the robot's description says so
  Delay delay;
  ArcShape shape;
};

}  // namespace simulation
