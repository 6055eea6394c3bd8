#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "identify/chain.hpp"
#include "identify/dh_extraction.hpp"

namespace identify {

/// Standard deviations of what was measured, each sample on its own.
struct ChainNoise {
  double position_mm = 0;         ///< isotropic, each coordinate
  double orientation_rad = 0;     ///< isotropic, about each direction
  double locked_rad = 0;          ///< of the angle of each joint that stands
  std::vector<double> swept_rad;  ///< of a sweeping joint's angle, one a joint
};

/// As the noise of a sweeping joint: its angle is not used.
inline constexpr double kFreeAngle = std::numeric_limits<double>::infinity();

/// How far the angles of a sweeping joint are believed.
enum class AngleTrust {
  trusted,  ///< right to the print quantum: they come from the encoders that gave the positions
  smooth,   ///< off by a smooth curve, which is stated; not used for the geometry
  free,     ///< off without a pattern, or not known at all; not used
};
[[nodiscard]] std::string_view text(AngleTrust trust) noexcept;

/// What decided about a joint's angles. Errors are the controller's angle minus the angle at which
/// the target was seen on the circle.
struct AngleEvidence {
  AngleTrust trust = AngleTrust::free;
  std::string reason;
  std::size_t samples = 0;       ///< with an angle; zero: nothing below means anything
  double error_rms_rad = 0;      ///< of the whole error
  double remainder_rms_rad = 0;  ///< of what the curve below leaves
  double expected_rms_rad = 0;   ///< from position noise and print quantum alone
  double size = 0;       ///< tangential residuals of angles believed, in print quanta's sigma
  double coherence = 0;  ///< their variance along smooth curves, in that of white noise: 1
  double remainder_coherence = 0;  ///< as above, of what the curve leaves, along higher harmonics
  /// The transmission error: e(q) = offset + scale q + c1 (cos q - 1) + s1 sin q + c2 (cos 2q - 1)
  /// + s2 sin 2q with q from home, fitted over the range that was swept and of use only there.
  std::array<double, 6> curve{};
  double backlash_rad = 0;  ///< error of falling strokes minus that of rising ones
  double backlash_sigma_rad = 0;

  [[nodiscard]] double curve_at(double turn_rad) const;
};

/// How the least-squares problem ended.
struct Summary {
  bool converged = false;
  std::string_view ending;       ///< in words
  int iterations = 0;            ///< of Gauss-Newton, all stages
  double cost = 0;               ///< half the weighted sum of squares
  double last_step = 0;          ///< in standard uncertainties, of the parameter that moved most
  double condition = 0;          ///< of the scaled normal matrix
  std::size_t undetermined = 0;  ///< directions in parameter space without information
};

/// What the chain estimator found (see chain_estimator.hpp).
struct ChainEstimate {
  /// All joints of the arm; those without an axis below are never turned.
  Chain chain;
  /// One a joint, along positive rotation. Nothing where the joint could not be used.
  std::vector<std::optional<Axis>> axes;
  /// Of all axes' (direction, point), six rows a joint, then three a target, then,
  /// with orientation, three of the tool's rotation in the measurement frame.
  Eigen::MatrixXd covariance;
  std::vector<DhEstimate> dh;
  ChainNoise noise;
  std::vector<AngleEvidence> angles;  ///< one a joint
  bool with_orientation = false;      ///< A, B, C were present, consistent, and used
  bool shared_home = true;  ///< false: each joint's sweeps passed elsewhere, or none tells
  std::size_t samples = 0;
  std::size_t outliers = 0;            ///< of them: given less than half their weight
  double samples_per_independent = 1;  ///< how many correlated samples are worth one
  Summary summary;
};

}  // namespace identify
