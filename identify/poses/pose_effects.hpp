#pragma once

#include <optional>
#include <vector>

#include "identify/poses/pose_fit.hpp"

namespace identify {

/// How strongly poses ask for an effect of a joint.
struct EffectEvidence {
  JointEffect effect;
  Eigen::Vector2d sigma = Eigen::Vector2d::Zero();  ///< of its sizes
  /// The chance that poses without the effect would ask for it as strongly: a score test,
  /// chi-square with as many degrees of freedom as it has sizes (Rao, Proc. Camb. Phil. Soc. 44,
  /// 1948).
  double chance = 1;
};

/// An effect is taken where the chance of any of those tried by accident is below this
/// (Bonferroni).
inline constexpr double kEffectByChance = 0.02;

/// Adds to the fit, one after the other, the effects that the poses ask for, and fits anew. Returns
/// those that were added. Joints that turn are tried once and twice a turn, and for compliance
/// where loads are known, else for what weights on the links behind them bend.
[[nodiscard]] std::vector<EffectEvidence> add_effects(PoseFit& fit, const std::vector<Pose>& poses,
                                                      const std::optional<ChainPrior>& prior);

}  // namespace identify
