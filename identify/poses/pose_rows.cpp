#include "identify/poses/pose_rows.hpp"

#include <cmath>

#include <Eigen/Cholesky>

namespace identify {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd PoseNoise::covariance(const MatrixXd& by_own) const {
  MatrixXd whole = joint_rad * joint_rad * (by_own * by_own.transpose());
  whole.diagonal().head<3>().array() += position_mm * position_mm;
  whole.diagonal().tail(whole.rows() - 3).array() += orientation_rad * orientation_rad;
  return whole;
}

double sigmas_of(const PoseNoise& noise, const PoseRow& row, const VectorXd& left) {
  const double square = left.dot(noise.covariance(row.by_own).llt().solve(left));
  return std::sqrt(3 * square / static_cast<double>(left.size()));
}

PoseRow pose_row(const PoseModel& model, const Pose& pose, bool with_orientation) {
  const Turns told = model.told(pose.sample);
  ChainPose at(model.chain);
  at.set(pose.target, model.turned(told, pose.senses), true);
  const Index rows = with_orientation && pose.sample.has_orientation ? 6 : 3;
  const Index of_chain = model.chain_parameters().count(true);
  PoseRow row;
  row.off.resize(rows);
  row.off.head<3>() = pose.sample.position_mm - at.position_mm;
  if (rows == 6) {
    const Eigen::AngleAxisd turn(
        Matrix3d(orientation(pose.sample) * (at.rotation * model.chain.tool).transpose()));
    row.off.tail<3>() = turn.angle() * turn.axis();
  }
  row.by_joint.resize(rows, static_cast<Index>(model.chain.axes.size()));
  for (Index j = 0; j < row.by_joint.cols(); ++j)
    row.by_joint.col(j) = at.by_turn[static_cast<std::size_t>(j)].head(rows);
  row.by_parameter = MatrixXd::Zero(rows, model.parameters());
  const ChainParameters parameters = model.chain_parameters();
  const Index axes = parameters.target(0);
  row.by_parameter.leftCols(axes) = at.by_parameter.topLeftCorner(rows, axes);
  for (std::size_t j = 0; j < model.still.size(); ++j)
    if (model.still[j]) row.by_parameter.middleCols<4>(parameters.axis(j)).setZero();
  const Index target = parameters.target(pose.target);
  row.by_parameter.middleCols<3>(target) = at.by_parameter.block(0, target, rows, 3);
  row.by_parameter.middleCols<3>(parameters.tool()) =
      at.by_parameter.block(0, parameters.tool(), rows, 3);
  Index column = of_chain;
  const MatrixXd of_effects = effect_columns(model, model.effects, pose, row);
  row.by_parameter.middleCols(column, of_effects.cols()) = of_effects;
  column += of_effects.cols();
  row.by_own = row.by_joint;
  for (Index j = 0; j < row.by_joint.cols(); ++j) {
    const auto joint = static_cast<std::size_t>(j);
    const std::size_t place = model.place_of(joint, told[joint]);
    const bool shared = place < model.places.size();
    if (shared) row.by_parameter.col(column + static_cast<Index>(place)) = row.by_joint.col(j);
    if (shared || model.is_known(told[joint])) row.by_own.col(j).setZero();
  }
  return row;
}

Matrix3d play_covariance(const PoseModel& model, const Pose& pose, const PoseRow& row) {
  Matrix3d covariance = Matrix3d::Zero();
  for (const JointEffect& effect : model.effects) {
    if (effect.kind != JointEffect::Kind::play || pose.senses[effect.joint] != 0) continue;
    const Eigen::Vector3d to_a_side =
        effect.size.x() * row.by_joint.col(static_cast<Index>(effect.joint)).head<3>();
    covariance += to_a_side * to_a_side.transpose();
  }
  return covariance;
}

MatrixXd effect_columns(const PoseModel& model, const std::vector<JointEffect>& effects,
                        const Pose& pose, const PoseRow& row) {
  Index count = 0;
  for (const JointEffect& effect : effects) count += effect.count();
  MatrixXd columns(row.by_joint.rows(), count);
  const auto patterns = model.patterns(effects, model.told(pose.sample), pose.senses);
  Index at = 0;
  for (std::size_t e = 0; e < effects.size(); at += effects[e++].count())
    columns.middleCols(at, effects[e].count()) =
        row.by_joint.col(static_cast<Index>(effects[e].joint)) *
        patterns[e].head(effects[e].count()).transpose();
  return columns;
}

}  // namespace identify
