#include "identify/poses/arm_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/median.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kMostSteps = 40;
/// So many poses are enough to start from.
constexpr std::size_t kEnough = 200;
/// Steps below this are of rounding: mm, and rad times a metre.
constexpr double kLastStep_mm = 1e-7;
/// Lengths and angles count alike: a radian moves what is a metre away by a metre.
constexpr double kReach_mm = 1000;
/// Eigenvalues of the scaled normal matrix below this carry no information.
constexpr double kNothing = 1e-12;

bool parallel(const DhRow& row) {
  return std::abs(std::sin(row.alpha_rad)) < std::sin(1 * kDegree);
}

/// The numbers that are free, in the order of the columns.
struct Numbers {
  std::size_t joints;
  std::size_t targets;
  Freedom freedom;
  Index count() const {
    const auto n = static_cast<Index>(joints);
    const Index rows = freedom == Freedom::frames    ? 0
                       : freedom == Freedom::zeros   ? n
                       : freedom == Freedom::lengths ? 3 * n
                                                     : 5 * n;
    return 6 + static_cast<Index>(3 * targets) + rows;
  }
  Index target(std::size_t t) const { return 6 + static_cast<Index>(3 * t); }
  Index zero(std::size_t j) const { return target(targets) + static_cast<Index>(j); }
  Index length(std::size_t j) const { return zero(joints) + static_cast<Index>(2 * j); }
  Index twist(std::size_t j) const { return length(joints) + static_cast<Index>(2 * j); }
};

/// Where a pose's position is, and how it changes with each number: a number of a row moves all
/// that is farther out by a rotation or a translation there.
Vector3d position(const PlacedArm& placed, const Pose& pose, const Numbers& numbers,
                  MatrixXd* columns) {
  const Arm& arm = placed.arm;
  const Vector3d position = placed.position_mm(pose.target, pose.sample);
  if (columns == nullptr) return position;
  columns->setZero(3, numbers.count());
  const auto turns = [&](Index column, const Vector3d& axis, const Vector3d& point) {
    columns->col(column) = axis.cross(position - point) / kReach_mm;
  };
  for (Index k = 0; k < 3; ++k) {
    columns->col(k) = Vector3d::Unit(k);
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
        columns->col(numbers.zero(j)) = z;
      else
        turns(numbers.zero(j), z, at);
    }
    if (numbers.freedom >= Freedom::lengths) {
      if (!parallel(row)) columns->col(numbers.length(j)) = z;
      columns->col(numbers.length(j) + 1) = x;
    }
    if (numbers.freedom >= Freedom::twists) {
      turns(numbers.twist(j), x, frame.translation());
      if (parallel(row)) turns(numbers.twist(j) + 1, y, frame.translation());
    }
  }
  columns->middleCols<3>(numbers.target(pose.target)) = frame.linear();
  return position;
}

PlacedArm moved(const PlacedArm& placed, const Numbers& numbers, const VectorXd& by) {
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
      row.b_mm += by(numbers.length(j));
      row.a_mm += by(numbers.length(j) + 1);
    }
    if (numbers.freedom >= Freedom::twists) {
      row.alpha_rad += by(numbers.twist(j)) / kReach_mm;
      row.beta_rad += by(numbers.twist(j) + 1) / kReach_mm;
    }
  }
  return other;
}

/// The shortest solution of N x = g.
VectorXd least(const MatrixXd& normal, const VectorXd& gradient) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(normal);
  const double largest = solver.eigenvalues()(normal.rows() - 1);
  VectorXd along = solver.eigenvectors().transpose() * gradient;
  for (Index i = 0; i < along.size(); ++i)
    along(i) =
        solver.eigenvalues()(i) > kNothing * largest ? along(i) / solver.eigenvalues()(i) : 0;
  return solver.eigenvectors() * along;
}

double cost(const PlacedArm& arm, const std::vector<Pose>& poses, const VectorXd& weights) {
  return weights.dot(distances_mm(arm, poses).cwiseAbs2());
}

/// The rotation and shift that take `from` to `to` best (Kabsch, Acta Cryst. A32, 1976).
Isometry3d registered(const Matrix3Xd& from, const Matrix3Xd& to) {
  return Isometry3d(Eigen::umeyama(from, to, false));
}

