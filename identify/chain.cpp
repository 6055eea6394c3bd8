#include "identify/chain.hpp"

#include <cmath>

namespace identify {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Eigen::Isometry3d Chain::displacement(const Turns& turns) const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (std::size_t j = 0; j < axes.size(); ++j) {
    const Eigen::Translation3d center(axes[j].point_mm);
    pose = pose * (center * Eigen::AngleAxisd(turns[j], axes[j].direction) * center.inverse());
  }
  return pose;
}

Eigen::Matrix<double, 3, 2> across(const Vector3d& direction) {
  Eigen::Matrix<double, 3, 2> both;
  both.col(0) = direction.unitOrthogonal();
  both.col(1) = direction.cross(both.col(0));
  return both;
}

Chain moved(const Chain& chain, const Eigen::VectorXd& change) {
  const ChainParameters parameters{chain.axes.size(), chain.targets_mm.size()};
  Chain other = chain;
  for (std::size_t j = 0; j < chain.axes.size(); ++j) {
    const auto basis = across(chain.axes[j].direction);
    const Eigen::Vector4d by = change.segment<4>(parameters.axis(j));
    other.axes[j].direction = (chain.axes[j].direction + basis * by.head<2>()).normalized();
    other.axes[j].point_mm += basis * by.tail<2>();
  }
  for (std::size_t t = 0; t < chain.targets_mm.size(); ++t)
    other.targets_mm[t] += change.segment<3>(parameters.target(t));
  if (change.size() > parameters.tool()) {
    const Vector3d turn = change.segment<3>(parameters.tool());
    const double angle = turn.norm();
    if (angle > 0) other.tool = Eigen::AngleAxisd(angle, turn / angle) * chain.tool;
  }
  return other;
}

void ChainPose::set(const Chain& chain, std::size_t target, const Turns& turns,
                    bool with_parameters) {
  const std::size_t joints = chain.axes.size();
  const ChainParameters parameters{joints, chain.targets_mm.size()};
  // Axes as the joints before them carry them; their own rotation leaves them in place.
  std::array<Vector3d, kMostJoints> direction;
  std::array<Vector3d, kMostJoints> point;
  std::array<Vector3d, kMostJoints> first_across;
  rotation.setIdentity();
  Vector3d shift = Vector3d::Zero();
  for (std::size_t j = 0; j < joints; ++j) {
    const ChainAxis& axis = chain.axes[j];
    direction[j] = rotation * axis.direction;
    point[j] = rotation * axis.point_mm + shift;
    if (with_parameters) first_across[j] = rotation * axis.direction.unitOrthogonal();
    if (turns[j] == 0) continue;
    const Matrix3d turned = rotation * Eigen::AngleAxisd(turns[j], axis.direction).matrix();
    shift = point[j] - turned * axis.point_mm;
    rotation = turned;
  }
  position_mm = rotation * chain.targets_mm[target] + shift;
  for (std::size_t j = 0; j < joints; ++j)
    by_turn[j] << direction[j].cross(position_mm - point[j]), direction[j];
  if (!with_parameters) return;

  by_parameter.resize(6, parameters.count(true));
  for (std::size_t j = 0; j < joints; ++j) {
    auto columns = by_parameter.middleCols<4>(parameters.axis(j));
    if (turns[j] == 0) {
      columns.setZero();
      continue;
    }
    const double sine = std::sin(turns[j]);
    const double versine = 1 - std::cos(turns[j]);
    const Vector3d second_across = direction[j].cross(first_across[j]);
    const Vector3d arm = position_mm - point[j];
    // d exp(q [n]) for n + e with e across n is the rotation sin(q) e + (1 - cos q) n x e; moving
    // the axis by e moves what it turns by e - R e.
    const Vector3d turn_first = sine * first_across[j] + versine * second_across;
    const Vector3d turn_second = sine * second_across - versine * first_across[j];
    columns.col(0) << turn_first.cross(arm), turn_first;
    columns.col(1) << turn_second.cross(arm), turn_second;
    columns.col(2) << versine * first_across[j] - sine * second_across, Vector3d::Zero();
    columns.col(3) << versine * second_across + sine * first_across[j], Vector3d::Zero();
  }
  auto at_target = by_parameter.middleCols<3>(parameters.target(target));
  at_target.topRows<3>() = rotation;
  at_target.bottomRows<3>().setZero();
  auto at_tool = by_parameter.middleCols<3>(parameters.tool());
  at_tool.topRows<3>().setZero();
  at_tool.bottomRows<3>() = rotation;
}

}  // namespace identify
