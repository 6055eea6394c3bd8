#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "identify/poses/pose_model.hpp"
#include "identify/poses/pose_rows.hpp"
#include "identify/poses/pose_stands.hpp"

namespace identify {

/// What sweeps of the same robot in the same measurement frame told of the chain: its estimate, and
/// what they weigh, the inverse of its covariance, zero for what they left open. In the order of
/// ChainParameters, with the tool's rotation.
struct ChainPrior {
  Chain chain;
  Eigen::MatrixXd information;
};

/// Poses off by more than this, in standard deviations, count less, and those off by more than the
/// second not at all.
inline constexpr double kWholeWeight = 4;
inline constexpr double kNoWeight = 7;

/// A model fitted to poses: generalised least squares, Gauss-Newton, with the sizes of the noise by
/// restricted likelihood (Patterson & Thompson, Biometrika 58, 1971). Each step multiplies a
/// component's variance by what is seen of it over what is expected: they are equal where the
/// likelihood is largest.
struct PoseFit {
  PoseModel model;
  PoseNoise noise;
  Eigen::VectorXd weights;     ///< one a pose, 1 for those that fit
  std::vector<PoseRow> rows;   ///< one a pose, at the model
  std::vector<Stand> stands;   ///< of the poses
  Eigen::MatrixXd covariance;  ///< of the model's parameters; zero along what is undetermined
  Eigen::MatrixXd open;        ///< what that lacks: `open` times its transpose

  /// Of all the model's parameters, undetermined ones with what little the poses tell.
  [[nodiscard]] Eigen::MatrixXd whole_covariance() const {
    return covariance + open * open.transpose();
  }
  /// By how much `covariance` was widened because the sizes of the noise are estimates, too.
  double widened = 1;
  double condition = 0;  ///< once widen() has been called
  int iterations = 0;
  bool converged = false;
  bool with_orientation = false;

  /// Standard deviations of an effect's sizes, and of what a joint is off at a place, as they were
  /// known beforehand.
  [[nodiscard]] double known_beforehand(const JointEffect& effect) const {
    return effect.assumed ? noise.assumed_rad(effect.kind) * std::sqrt(widened) : effect.prior();
  }
  [[nodiscard]] double known_beforehand(const JointPlace& /*anywhere*/) const {
    return noise.joint_rad * std::sqrt(widened);
  }

  /// The rows of the stands that count.
  [[nodiscard]] std::vector<StandRows> counted() const;
  /// How far off a pose is (sigmas_of()).
  [[nodiscard]] double sigmas_off(std::size_t pose) const;
};

/// From `start`, whose model may be off by as much as Gauss-Newton bears. The noise starts as large
/// as `noise` says; zero stays zero. The joints' may not be zero where the model has places. Where
/// gears are assumed (NoiseSizes::hold()), `noise` is what is known of it without them.
[[nodiscard]] PoseFit fitted(const PoseModel& start, const PoseNoise& noise,
                             const std::vector<Pose>& poses, bool with_orientation,
                             const std::optional<ChainPrior>& prior);

/// Minus twice the logarithm of the restricted likelihood, less a constant, with the places and the
/// effects integrated out (Harville, J. Am. Stat. Assoc. 72, 1977): of fits to the same poses the
/// likelier one's is less. `weights`: a pose each, for both the same.
[[nodiscard]] double deviance(PoseFit fit, const Eigen::VectorXd& weights,
                              const std::vector<Pose>& poses,
                              const std::optional<ChainPrior>& prior);

/// States the covariance for who does not know the noise: what the poses tell counts less by
/// (d - 2 k) / d, with d their degrees of freedom and k the sizes of noise that were estimated. Of
/// one size that gives the variance of Student's distribution, as the GUM's supplement 1 has it
/// (JCGM 101:2008, 6.4.9).
void widen(PoseFit& fit, const std::vector<Pose>& poses, const std::optional<ChainPrior>& prior);

/// The fit with the covariance that it has where this is the noise.
[[nodiscard]] PoseFit with_noise(PoseFit fit, const PoseNoise& noise,
                                 const std::vector<Pose>& poses,
                                 const std::optional<ChainPrior>& prior);

}  // namespace identify
