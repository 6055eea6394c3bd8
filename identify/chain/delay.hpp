#pragma once

#include <optional>
#include <vector>

#include "identify/chain/chain.hpp"
#include "identify/circle/circle_estimate.hpp"
#include "identify/sweeps/campaign.hpp"

namespace identify {

/// How late the controller's angles are against the positions.
struct Delay {
  double late_s = 0;      ///< at `at_s`: the angles told at t are those of t - late
  double sigma_s = 0;     ///< standard uncertainty
  double rate = 0;        ///< so many seconds a second it grows: clocks that differ; 0: not seen to
  double at_s = 0;        ///< in the campaign's time
  double rate_sigma = 0;  ///< 0: `rate` was not asked for
};

/// A delay of more standard uncertainties is one.
inline constexpr double kSignificantDelay = 4;

/// How late the controller's angles are against the positions, one figure for the whole campaign:
/// from how the told angle of each swept joint and the one seen about its axis differ as the joint
/// turns one way and the other, faster and slower. Each joint may have a smooth error along its arc
/// and a backlash of its own besides: what all joints share is the delay. `axes`: one a joint, in
/// the measurement frame, along positive rotation. Of sweeps that the circles used.
///
/// Of two clocks the rate is told whatever it is; else only where it is more than chance makes.
///
/// Nothing where the campaign does not tell it: no angles or times, each joint turned one way at
/// one speed, or angles that do not follow the positions.
[[nodiscard]] std::optional<Delay> find_delay(const CircleEstimate& circles,
                                              const std::vector<std::optional<ChainAxis>>& axes,
                                              const Campaign& campaign);

/// Whether it is one: more than chance makes of none.
[[nodiscard]] bool is_significant(const Delay& delay) noexcept;

/// How far angles may be out of step once one was taken out, or none was: a standard deviation. A
/// delay that does not show for certain counts by how likely it is (Bayes' factor against none).
[[nodiscard]] double untold_delay_s(const Delay& delay);

/// By how much a joint's angles may still differ between its two directions where a delay was
/// taken out of them: as far as the delay is uncertain, as stamps are rounded to `stamp_step_s`,
/// and by the noise of one sample, `noise_mm`, at strokes' ends, where angles were not told in
/// time. A standard uncertainty.
[[nodiscard]] double play_by_delay_rad(const JointResult& joint, const Delay& delay,
                                       double noise_mm, double stamp_step_s);

/// The sweeps with the swept joint's angles as they were when the positions were taken. At a
/// sweep's ends, where that was not told, angles go on along the circle. Sweeps from elsewhere than
/// home run about an axis of their own.
[[nodiscard]] CircleEstimate in_step(CircleEstimate circles,
                                     const std::vector<std::optional<ChainAxis>>& axes,
                                     const Delay& delay);

}  // namespace identify
