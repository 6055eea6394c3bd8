#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "identify/chain/chain_estimate.hpp"

namespace identify {

/// How axes, targets and the tool at home, the rows of ChainEstimate::covariance, change with the
/// turn of a joint at which it stands there (rad), to first order. `known`: whether a joint has an
/// axis.
[[nodiscard]] Eigen::VectorXd by_turn_at_home(const Chain& at_home, std::size_t joint,
                                              const std::vector<bool>& known, std::size_t targets,
                                              bool with_orientation);

/// Adds what is not known of where joints stood at home: variances of their turns (rad²), one a
/// joint. They belong to Cause::home.
void add_turns_at_home(ChainEstimate& estimate, const std::vector<double>& variances);

/// By these variances play leaves home open. A joint stands on either side of its play, as its last
/// move left it, and strokes do not tell on which: home is in the middle, and half the play off it
/// counts as a standard uncertainty. Zero for joints whose angles are believed, or that are not
/// seen to play beyond chance.
[[nodiscard]] std::vector<double> play_variances(const std::vector<AngleEvidence>& angles);

}  // namespace identify
