#include "identify/poses/arm_fit.hpp"

#include <algorithm>
#include <numeric>

#include "identify/geometry/median.hpp"
#include "identify/geometry/symmetric_eigen.hpp"
#include "identify/poses/arm_columns.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kMostFitSteps = 40;
/// So many poses are enough to start from.
constexpr std::size_t kEnough = 200;
/// Steps below this are of rounding: mm, and rad times a metre.
constexpr double kLastStep_mm = 1e-7;
/// Eigenvalues of the scaled normal matrix below this carry no information: the noise alone would
/// lead ten thousand times as far along them as along others, into valleys without an end.
constexpr double kNothing = 1e-8;

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

Isometry3d registered(const Matrix3Xd& from, const Matrix3Xd& to) {
  return Isometry3d(Eigen::umeyama(from, to, false));
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
  const ArmNumbers numbers{start.arm.joints(), start.targets_mm.size(), freedom};
  std::vector<Index> all(static_cast<std::size_t>(numbers.count()));
  std::iota(all.begin(), all.end(), Index{0});
  return fitted(start, numbers, all, poses, weights);
}

PlacedArm fitted(const PlacedArm& start, const ArmNumbers& numbers, const std::vector<Index>& free,
                 const std::vector<Pose>& poses, const VectorXd& weights) {
  const auto count = static_cast<Index>(free.size());
  PlacedArm best = start;
  double least_cost = cost(best, poses, weights);
  double damping = 0;
  for (int step = 0; step < kMostFitSteps; ++step) {
    MatrixXd normal = MatrixXd::Zero(count, count);
    VectorXd gradient = VectorXd::Zero(count);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const double weight = weights(static_cast<Index>(i));
      if (weight == 0) continue;
      const MatrixXd columns = arm_columns(best, poses[i], numbers)(Eigen::all, free);
      const Vector3d off =
          poses[i].sample.position_mm - best.position_mm(poses[i].target, poses[i].sample);
      normal.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose(), weight);
      gradient += weight * (columns.transpose() * off);
    }
    MatrixXd damped = normal.selfadjointView<Eigen::Lower>();
    damped.diagonal() += damping * damped.diagonal();
    VectorXd by = VectorXd::Zero(numbers.count());
    by(free) = least(damped, gradient);
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
