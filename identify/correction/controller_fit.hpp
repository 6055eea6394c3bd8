#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "identify/poses/arm_fit.hpp"
#include "identify/poses/pose_estimate.hpp"

namespace identify {

/// What of a controller is to be corrected, each with those before it.
enum class ControllerLevel {
  frames,        ///< base and tool
  mastering,     ///< where joints have their zeros
  machine_data,  ///< and lengths and twists, as far as the controller's structure has them
};

/// A number of the specified table that a level lets go, with what the poses tell of it.
struct ControllerNumber {
  enum class Kind { zero, b, a, alpha };
  enum class Verdict {
    significant,      ///< it is changed, by more than it is uncertain by
    not_significant,  ///< it may be right as it is; it is left
    inseparable,      ///< the poses do not tell it from base, tool or another number; it is left
  };
  Kind kind = Kind::zero;
  std::size_t joint = 0;
  Verdict verdict = Verdict::inseparable;
  /// To be added to the row's number: mm, rad; a zero of a linear joint mm. Zeros are theta, b.
  double change = 0;
  /// With all numbers let go, and as far as leaving others has moved this one.
  double sigma = 0;
  /// That poses of an arm whose number is right ask for as much, for all numbers together (Holm,
  /// Scand. J. Statist. 6, 1979).
  double chance = 1;

  [[nodiscard]] bool taken() const { return verdict == Verdict::significant; }
};

/// The specified arm with what its controller can take over, fitted to poses.
struct ControllerFit {
  PlacedArm arm;
  std::vector<ControllerNumber> numbers;  ///< none: base and tool alone
  Left left;                              ///< of the poses that count
  /// Of the base (mm, then rad about the base's origin, in the measurement frame) and the targets
  /// (mm). What is left counts as noise, though the most of it is what the level cannot hold;
  /// numbers that are left count as for `ControllerNumber::sigma`.
  Eigen::MatrixXd frames_covariance;
  /// Of the same numbers: whether the poses tell it from others.
  std::vector<bool> frames_determined;
};

/// Numbers are significant where the chance that any of them is right as it is is below this.
inline constexpr double kSignificant = 0.05;

/// What poses that a model has are uncertain by, all together.
struct ModelUncertainty {
  Eigen::MatrixXd by_parameter;  ///< how the poses change with the model's, three rows a pose
  Eigen::MatrixXd covariance;    ///< of the parameters
};

/// Of a table's numbers those are let go that keep the structure which closed inverse kinematics
/// need: lengths and joint offsets that are not zero, twists that are no multiple of a right angle.
/// `start`: the specified arm where it stands about; weights: one a pose, 0 where it does not
/// count; their sum counts as that many poses. `model`: of poses that
/// were measured there is none.
[[nodiscard]] ControllerFit fitted_controller(const PlacedArm& start, ControllerLevel level,
                                              const std::vector<Pose>& poses,
                                              const Eigen::VectorXd& weights,
                                              const ModelUncertainty& model = {});

}  // namespace identify
