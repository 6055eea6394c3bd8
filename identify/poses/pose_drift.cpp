#include "identify/poses/pose_drift.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "identify/geometry/symmetric_eigen.hpp"
#include "identify/poses/drift_spread.hpp"

namespace identify {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Directions that a half tells by less than this share of what all tell are rounding.
constexpr double kLeastShare = 1e-6;
/// Of the normal distribution: above it is one of a thousand.
constexpr double kOneOfAThousand = 3.090;

/// What chi squared exceeds once in a thousand times (Wilson & Hilferty, PNAS 17, 1931).
double limit_of(int degrees) {
  const double share = 2.0 / (9.0 * degrees);
  return degrees * std::pow(1 - share + kOneOfAThousand * std::sqrt(share), 3);
}

struct Half {
  MatrixXd information;
  VectorXd score;
};

Half half_of(const PoseFit& fit, std::size_t from, std::size_t to) {
  const Index count = fit.covariance.rows();
  Half half{MatrixXd::Zero(count, count), VectorXd::Zero(count)};
  for (Stand stand : fit.stands) {
    std::erase_if(stand, [&](std::size_t pose) { return pose < from || pose >= to; });
    const StandRows rows(fit.noise, fit.rows, fit.weights, stand);
    if (rows.poses.empty()) continue;
    half.information(rows.parameters, rows.parameters) +=
        rows.columns * rows.columns.transpose() / fit.widened;
    half.score(rows.parameters) += rows.columns * rows.off / fit.widened;
  }
  return half;
}

/// How the halves differ: M^-1 g, in the model's fixed parameters, and a root of its covariance
/// where nothing drifts, which is M^-1.
struct Parted {
  double chi_squared = 0;
  int numbers = 0;
  VectorXd change;
  MatrixXd root;
};

Parted parted(const PoseFit& fit) {
  const std::size_t poses = fit.rows.size();
  const Half first = half_of(fit, 0, poses / 2), second = half_of(fit, poses / 2, poses);
  // In units of what all poses tell, so that no number outweighs another.
  VectorXd scale = (first.information + second.information)
                       .diagonal()
                       .cwiseMax(1e-300)
                       .cwiseSqrt()
                       .cwiseInverse();
  const MatrixXd one = scale.asDiagonal() * first.information * scale.asDiagonal();
  const VectorXd unit = scale.cwiseInverse();
  const MatrixXd all = unit.asDiagonal() * fit.covariance * unit.asDiagonal();
  // What gears and places are off does not drift.
  const Index fixed = fit.model.fixed_parameters();
  scale.conservativeResize(fixed);
  const MatrixXd middle = (one - one * all * one).topLeftCorner(fixed, fixed);
  const MatrixXd symmetric = 0.5 * (middle + middle.transpose());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solved(symmetric);
  const VectorXd g =
      solved.eigenvectors().transpose() * scale.cwiseProduct(first.score.head(fixed));
  VectorXd inverse = VectorXd::Zero(g.size());
  Parted parted;
  for (Index k = 0; k < g.size(); ++k) {
    if (solved.eigenvalues()(k) < kLeastShare) continue;
    inverse(k) = 1 / solved.eigenvalues()(k);
    parted.chi_squared += g(k) * g(k) * inverse(k);
    ++parted.numbers;
  }
  parted.root = scale.asDiagonal() * solved.eigenvectors() * inverse.cwiseSqrt().asDiagonal();
  parted.change = parted.root * inverse.cwiseSqrt().cwiseProduct(g);
  return parted;
}

}  // namespace

PoseDrift drift_of(const PoseFit& fit) {
  PoseDrift drift;
  const std::size_t poses = fit.rows.size();
  if (poses < 2) return drift;
  const Parted halves = parted(fit);
  drift.chi_squared = halves.chi_squared;
  drift.numbers = halves.numbers;
  const Index half_rows = static_cast<Index>(poses / 2) * fit.rows.front().off.size();
  if (drift.numbers == 0 || half_rows < Index{2} * drift.numbers) return drift;
  double square = 0, by_noise = 0;
  for (const PoseRow& row : fit.rows) {
    const auto columns = row.by_parameter.topLeftCorner(3, halves.change.size());
    square += (columns * halves.change).squaredNorm();
    by_noise += (columns * halves.root).squaredNorm();
  }
  drift.moved_mm = std::sqrt(std::max(0.0, square - by_noise) / static_cast<double>(poses));
  drift.seen = drift.chi_squared > limit_of(drift.numbers) && drift.moved_mm > 0;
  return drift;
}

MatrixXd drift_spread(const PoseFit& fit) {
  const VectorXd half = parted(fit).change / 2;
  return half * half.transpose();
}

}  // namespace identify
