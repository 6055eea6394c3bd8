#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "identify/chain/chain.hpp"
#include "identify/dh/dh_extraction.hpp"
#include "identify/models/kinematic_model.hpp"

namespace identify {

/// An identified arm, from which models are made.
struct ModelSource {
  Chain chain;                ///< with a target; axes along positive rotation
  std::vector<int> positive;  ///< one a joint: +1 where the table's Z is along that, -1 against it
  /// Of the table's Z axes, as `extract_dh` gives it.
  std::vector<DhEstimate> dh;
  /// Of the axes' (direction, point), six rows a joint, then three a target, then, if it is known,
  /// three of the tool's rotation in the measurement frame. May be empty.
  Eigen::MatrixXd covariance;
  std::vector<std::optional<double>> home_rad;  ///< one a joint; unknown: angles count from home
  bool target_identified = true;  ///< where the first target is at home; false: its place is any
  bool tool_identified = false;   ///< the orientation of `chain.tool` was measured
};

/// The arm in every form of `kModelForms`, in that order; empty where a number of the table is
/// undetermined or one of a model not finite, or there is no target. Each reproduces the first
/// target and the tool's orientation as the chain moves them, whatever the relations of the axes
/// are called.
///
/// The numbers of the DH table are taken as they are. The others get standard uncertainties to
/// first order from `covariance`, with relations and senses of common normals held. By convention
/// are those that the data do not determine, as in the table: along parallel axes, about coincident
/// ones, about an axis that the target lies on, the orientation of a tool that was not measured,
/// and one of two angles of `urdf` where pitch is within 0.06 degrees of a right angle.
[[nodiscard]] std::vector<KinematicModel> kinematic_models(const ModelSource& source);

}  // namespace identify
