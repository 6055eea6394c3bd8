#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "identify/chain/chain.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/poses/pose.hpp"
#include "identify/sweeps/campaign.hpp"

namespace identify {

/// What a joint turns by beside what its angle says: an eccentric wheel or encoder, once and twice
/// a turn, what its gear gives way by under weights that are known (compliance) or not (weight), or
/// half of its play.
struct JointEffect {
  enum class Kind { once, twice, weight, compliance, play };
  Kind kind = Kind::once;
  std::size_t joint = 0;
  std::size_t carried = 0;  ///< of a weight: it is on the link that this joint turns
  /// No test found it: it is there as in all gears, as large as PoseNoise says.
  bool assumed = false;
  /// What the pattern below is at home: there the effect is zero, so that theta is that of the arm
  /// as it stands at home.
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  /// Once, twice (k = 1, 2): rad times cos(k t) and times sin(k t), with t the joint's turn from
  /// home. Weight: rad times the levers of a weight on the link (LinkLevers), one in each of the
  /// directions `across` the axis that turns it. Compliance: rad/Nm times the torque of the weights
  /// about the joint. These less `middle`. Play: rad times the sense in which the joint last
  /// turned.
  Eigen::Vector2d size = Eigen::Vector2d::Zero();

  /// Standard deviation of a size that was found, known beforehand: what poses hardly tell
  /// from lengths and twists does not run away. Wheels are off by a minute of arc or two; a reducer
  /// gives way by some seconds of arc a newton metre at most.
  [[nodiscard]] double prior() const { return kind == Kind::compliance ? 1e-4 : 300 * kArcsec; }
  [[nodiscard]] bool is_like(const JointEffect& other) const {
    return kind == other.kind && joint == other.joint && carried == other.carried;
  }
  [[nodiscard]] bool is_wheel() const { return kind == Kind::once || kind == Kind::twice; }
  [[nodiscard]] Eigen::Index count() const {
    return kind == Kind::compliance || kind == Kind::play ? 1 : 2;
  }
  /// Half of what it spreads over, rad; of a compliance rad/Nm.
  [[nodiscard]] double amplitude() const { return size.head(count()).norm(); }
};
[[nodiscard]] std::string_view text(JointEffect::Kind kind) noexcept;

/// A place at which a joint stood in several poses: what its angle is off there is one unknown of
/// all of them, however often they return to it.
struct JointPlace {
  std::size_t joint = 0;
  double told_rad = 0;  ///< from home
  double off_rad = 0;   ///< what it turns by beside what is told
};
/// Angles no farther than this from its middle are of one place: gears hardly change within it.
inline constexpr double kOnePlace_rad = 0.05 * kDegree;

/// A robot as static poses show it: a chain, and what its joints do beside what they tell.
struct PoseModel {
  Chain chain;
  std::vector<double> home_rad;      ///< the controller's angles at which the chain is at home
  std::vector<JointEffect> effects;  ///< first those that were found, then those that are assumed
  std::vector<JointPlace> places;
  /// Joints that never leave home, whose axes nobody has seen; one a joint, or none: no such joint.
  std::vector<bool> still;
  /// The chain was seen at home: what the joints are off there is in its zeros already.
  bool seen_at_home = false;
  std::vector<Load> loads;  ///< centres of mass at home, in the measurement frame

  /// From home, as the angles tell; the short way, as some tell them from 0 to 360 degrees.
  [[nodiscard]] Turns told(const Sample& sample) const;
  /// And as they are. Where no senses are known, in the middle of their play.
  [[nodiscard]] Turns turned(const Turns& told, const JointSenses& senses = {}) const;
  /// What each of these effects' sizes are multiplied by, 1 or Nm, where the joints turned so far,
  /// less its middle; two, or one and nothing.
  [[nodiscard]] std::vector<Eigen::Vector2d> patterns(const std::vector<JointEffect>& of,
                                                      const Turns& told,
                                                      const JointSenses& senses = {}) const;
  [[nodiscard]] Eigen::Vector3d position_mm(const Pose& pose) const;

  /// Whether what a joint is off where it turned so far is in its zero.
  [[nodiscard]] bool is_known(double told_rad) const {
    return seen_at_home && std::abs(told_rad) <= kOnePlace_rad;
  }
  /// Where the joint stands, of those above; their number where it is none of them, or home.
  [[nodiscard]] std::size_t place_of(std::size_t joint, double told_rad) const;

  /// Of the chain's parameters, with the tool's rotation, of the effects', and one a place.
  [[nodiscard]] ChainParameters chain_parameters() const {
    return {chain.axes.size(), chain.targets_mm.size()};
  }
  [[nodiscard]] Eigen::Index parameters() const;
  /// Those of the chain and of effects that were found: what is no random size.
  [[nodiscard]] Eigen::Index fixed_parameters() const;
  /// Without the places', which tell nothing of poses elsewhere.
  [[nodiscard]] Eigen::Index lasting_parameters() const;
};

/// The model after a change of its parameters.
[[nodiscard]] PoseModel moved(const PoseModel& model, const Eigen::VectorXd& change);

}  // namespace identify
