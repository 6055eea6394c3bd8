#include "identify/change/displacement.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/halton.hpp"
#include "identify/geometry/information.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/geometry/symmetric_eigen.hpp"
#include "identify/models/kinematic_model.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kStarts = 10;
/// Of a joint's range, in its first step and, halved so often, in its last.
constexpr double kFirstStep = 0.2;
constexpr int kHalvings = 6;

double& number_in(std::vector<DhRow>& rows, const ArmNumber& number) {
  DhRow& row = rows[number.joint];
  switch (number.place() % 5) {
    case 0:
      return row.b_mm;
    case 1:
      return row.theta_rad;
    case 2:
      return row.a_mm;
    case 3:
      return row.alpha_rad;
    default:
      return row.beta_rad;
  }
}

/// Of the frame of the last axis, in the first frame.
Isometry3d last_pose(std::vector<DhRow> rows, const std::vector<bool>& linear,
                     const std::vector<double>& turns) {
  Isometry3d pose = Isometry3d::Identity();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (linear[i])
      rows[i].b_mm += kLinear_mm * turns[i];
    else
      rows[i].theta_rad += turns[i];
    pose = pose * transform(rows[i]);
  }
  return pose;
}

/// How a tool moves with the numbers of an arm, and with base and tool.
class ToolMotion {
 public:
  using ByFrames = Eigen::Matrix<double, 3, 9>;  // base: shift, turn in mm at a metre; tool

  ToolMotion(const ComparedArms& arms, const ToolReach& reach)
      : arms_(arms), reach_(reach), tool_(arms.last_frame * reach.tool_mm) {}

  [[nodiscard]] ByFrames by_frames(const std::vector<double>& turns) const {
    constexpr double kRadian_mm = 1000;
    const Isometry3d pose = last_pose(arms_.rows, reach_.linear, turns);
    ByFrames columns;
    columns << Eigen::Matrix3d::Identity(), -cross_matrix(pose * tool_) / kRadian_mm, pose.linear();
    return columns;
  }

  [[nodiscard]] Vector3d position(const std::vector<double>& turns,
                                  const VectorXd& difference) const {
    std::vector<DhRow> rows = arms_.rows;
    for (std::size_t n = 0; n < arms_.numbers.size(); ++n)
      number_in(rows, arms_.numbers[n]) += difference(static_cast<Index>(n));
    return last_pose(rows, reach_.linear, turns) * tool_;
  }

  [[nodiscard]] Eigen::Matrix3Xd by_numbers(const std::vector<double>& turns) const {
    constexpr double kStep_mm = 1e-2, kStep_rad = 1e-5;
    Eigen::Matrix3Xd columns(3, static_cast<Index>(arms_.numbers.size()));
    std::vector<DhRow> rows = arms_.rows;
    for (std::size_t n = 0; n < arms_.numbers.size(); ++n) {
      double& number = number_in(rows, arms_.numbers[n]);
      const double value = number;
      const double step = arms_.numbers[n].length ? kStep_mm : kStep_rad;
      const auto at = [&](double moved) -> Vector3d {
        number = moved;
        return last_pose(rows, reach_.linear, turns) * tool_;
      };
      const Vector3d above = at(value + step);
      columns.col(static_cast<Index>(n)) = (above - at(value - step)) / (2 * step);
      number = value;
    }
    return columns;
  }

 private:
  const ComparedArms& arms_;
  const ToolReach& reach_;
  Vector3d tool_;
};

/// Poses that fill the ranges evenly, the same ones in every call: turns from home.
std::vector<std::vector<double>> poses_in(const ToolReach& reach, std::size_t count) {
  const std::size_t joints = reach.ranges.size();
  std::vector<std::vector<double>> turns(count, std::vector<double>(joints));
  for (std::size_t k = 0; k < count; ++k) {
    const std::vector<double> share = halton_point(k + 1, joints);
    for (std::size_t j = 0; j < joints; ++j) {
      const auto& [least, most] = reach.ranges[j];
      turns[k][j] = least + (most - least) * share[j];
    }
  }
  return turns;
}

/// As sweeps of single joints have them.
std::vector<std::vector<double>> sweeps_in(const ToolReach& reach) {
  constexpr int kAside = 6;
  constexpr double kStep_rad = 7.5 * kDegree;
  const std::size_t joints = reach.ranges.size();
  std::vector<std::vector<double>> turns;
  for (std::size_t j = 0; j < joints; ++j)
    for (int step = -kAside; step <= kAside; ++step) {
      std::vector<double> at(joints, 0.0);
      const auto& [least, most] = reach.ranges[j];
      at[j] = std::clamp(step * kStep_rad, least, most);
      turns.push_back(std::move(at));
    }
  return turns;
}

