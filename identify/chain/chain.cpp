#include "identify/chain/chain.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "identify/geometry/angle.hpp"

namespace identify {

using Eigen::Matrix3d;
using Eigen::Vector3d;

DriftTimes drift_times(double when) {
  DriftTimes times;
  times(0) = when;
  for (Eigen::Index k = 1; k < kDriftParts; ++k)
    times(k) = std::sin(static_cast<double>(k) * kPi * (1 + when) / 2);
  return times;
}

DriftTimes drift_of_walk() {
  DriftTimes sizes;
  sizes(0) = 1;
  for (Eigen::Index k = 1; k < kDriftParts; ++k)
    sizes(k) = 2 * std::sqrt(2) / (static_cast<double>(k) * kPi);
  return sizes;
}

Eigen::Isometry3d ChainAxis::displacement(double turn) const {
  if (linear) return Eigen::Isometry3d(Eigen::Translation3d(kLinear_mm * turn * direction));
  const Eigen::Translation3d center(point_mm);
  return center * Eigen::AngleAxisd(turn, direction) * center.inverse();
}

Eigen::Isometry3d Chain::displacement(const Turns& turns) const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (std::size_t j = 0; j < axes.size(); ++j)
    if (turns[j] != 0) pose = pose * axes[j].displacement(turns[j]);
  return pose;
}

Eigen::Matrix3Xd Chain::by_move(std::size_t target, const Vector3d& position_mm,
                                const Matrix3d& rotation) const {
  Eigen::Matrix3Xd by = Eigen::Matrix3Xd::Zero(3, move_numbers());
  by.leftCols<3>().setIdentity();
  for (Eigen::Index k = 0; k < 3; ++k)
    by.col(3 + k) = Vector3d::Unit(k).cross(position_mm - targets_mm.front());
  by.middleCols<3>(6 + 3 * static_cast<Eigen::Index>(target)) = rotation;
  return by;
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

Eigen::VectorXd change_between(const Chain& from, const Chain& to) {
  const ChainParameters parameters{from.axes.size(), from.targets_mm.size()};
  Eigen::VectorXd change = Eigen::VectorXd::Zero(parameters.count(true));
  for (std::size_t j = 0; j < from.axes.size(); ++j) {
    const ChainAxis &one = from.axes[j], &other = to.axes[j];
    const auto basis = across(one.direction);
    change.segment<2>(parameters.axis(j)) = basis.transpose() * (other.direction - one.direction);
    if (one.linear) continue;
    const Vector3d apart = other.point_mm - one.point_mm;
    const double along = apart.dot(one.direction) / other.direction.dot(one.direction);
    change.segment<2>(parameters.axis(j) + 2) =
        basis.transpose() * (apart - along * other.direction);  // where it passes this one's point
  }
  for (std::size_t t = 0; t < from.targets_mm.size(); ++t)
    change.segment<3>(parameters.target(t)) = to.targets_mm[t] - from.targets_mm[t];
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(to.tool * from.tool.transpose()));
  change.segment<3>(parameters.tool()) = turn.angle() * turn.axis();
  return change;
}

namespace {

struct SineOfTurn {
  double sine;
  double versine;  ///< 1 - cos, without cancellation

  explicit SineOfTurn(double angle) {
    // Most joints stand nearly still: a series, right to the last bit.
    constexpr double kSmall = 0.01;
    const double square = angle * angle;
    if (square < kSmall * kSmall) {
      sine = angle * (1 - square / 6 * (1 - square / 20 * (1 - square / 42)));
      versine = square / 2 * (1 - square / 12 * (1 - square / 30));
    } else {
      const double half = std::sin(angle / 2);
      sine = 2 * half * std::cos(angle / 2);
      versine = 2 * half * half;
    }
  }
};

/// A target's distance from the joint's axis, at most.
double farthest_mm(const Chain& chain, std::size_t joint) {
  const ChainAxis& axis = chain.axes[joint];
  double farthest = 0;
  for (const Eigen::Vector3d& target : chain.targets_mm)
    farthest = std::max(farthest, (target - axis.point_mm).cross(axis.direction).norm());
  return farthest;
}

}  // namespace

ChainPose::ChainPose(const Chain& chain)
    : by_parameter(6, ChainParameters{chain.axes.size(), chain.targets_mm.size()}.count(true)),
      chain_(&chain) {
  for (std::size_t j = 0; j < chain.axes.size(); ++j) across_[j] = across(chain.axes[j].direction);
}

