#include "identify/poses/arm_columns.hpp"

#include <cmath>

#include "identify/geometry/angle.hpp"

namespace identify {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

bool stays_parallel(const DhRow& row) {
  return std::abs(std::sin(row.alpha_rad)) < std::sin(1 * kDegree);
}

}  // namespace

// A number of a row moves all that is farther out by a rotation or a translation there.
MatrixXd arm_columns(const PlacedArm& placed, const Pose& pose, const ArmNumbers& numbers) {
  const Arm& arm = placed.arm;
  const Vector3d position = placed.position_mm(pose.target, pose.sample);
  MatrixXd columns = MatrixXd::Zero(3, numbers.count());
  const auto turns = [&](Index column, const Vector3d& axis, const Vector3d& point) {
    columns.col(column) = axis.cross(position - point) / kReach_mm;
  };
  for (Index k = 0; k < 3; ++k) {
    columns.col(k) = Vector3d::Unit(k);
    turns(3 + k, Vector3d::Unit(k), placed.base.translation());
  }
  Isometry3d frame = placed.base;
  for (std::size_t j = 0; j < arm.joints(); ++j) {
    const DhRow row = arm.row_at(j, pose.sample.angles_rad[j]);
    const Vector3d z = frame.linear().col(2);
    const Vector3d at = frame.translation();
    frame = frame * transform({row.b_mm, row.theta_rad, 0, 0, 0});
    const Vector3d x = frame.linear().col(0);
    frame = frame * transform({0, 0, row.a_mm, row.alpha_rad, 0});
    const Vector3d y = frame.linear().col(1);
    frame = frame * transform({0, 0, 0, 0, row.beta_rad});
    if (numbers.freedom >= Freedom::zeros) {
      if (arm.is_linear(j))
        columns.col(numbers.zero(j)) = z;
      else
        turns(numbers.zero(j), z, at);
    }
    if (numbers.freedom >= Freedom::lengths) {
      if (!stays_parallel(row)) columns.col(numbers.b(j)) = z;
      columns.col(numbers.a(j)) = x;
    }
    if (numbers.freedom >= Freedom::twists) {
      turns(numbers.alpha(j), x, frame.translation());
      if (stays_parallel(row)) turns(numbers.beta(j), y, frame.translation());
    }
  }
  columns.middleCols<3>(numbers.target(pose.target)) = frame.linear();
  return columns;
}

PlacedArm moved(const PlacedArm& placed, const ArmNumbers& numbers, const VectorXd& by) {
  PlacedArm other = placed;
  const Vector3d turn = by.segment<3>(3) / kReach_mm;
  if (turn.norm() > 0)
    other.base.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * placed.base.linear();
  other.base.translation() += by.head<3>();
  for (std::size_t t = 0; t < numbers.targets; ++t)
    other.targets_mm[t] += by.segment<3>(numbers.target(t));
  for (std::size_t j = 0; j < numbers.joints; ++j) {
    DhRow& row = other.arm.rows[j];
    if (numbers.freedom >= Freedom::zeros) {
      const double zero = by(numbers.zero(j));
      (placed.arm.is_linear(j) ? row.b_mm += zero : row.theta_rad += zero / kReach_mm);
    }
    if (numbers.freedom >= Freedom::lengths) {
      row.b_mm += by(numbers.b(j));
      row.a_mm += by(numbers.a(j));
    }
    if (numbers.freedom >= Freedom::twists) {
      row.alpha_rad += by(numbers.alpha(j)) / kReach_mm;
      row.beta_rad += by(numbers.beta(j)) / kReach_mm;
    }
  }
  return other;
}

}  // namespace identify