/// As much of a difference as its covariance makes by chance, along each of its principal axes.
/// Zero where that is far less to second order than what is known best.
VectorXd by_chance(const ComparedArms& arms, const VectorXd& difference) {
  constexpr double kMostSigmas = 3, kRadian_mm = 1000;
  VectorXd scale(difference.size());
  for (std::size_t n = 0; n < arms.numbers.size(); ++n)
    scale(static_cast<Index>(n)) = arms.numbers[n].length ? 1 : kRadian_mm;
  const MatrixXd scaled = scale.asDiagonal() * arms.covariance() * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(scaled);
  const VectorXd most = kMostSigmas * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const VectorXd along = axes.eigenvectors().transpose() * (scale.asDiagonal() * difference);
  const VectorXd likely = along.cwiseMin(most).cwiseMax(-most);
  constexpr double kFarLess = 0.1;
  if (likely.squaredNorm() / (2 * kRadian_mm) < kFarLess * most.minCoeff() / kMostSigmas)
    return 0 * difference;
  return (axes.eigenvectors() * likely).cwiseQuotient(scale);
}

}  // namespace

VectorXd second_order(const ComparedArms& arms, const ToolReach& reach) {
  if (arms.numbers.empty()) return {};
  const ToolMotion motion(arms, reach);
  const VectorXd difference = by_chance(arms, arms.difference);
  VectorXd none = 0 * difference;
  if (difference.isZero(0)) return none;
  const Index count = ToolMotion::ByFrames::ColsAtCompileTime + difference.size();
  MatrixXd normal = MatrixXd::Zero(count, count);
  VectorXd right = VectorXd::Zero(count);
  for (const std::vector<double>& turns : sweeps_in(reach)) {
    Eigen::Matrix3Xd columns(3, count);
    columns << motion.by_frames(turns), motion.by_numbers(turns);
    const Vector3d beyond = motion.position(turns, difference) - motion.position(turns, none) -
                            columns.rightCols(difference.size()) * difference;
    normal += columns.transpose() * columns;
    right += columns.transpose() * beyond;
  }
  return Information(normal).step(right, 0).tail(difference.size());
}

Displacement largest_displacement(const ComparedArms& arms, const VectorXd& difference,
                                  const MatrixXd& covariance, const ToolReach& reach,
                                  std::size_t poses) {
  const std::size_t joints = arms.rows.size();
  const ToolMotion motion(arms, reach);
  std::vector<std::vector<double>> turns = poses_in(reach, poses);
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  MatrixXd mixed = MatrixXd::Zero(9, difference.size());
  for (const std::vector<double>& at : turns) {
    const ToolMotion::ByFrames frames = motion.by_frames(at);
    normal += frames.transpose() * frames;
    mixed += frames.transpose() * motion.by_numbers(at);
  }
  // Where all axes are nearly parallel, a tool that is metres longer seems to take up tenths of a
  // millimetre. Of what moves the tool by less than this share of itself nothing is taken up.
  constexpr double kOwnPart = 0.05;
  normal.diagonal().array() += kOwnPart * kOwnPart * static_cast<double>(turns.size());
  const MatrixXd taken_up = normal.ldlt().solve(mixed);
  const auto left_at = [&](const std::vector<double>& at) -> Eigen::Matrix3Xd {
    return motion.by_numbers(at) - motion.by_frames(at) * taken_up;
  };

  // The best of some poses is not yet the largest: on from the best of them, joint by joint.
  std::vector<std::pair<double, std::vector<double>>> best;
  for (auto& at : turns) {
    const double size = (left_at(at) * difference).norm();
    best.emplace_back(size, std::move(at));
  }
  const auto starts = std::min(kStarts, best.size());
  std::partial_sort(best.begin(), best.begin() + static_cast<std::ptrdiff_t>(starts), best.end(),
                    [](const auto& one, const auto& other) { return one.first > other.first; });
  best.resize(starts);
  for (auto& [largest, turned] : best)
    for (int halved = 0; halved <= kHalvings; ++halved)
      for (std::size_t j = 0; j < joints; ++j)
        for (const int way : {1, -1}) {
          const auto& [least, most] = reach.ranges[j];
          std::vector<double> at = turned;
          const double share = kFirstStep / (1 << halved);
          at[j] = std::clamp(at[j] + way * share * (most - least), least, most);
          const double size = (left_at(at) * difference).norm();
          if (size <= largest) continue;
          largest = size;
          turned = at;
        }
  const auto& [largest, turned] =
      *std::max_element(best.begin(), best.end(),
                        [](const auto& one, const auto& other) { return one.first < other.first; });
  Displacement found{largest, 0, 0, turned};
  const Eigen::Matrix3Xd left = left_at(found.turns_rad);
  const VectorXd along = left.transpose() * (left * difference).stableNormalized();
  const double half = kSigmasOf95Percent * std::sqrt(along.dot(covariance * along));
  found.low_mm = std::max(0.0, found.largest_mm - half);
  found.high_mm = found.largest_mm + half;
  return found;
}

}  // namespace identify
