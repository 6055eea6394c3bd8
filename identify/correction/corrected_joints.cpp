#include "identify/correction/corrected_joints.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "identify/geometry/symmetric_eigen.hpp"
#include "identify/poses/pose_rows.hpp"

namespace identify {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

namespace {

constexpr int kMostCorrections = 20;
/// Steps below this are of rounding, rad.
constexpr double kLastCorrection_rad = 1e-12;
/// Farther off than this, nothing is reached.
constexpr double kReached_mm = 1e-6;
constexpr double kReached_rad = 1e-9;
/// No arm is built as far off; a step this large leads elsewhere.
constexpr double kMostStep_rad = 0.2;

Isometry3d frame_at(const PlacedArm& arm, const std::vector<double>& angles_rad) {
  return arm.base * forward_kinematics(arm.arm, angles_rad);
}

}  // namespace

CorrectedJoints::CorrectedJoints(const PoseFit& identified, const PlacedArm& controller,
                                 const Isometry3d& tool)
    : fit_(identified), controller_(controller), tool_(tool) {
  PoseModel& model = fit_.model;
  const Vector3d point = tool.translation();
  std::size_t nearest = 0;
  for (std::size_t t = 1; t < controller.targets_mm.size(); ++t)
    if ((controller.targets_mm[t] - point).norm() < (controller.targets_mm[nearest] - point).norm())
      nearest = t;
  from_target_mm_ = (controller.targets_mm[nearest] - point).norm();
  // The last frame at home, as specified but for the last axis, which is the identified one.
  const std::size_t last = controller.arm.joints() - 1;
  std::vector<double> before = model.home_rad;
  const Isometry3d frame = frame_at(controller, before);
  Isometry3d on_axis = controller.base;
  for (std::size_t j = 0; j < last; ++j)
    on_axis = on_axis * transform(controller.arm.row_at(j, before[j]));
  const Vector3d axis = controller.arm.positive[last] * on_axis.linear().col(2);
  const Vector3d& identified_axis = model.chain.axes[last].direction;
  const Vector3d across = axis.cross(identified_axis);
  const Eigen::AngleAxisd turn(std::atan2(across.norm(), axis.dot(identified_axis)),
                               across.stableNormalized());
  const Eigen::Matrix3d rotation = turn * frame.linear();
  const Vector3d target = model.chain.targets_mm[nearest];
  // Target 0 is the tool from now on, with the covariance of the measured one.
  const ChainParameters parameters = model.chain_parameters();
  const Index from = parameters.target(nearest), to = parameters.target(0);
  MatrixXd swap = MatrixXd::Identity(fit_.covariance.rows(), fit_.covariance.cols());
  if (from != to) swap.middleRows<3>(to) = swap.middleRows<3>(from).eval();
  fit_.covariance = swap * fit_.covariance * swap.transpose();
  model.chain.targets_mm[0] = target + rotation * (point - controller.targets_mm[nearest]);
  model.chain.tool = rotation * tool.linear();
}

Pose CorrectedJoints::pose_at(const std::vector<double>& angles_rad) const {
  Pose pose;
  pose.sample.joints = static_cast<std::uint8_t>(angles_rad.size());
  std::copy(angles_rad.begin(), angles_rad.end(), pose.sample.angles_rad.begin());
  return pose;
}

Isometry3d CorrectedJoints::believed(const std::vector<double>& angles_rad) const {
  return frame_at(controller_, angles_rad) * tool_;
}

Isometry3d CorrectedJoints::identified(const std::vector<double>& angles_rad) const {
  const PoseModel& model = fit_.model;
  const Isometry3d moved =
      model.chain.displacement(model.turned(model.told(pose_at(angles_rad).sample)));
  Isometry3d tool;
  tool.linear() = moved.linear() * model.chain.tool;
  tool.translation() = moved * model.chain.targets_mm[0];
  return tool;
}

CorrectedJoints::Reached CorrectedJoints::reach(const std::vector<double>& angles_rad) const {
  const Isometry3d wanted = believed(angles_rad);
  Reached reached;
  reached.angles_rad = angles_rad;
  const auto joints = static_cast<Index>(angles_rad.size());
  ChainPose at(fit_.model.chain);
  Eigen::Matrix<double, 6, 1> off;
  for (int step = 0; step < kMostCorrections; ++step) {
    const Isometry3d now = identified(reached.angles_rad);
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(wanted.linear() * now.linear().transpose()));
    off << wanted.translation() - now.translation(), turn.angle() * turn.axis();
    at.set(0, fit_.model.turned(fit_.model.told(pose_at(reached.angles_rad).sample)), false);
    MatrixXd by_joint(6, joints);
    for (Index j = 0; j < joints; ++j) by_joint.col(j) = at.by_turn[static_cast<std::size_t>(j)];
    const Eigen::VectorXd by = least_norm(by_joint, off);
    if (!by.allFinite() || by.cwiseAbs().maxCoeff() > kMostStep_rad) return reached;
    for (Index j = 0; j < joints; ++j) reached.angles_rad[static_cast<std::size_t>(j)] += by(j);
    if (by.cwiseAbs().maxCoeff() < kLastCorrection_rad) break;
  }
  reached.converged = off.head<3>().norm() < kReached_mm && off.tail<3>().norm() < kReached_rad;
  const PoseRow row = pose_row(fit_.model, pose_at(reached.angles_rad), false);
  const Eigen::Matrix3d covariance =
      row.by_parameter * fit_.covariance * row.by_parameter.transpose() +
      fit_.noise.covariance(row.by_joint);
  reached.expected_mm = std::sqrt(covariance.trace());
  return reached;
}

}  // namespace identify