void ChainPose::set(std::size_t target, const Turns& turns, bool with_parameters) {
  const std::size_t joints = chain_->axes.size();
  const ChainParameters parameters{joints, chain_->targets_mm.size()};
  // Axes as the joints before them carry them; their own rotation leaves them in place.
  std::array<Vector3d, kMostJoints> direction;
  std::array<Vector3d, kMostJoints> point;
  Matrix3d turned = Matrix3d::Identity();
  Vector3d shift = Vector3d::Zero();
  bool carried = false;
  for (std::size_t j = 0; j < joints; ++j) {
    const ChainAxis& axis = chain_->axes[j];
    direction[j] = axis.direction;
    point[j] = axis.point_mm;
    if (carried) {
      direction[j] = turned * axis.direction;
      point[j] = turned * axis.point_mm + shift;
    }
    if (turns[j] == 0) continue;
    carried = true;
    if (axis.linear) {
      const double way = kLinear_mm * turns[j];
      if (with_parameters) {
        auto columns = by_parameter.middleCols<4>(parameters.axis(j));
        columns.setZero();
        columns.topLeftCorner<3, 2>() = way * (turned * across_[j]);
      }
      shift += way * direction[j];
      continue;
    }
    const SineOfTurn turn(turns[j]);
    const Vector3d first = turned * across_[j].col(0);
    const Vector3d second = direction[j].cross(first);
    // How far the rotation moves the two: e - R e.
    const Vector3d first_back = turn.versine * first - turn.sine * second;
    const Vector3d second_back = turn.versine * second + turn.sine * first;
    if (with_parameters) {
      // d exp(q [n]) for n + e with e across n is the rotation sin(q) e + (1 - cos q) n x e; moving
      // the axis by e moves what it turns by e - R e. What the first does to the position, below.
      auto columns = by_parameter.middleCols<4>(parameters.axis(j));
      columns.col(0).tail<3>() = turn.sine * first + turn.versine * second;
      columns.col(1).tail<3>() = turn.sine * second - turn.versine * first;
      columns.col(2).head<3>() = first_back;
      columns.col(3).head<3>() = second_back;
      columns.bottomRightCorner<3, 2>().setZero();
    }
    turned.noalias() -= first_back * across_[j].col(0).transpose();
    turned.noalias() -= second_back * across_[j].col(1).transpose();
    shift += across_[j].col(0).dot(axis.point_mm) * first_back +
             across_[j].col(1).dot(axis.point_mm) * second_back;
  }
  rotation = turned;
  position_mm = turned * chain_->targets_mm[target] + shift;
  for (std::size_t j = 0; j < joints; ++j) {
    if (chain_->axes[j].linear) {
      by_turn[j] << kLinear_mm * direction[j], Vector3d::Zero();
      continue;
    }
    by_turn[j].head<3>() = direction[j].cross(position_mm - point[j]);
    by_turn[j].tail<3>() = direction[j];
  }
  if (!with_parameters) return;

  for (std::size_t j = 0; j < joints; ++j) {
    auto columns = by_parameter.middleCols<4>(parameters.axis(j));
    if (turns[j] == 0) {
      columns.setZero();
      continue;
    }
    if (chain_->axes[j].linear) continue;
    const Vector3d arm = position_mm - point[j];
    for (Eigen::Index k = 0; k < 2; ++k)
      columns.col(k).head<3>() = columns.col(k).tail<3>().cross(arm);
  }
  auto at_target = by_parameter.middleCols<3>(parameters.target(target));
  at_target.topRows<3>() = rotation;
  at_target.bottomRows<3>().setZero();
  auto at_tool = by_parameter.middleCols<3>(parameters.tool());
  at_tool.topRows<3>().setZero();
  at_tool.bottomRows<3>() = rotation;
}

std::optional<std::size_t> first_turning(const Chain& chain) {
  for (std::size_t j = 0; j < chain.axes.size(); ++j)
    if (!chain.axes[j].linear) return j;
  return std::nullopt;
}

double reach_mm(const Chain& chain, const std::vector<bool>& known) {
  double reach = 1;
  for (std::size_t j = 0; j < chain.axes.size(); ++j)
    if (known[j]) reach = std::max(reach, farthest_mm(chain, j));
  return reach;
}

double lever_mm(const Chain& chain, std::size_t joint) {
  return chain.axes[joint].linear ? kLinear_mm : farthest_mm(chain, joint);
}

double most_move_mm(const Chain& chain, const std::vector<bool>& known) {
  constexpr double kMost_mm = 0.5, kMost_rad = 0.02 * kDegree;
  return std::max(kMost_mm, kMost_rad * reach_mm(chain, known));
}

}  // namespace identify
