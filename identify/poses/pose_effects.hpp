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

/// A fit, with the effects that the poses asked for.
struct EffectsFit {
  PoseFit fit;
  std::vector<EffectEvidence> effects;
};

/// fitted() from there; then the effects that the poses ask for are added, one after the other, and
/// all is fitted anew. Joints that turn are tried once and twice a turn, and for compliance where
/// loads are known, else for what weights on the links behind them bend. What joints are off where
/// rests share their places is common to these, as it is of gears; where it is clearly likelier,
/// anew at each, as it is of the servo.
[[nodiscard]] EffectsFit fitted_with_effects(const PoseModel& start, const PoseNoise& noise,
                                             const std::vector<Pose>& poses, bool with_orientation,
                                             const std::optional<ChainPrior>& prior);

}  // namespace identify
