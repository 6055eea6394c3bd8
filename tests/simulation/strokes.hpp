#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "tests/simulation/robot.hpp"

namespace simulation {

/// A joint that turns evenly while another one is swept, though it should stand.
struct Along {
  std::size_t swept = 0;
  std::size_t joint = 0;
  double from_deg = 0;  ///< from home, at each stroke's begin
  double by_deg = 0;    ///< until its end
};

/// Which sweeps a campaign has, and how the joints are moved.
struct Strokes {
  double arc_deg = 90;  ///< every joint, home in its middle
  /// One a joint, of each home or of all, from home, start and end: instead of `arc_deg`. Empty:
  /// that.
  std::vector<std::array<double, 2>> ranges_deg;
  int samples = 300;  ///< a stroke
  int stops = 0;      ///< of a stroke, at which all samples are taken; 0: they are along the way
  bool there_and_back = false;
  int repeats = 1;
  int rounds = 1;                ///< all of a home's over again
  int homes = 1;                 ///< each further one 15 to 30 degrees off in every joint
  bool targets_at_once = false;  ///< all in one stroke, as with markers; else one after the other
  double speed_deg_s = 20;       ///< on average
  std::vector<double> times_as_fast;  ///< one a joint; empty: all at that speed
  /// The share of a stroke's time in which it gets to speed, and again in which it stops. Zero: at
  /// speed before the first sample and after the last.
  double ramp = 0;
  double rest_s = 10;  ///< between strokes
  std::optional<Along> along;
};

/// One joint from here to there, the others at home.
struct Stroke {
  std::size_t joint = 0;
  std::size_t home = 0;
  std::vector<std::size_t> targets;
  double from_rad = 0;  ///< turned from home
  double to_rad = 0;
  double start_s = 0;
  double seconds = 0;
  bool last_of_joint = false;  ///< the next one is another joint's

  [[nodiscard]] int direction() const { return to_rad > from_rad ? 1 : -1; }
  /// Where the joint is `time_s` after the start, turned from home. Without ramps it is at speed
  /// before the start and after the end.
  [[nodiscard]] double turn_at(double time_s, double ramp) const;
};

/// Home by home, round by round, target by target, joint by joint. Of neighbours one rises and one
/// falls.
[[nodiscard]] std::vector<Stroke> strokes_of(const Strokes& how, std::size_t joints,
                                             std::size_t targets);

/// The homes, the robot's own first; the others by chance, with targets off the axes.
[[nodiscard]] std::vector<std::vector<double>> homes_of(const Strokes& how, const Robot& robot,
                                                        std::uint32_t seed);

}  // namespace simulation
