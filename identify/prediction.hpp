#pragma once

#include <optional>
#include <vector>

#include "identify/chain/chain_estimate.hpp"
#include "identify/identification.hpp"

namespace identify {

/// What the estimator will find to be the noise of positions, orientations and angles that one
/// controller prints, in units of `resolution`. Its positions are those of its angles: the joints'
/// wobble is known but for what printing takes away. Of a locked joint that is less than a rounding
/// error's q / sqrt(12) where the joint wobbles by less than the step q.
[[nodiscard]] ChainNoise printed_noise(const Resolution& resolution, double wobble_rad,
                                       std::size_t joints);

/// The noise where another device measures positions alone: the locked joints' wobble is not known.
[[nodiscard]] ChainNoise device_noise(double position_mm, double wobble_rad, std::size_t joints);

/// What a campaign will tell, said beforehand.
struct Prediction {
  /// The specified table, one row a joint, with the standard uncertainties that an identification
  /// will state; what it cannot determine is named as it will be there.
  std::vector<DhEstimate> dh;
  /// One a joint, along positive rotation; nothing where the campaign leaves the axis uncertain by
  /// more than a degree.
  std::vector<std::optional<Axis>> axes;
  /// How far the target is from each axis, one a joint; at home, mm.
  std::vector<double> radius_mm;
};

/// The estimator's covariance at the specified arm, by the Fisher information of all samples that
/// the estimator uses of a rehearsal: the campaign with simulated samples, identified. From it come
/// the sweeps, what of each is kept, and which angles and orientations were believed; of `noise`,
/// the angles that were not are free. `campaign` has a specified arm, with the target; it is what
/// the rehearsal was identified by. Never throws for what the rehearsal holds.
[[nodiscard]] Prediction predict(const Identification& rehearsed, const Campaign& campaign,
                                 ChainNoise noise);

/// Predictions from rehearsals of the same plan with other errors, at least one, as one: variances
/// are their means.
[[nodiscard]] Prediction mean(const std::vector<Prediction>& predictions);

}  // namespace identify
