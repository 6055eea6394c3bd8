#pragma once

#include <optional>
#include <vector>

#include "identify/chain/chain_estimate.hpp"
#include "identify/circle/circle_estimate.hpp"
#include "identify/sweeps/campaign.hpp"

namespace identify {

/// The estimator `chain`: all axes, sweeps, homes and targets in one weighted least-squares problem
/// (maximum likelihood), as a product of exponentials. It starts from what the circles found in
/// `circles`, whose `joints`, `home_rad` and `specified` it takes, and uses their sweeps, where
/// angles are known also those from other homes.
///
/// How far angles are believed is decided by the data:
///  - First no sweeping joint's angle is used. Then a sample tells the distance from the circle,
///  and
///    nothing along it. That is safe whatever the angles are like.
///  - Where the scatter is explained by the print quantum (`campaign.resolution`), positions and
///    angles come from the same encoders: angles are believed, joint by joint, as long as the
///    residuals along the motion are small and without pattern.
///  - Where the scatter is larger (another device), a smooth error of the angles as large as the
///    free estimate's own uncertainty could not be seen, and would do as much harm as there is to
///    gain: the angles stay unused, and their error is reported as a smooth curve where it is one.
///    A smooth curve with an offset and a first harmonic moves a circle's centre at will, so that
///    to estimate it along with the geometry gains nothing over free angles.
///
/// Locked joints' angles, where known, are used with their scatter. Samples off by more than some
/// standard deviations lose their weight. Nothing if there is no axis to start from. Deterministic.
/// `axes` are the starting_axes() of the circles; `late_s`: untold_delay_s().
[[nodiscard]] std::optional<ChainEstimate> estimate_chain(
    const CircleEstimate& circles, std::vector<std::optional<ChainAxis>> axes,
    const Campaign& campaign, double late_s);

}  // namespace identify
