#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "identify/chain/delay.hpp"
#include "identify/clock/angle_tape.hpp"
#include "identify/clock/clock_match.hpp"
#include "identify/clock/motion_spans.hpp"
#include "identify/poses/pose.hpp"
#include "identify/sweeps/campaign.hpp"
#include "identify/sweeps/sweep.hpp"

namespace identify {

/// What a device and a controller saw together: the controller tells joints, directions, homes and
/// locked angles, the device where its targets were.
struct JoinedTake {
  ClockMatch clock;           ///< by the motions' middles
  std::vector<Sweep> sweeps;  ///< of single joints, by the controller's clock
  std::vector<Pose> poses;    ///< one a rest and target
  std::size_t restless = 0;   ///< rests by the angles in which the device saw motion
  double left_out_s = 0;      ///< motion of several joints at once
  double fastest_mm_s = 0;    ///< of the sweeps
  double stamp_step_s = 0;    ///< the device's stamps are rounded to it; 0: they are not
  std::string problem;        ///< why the two could not be joined; empty: they were
};

/// Matches the clocks, then takes single-joint sweeps and rests out of both. Motion of several
/// joints at once is left out: at 300 mm/s its clocks would have to be known to 67 us. Where
/// several offsets fit as well, the specified arm tells them apart, if there is one. Points in the
/// order of time.
[[nodiscard]] JoinedTake joined(const AngleTape& tape, const std::vector<Measured>& points,
                                const Campaign& campaign);

/// The clocks by the strokes themselves: `clock`, with what the sweeps showed to be left of it.
/// That is `clock` where they do not tell.
[[nodiscard]] ClockMatch refined(const ClockMatch& clock, const std::optional<Delay>& delay);

}  // namespace identify