/// One over one and the squared distance in units of the middle one's (Cauchy's loss).
VectorXd soft_weights(const VectorXd& distances) {
  const double size = std::max(middle_of(distances), 1e-9);
  return (1 + (distances / (2 * size)).array().square()).inverse();
}

}  // namespace

Vector3d PlacedArm::position_mm(std::size_t target, const Sample& sample) const {
  Isometry3d frame = base;
  for (std::size_t j = 0; j < arm.joints(); ++j)
    frame = frame * transform(arm.row_at(j, sample.angles_rad[j]));
  return frame * targets_mm[target];
}

Chain PlacedArm::chain() const {
  Chain chain;
  Isometry3d frame = base;
  for (std::size_t j = 0; j < arm.joints(); ++j) {
    chain.axes.push_back(
        {arm.positive[j] * frame.linear().col(2), frame.translation(), arm.is_linear(j)});
    frame = frame * transform(arm.rows[j]);
  }
  for (const Vector3d& target : targets_mm) chain.targets_mm.push_back(frame * target);
  chain.tool = frame.linear();
  return chain;
}

VectorXd distances_mm(const PlacedArm& arm, const std::vector<Pose>& poses) {
  VectorXd distances(static_cast<Index>(poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i)
    distances(static_cast<Index>(i)) =
        (poses[i].sample.position_mm - arm.position_mm(poses[i].target, poses[i].sample)).norm();
  return distances;
}

double middle_of(const VectorXd& distances) {
  return median_of({distances.begin(), distances.end()});
}

PlacedArm fitted(const PlacedArm& start, Freedom freedom, const std::vector<Pose>& poses,
                 const VectorXd& weights) {
  const Numbers numbers{start.arm.joints(), start.targets_mm.size(), freedom};
  PlacedArm best = start;
  double least_cost = cost(best, poses, weights);
  double damping = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    MatrixXd normal = MatrixXd::Zero(numbers.count(), numbers.count());
    VectorXd gradient = VectorXd::Zero(numbers.count());
    MatrixXd columns;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const double weight = weights(static_cast<Index>(i));
      if (weight == 0) continue;
      const Vector3d off =
          poses[i].sample.position_mm - position(best, poses[i], numbers, &columns);
      normal.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose(), weight);
      gradient += weight * (columns.transpose() * off);
    }
    MatrixXd damped = normal.selfadjointView<Eigen::Lower>();
    damped.diagonal() += damping * damped.diagonal();
    const VectorXd by = least(damped, gradient);
    const PlacedArm next = moved(best, numbers, by);
    const double next_cost = cost(next, poses, weights);
    if (next_cost <= least_cost) {
      best = next;
      least_cost = next_cost;
      damping = damping > 1e-6 ? damping / 10 : 0;
    } else {
      damping = std::max(1e-4, 10 * damping);
      if (damping > 1e6) break;
    }
    if (by.cwiseAbs().maxCoeff() < kLastStep_mm) break;
  }
  return best;
}

PlacedArm placed_robustly(const Arm& arm, Freedom freedom, const std::vector<Pose>& all,
                          std::size_t targets) {
  std::vector<Pose> poses;  // spread over those of each target
  std::vector<std::size_t> passed(targets);
  for (const Pose& pose : all)
    if (passed[pose.target]++ % (all.size() / kEnough + 1) == 0) poses.push_back(pose);
  const auto count = static_cast<Index>(poses.size());
  PlacedArm placed{arm, Isometry3d::Identity(), std::vector<Vector3d>(targets, arm.tool_mm)};
  Matrix3Xd told(3, count), seen(3, count);
  for (Index i = 0; i < count; ++i) {
    const Pose& pose = poses[static_cast<std::size_t>(i)];
    told.col(i) = placed.position_mm(pose.target, pose.sample);
    seen.col(i) = pose.sample.position_mm;
  }
  placed.base = registered(told, seen);
  constexpr int kRounds = 6;
  for (std::size_t level = 0; level <= static_cast<std::size_t>(freedom); ++level)
    for (int round = 0; round < kRounds; ++round)
      placed = fitted(placed, static_cast<Freedom>(level), poses,
                      soft_weights(distances_mm(placed, poses)));
  return placed;
}

}  // namespace identify
