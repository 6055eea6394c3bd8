#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "identify/chain/chain.hpp"
#include "identify/dh/dh_extraction.hpp"

namespace identify {

/// How a model writes an arm down. Turns are from home; Z_i is the table's axis of joint i; all but
/// `exponentials` and `urdf` turn it by positive * turn, where `positive` is one of its numbers.
/// A linear joint moves along what others turn about: its b (of the S-model its d) grows by
/// kLinear_mm * positive * turn.
enum class ModelForm {
  /// Standard DH, the paper's Table 1: a link is Tz(b) Rz(theta) Tx(a) Rx(alpha) Ry(beta).
  dh,
  /// The same numbers the way Craig and Khalil & Kleinfinger (ICRA 1986) group them: joint i is
  /// Rx(alpha) Tx(a) Ry(beta) Rz(theta) Tz(b) with alpha, a, beta of the link before it.
  modified_dh,
  /// Hayati (CDC 1983): four numbers a link: theta, a, alpha, beta for parallel axes, DH for
  /// others.
  hayati,
  /// Stone's S-model (Kinematic Modeling, Identification, and Control of Robotic Manipulators,
  /// 1987): a link is Rz(beta) Tz(d) Tx(a) Rx(alpha) Rz(gamma) Tz(b), after the joint's Rz(turn).
  /// Frame i has its origin at the foot of the target point (at home) on axis i, and X towards the
  /// target. For axes that are parallel as far as one can tell, where d and b would grow beyond all
  /// bounds, d is zero and Ry(hayati_beta) follows Rx(alpha): seven numbers.
  s_model,
  /// exp of the twist (v, w) times turn, in the measurement frame: w the unit direction along
  /// positive rotation, v = -w x p; then the tool's pose at home. Of a linear joint w is zero and v
  /// the unit direction, times mm.
  exponentials,
  /// A joint's frame in the one before: T(x, y, z) Rz(yaw) Ry(pitch) Rx(roll), then rotation about
  /// axis_z * Z by the controller's angle; `home` is that angle at home. For a linear joint in mm.
  urdf,
};
inline constexpr std::array kModelForms{ModelForm::dh,           ModelForm::modified_dh,
                                        ModelForm::hayati,       ModelForm::s_model,
                                        ModelForm::exponentials, ModelForm::urdf};
[[nodiscard]] std::string_view text(ModelForm form) noexcept;

enum class Quantity { length, angle, ratio };

/// One number of a model: mm, rad, or without unit.
struct ModelNumber {
  std::string_view name;  ///< as in the formulas above
  Quantity quantity = Quantity::length;
  /// `sigma` is zero also where no covariance was given.
  DhNumber number;
};

/// An arm in one form. Group 0 is the base: the first frame in the measurement frame (none for
/// `exponentials` and `urdf`); then one a joint; the last is the tool: a frame at the target point
/// in the frame after the last joint. Base and tool are x, y, z and the rotation matrix r11, r12,
/// ... r33, row by row; x, y, z, roll, pitch, yaw for `urdf`.
struct KinematicModel {
  using Group = std::vector<ModelNumber>;
  ModelForm form = ModelForm::dh;
  std::vector<Group> groups;
  std::vector<bool> linear;  ///< one a joint

  [[nodiscard]] std::size_t joints() const { return groups.size() - 2; }
};

/// Pose of the tool frame in the measurement frame, from the model's numbers alone.
[[nodiscard]] Eigen::Isometry3d forward_kinematics(const KinematicModel& model, const Turns& turns);

/// The same without the tool: where the last joint's frame is.
[[nodiscard]] Eigen::Isometry3d forward_kinematics_without_tool(const KinematicModel& model,
                                                                const Turns& turns);

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
  bool tool_identified = false;                 ///< the orientation of `chain.tool` was measured
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
