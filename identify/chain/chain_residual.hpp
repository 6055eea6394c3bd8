#pragma once

#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "identify/chain/chain_estimate.hpp"
#include "identify/chain/chain_sag.hpp"

namespace identify {

/// One sample as the chain estimator uses it.
struct ChainObservation {
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();
  Eigen::Matrix3d orientation = Eigen::Matrix3d::Identity();  ///< of the tool, where measured
  Turns turns{};             ///< from home; the sweeping joint's as estimated where it is free
  double measured_turn = 0;  ///< of the sweeping joint
  std::size_t joint = 0;     ///< the sweeping one
  std::size_t target = 0;
  std::size_t sweep = 0;  ///< samples of one stroke stand next to each other, in time's order
  bool falling = false;   ///< the stroke's direction
  double weight = 1;      ///< 0 to 1: how far the sample is believed
  DriftTimes times = DriftTimes::Zero();  ///< when it was seen; zero where nobody knows
  bool before_move = false;               ///< the chain's `move` counts
};

/// The turns of a sample of `joint`'s sweep: where its angle is believed, by where that is zero,
/// and of joints whose angles are told, with what they sag by.
[[nodiscard]] inline Turns turns_of(const Chain& chain, Turns turns, std::size_t joint,
                                    const ChainNoise& noise) {
  const bool told = std::isfinite(noise.swept_rad[joint]);
  if (!chain.zero_rad.empty() && told) turns[joint] += chain.zero_rad[joint];
  if (chain.sags.empty()) return turns;
  Turns bent = sagged(chain, turns);
  if (!told) bent[joint] = turns[joint];
  return bent;
}
[[nodiscard]] inline Turns turns_of(const Chain& chain, const ChainObservation& seen,
                                    const ChainNoise& noise) {
  return turns_of(chain, seen.turns, seen.joint, noise);
}

/// Measured minus predicted, at one sample: `Size` 3 for the position (mm), 6 with the orientation
/// (rotation vector in the measurement frame, rad).
///
/// Angles are measured with errors too. Each moves the prediction along its column of the Jacobian,
/// so that the errors of a sample have the covariance diag(noise) + sum_k sigma_k^2 J_k J_k^T. Its
/// inverse is the sample's weight. An angle that is not used has sigma infinite: the weight along
/// its column is zero then, which is the same as to estimate that angle sample by sample (Fuller,
/// Measurement Error Models, 1987, ch. 3; Golub & Pereyra 1973 for the projection).
template <int Size>
struct ChainResidual {
  using Vector = Eigen::Matrix<double, Size, 1>;
  using Square = Eigen::Matrix<double, Size, Size>;
  Vector error;
  Square weight;            ///< inverse of the covariance; the sample's robust weight is not in it
  Vector by_swept;          ///< the sweeping joint's column of the Jacobian
  double toward = 0;        ///< change of the sweeping joint's turn that fits best, rad
  double toward_sigma = 0;  ///< its standard deviation

  /// Squared distance in standard deviations.
  [[nodiscard]] double squared() const { return error.dot(weight * error); }

  /// The weight, but for an angle that is not used.
  [[nodiscard]] static Square base_weight(const Chain& chain, const ChainObservation& seen,
                                          const ChainNoise& noise, const ChainPose& pose) {
    Vector variance = Vector::Constant(noise.position_mm * noise.position_mm);
    if constexpr (Size == 6)
      variance.template tail<3>().setConstant(noise.orientation_rad * noise.orientation_rad);
    Square weight = variance.cwiseInverse().asDiagonal();
    for (std::size_t k = 0; k < chain.axes.size(); ++k) {
      const double sigma = k == seen.joint ? noise.swept_rad[k] : noise.locked_rad;
      if (sigma > 0 && std::isfinite(sigma))
        discount(weight, pose.by_turn[k].template head<Size>(), 1 / (sigma * sigma));
    }
    return weight;
  }

  /// `base` is the sample's base weight; `free`: the sweeping joint's angle is not used.
  void set(const Chain& chain, const ChainObservation& seen, const ChainPose& pose,
           const Square& base, bool free) {
    error.template head<3>() = seen.position_mm - pose.position_mm - chain.drift_mm * seen.times;
    if (seen.before_move && chain.move.size() > 0)
      error.template head<3>() -=
          chain.by_move(seen.target, pose.position_mm, pose.rotation) * chain.move;
    if constexpr (Size == 6) {
      const Eigen::AngleAxisd off(seen.orientation * (pose.rotation * chain.tool).transpose());
      error.template tail<3>() = off.angle() * off.axis();
    }
    weight = base;
    by_swept = pose.by_turn[seen.joint].template head<Size>();
    const Vector weighted = weight * by_swept;
    const double information = by_swept.dot(weighted);
    toward = information > 0 ? weighted.dot(error) / information : 0;
    toward_sigma = information > 0 ? 1 / std::sqrt(information) : 0;
    if (free) discount(weight, by_swept, 0);
  }

  /// All at once.
  void set(const Chain& chain, const ChainObservation& seen, const ChainPose& pose,
           const ChainNoise& noise) {
    set(chain, seen, pose, base_weight(chain, seen, noise, pose),
        std::isinf(noise.swept_rad[seen.joint]));
  }

 private:
  /// Adds the variance 1/`certainty` along `column` to the covariance (Sherman-Morrison).
  static void discount(Square& weight, const Vector& column, double certainty) {
    const Vector weighted = weight * column;
    const double information = column.dot(weighted) + certainty;
    if (information > 0) weight.noalias() -= weighted * (weighted.transpose() / information);
  }
};

}  // namespace identify
