#include "identify/geometry/information.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "identify/geometry/symmetric_eigen.hpp"

namespace identify {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Information::Information(const MatrixXd& normal)
    : scale_(normal.rows()), scaled_(normal.selfadjointView<Eigen::Lower>()) {
  for (Index i = 0; i < scale_.size(); ++i)
    scale_(i) = normal(i, i) > 0 ? 1 / std::sqrt(normal(i, i)) : 0;
  scaled_ = scale_.asDiagonal() * scaled_ * scale_.asDiagonal();
  const Eigen::LLT<MatrixXd> root(scaled_);
  if (root.info() != Eigen::Success) return;
  MatrixXd half = MatrixXd::Identity(scaled_.rows(), scaled_.cols());
  root.matrixL().solveInPlace(half);
  MatrixXd inverse = MatrixXd::Zero(scaled_.rows(), scaled_.cols());
  inverse.selfadjointView<Eigen::Lower>().rankUpdate(half.transpose());
  inverse.triangularView<Eigen::StrictlyUpper>() = inverse.transpose();
  // One over the least eigenvalue is no larger than the inverse's norm.
  if (inverse.norm() < 1 / kNoInformation)
    inverse_ = inverse.cwiseProduct(scale_ * scale_.transpose());
}

const Information::Directions& Information::directions() const {
  if (!directions_) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(scaled_);
    directions_ = Directions{solver.eigenvalues(), scale_.asDiagonal() * solver.eigenvectors()};
  }
  return *directions_;
}

VectorXd Information::step(const VectorXd& gradient, double damping) const {
  if (inverse_ && damping == 0) return *inverse_ * gradient;
  const Directions& of = directions();
  VectorXd along = of.vectors.transpose() * gradient;
  for (Index i = 0; i < along.size(); ++i)
    along(i) = of.informed(i) ? along(i) / (of.values(i) + damping) : 0;
  return of.vectors * along;
}

MatrixXd Information::covariance() const {
  if (inverse_) return *inverse_;
  const Directions& of = directions();
  MatrixXd half = of.vectors;
  for (Index i = 0; i < half.cols(); ++i)
    half.col(i) *= of.informed(i) ? 1 / std::sqrt(of.values(i)) : 0;
  MatrixXd whole = MatrixXd::Zero(half.rows(), half.rows());
  whole.selfadjointView<Eigen::Lower>().rankUpdate(half);
  return whole.selfadjointView<Eigen::Lower>();
}

MatrixXd Information::determined() const {
  const Directions& of = directions();
  MatrixXd all(of.vectors.rows(), of.vectors.cols());
  Index count = 0;
  for (Index i = 0; i < of.values.size(); ++i)
    if (of.informed(i)) all.col(count++) = of.vectors.col(i);
  return all.leftCols(count);
}

MatrixXd Information::open() const {
  if (inverse_) return MatrixXd(scale_.size(), 0);
  constexpr double kRounding = 1e-14;
  const Directions& of = directions();
  MatrixXd all(of.vectors.rows(), of.vectors.cols());
  Index count = 0;
  for (Index i = 0; i < of.values.size(); ++i) {
    double share = 0;  // of the scaled direction
    for (Index k = 0; k < scale_.size(); ++k)
      if (scale_(k) > 0) share += std::pow(of.vectors(k, i) / scale_(k), 2);
    if (!of.informed(i) && share > 0.5)
      all.col(count++) = of.vectors.col(i) / std::sqrt(std::max(of.values(i), kRounding));
  }
  return all.leftCols(count);
}

double Information::condition() const {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(scaled_, Eigen::EigenvaluesOnly);
  const VectorXd& values = solver.eigenvalues();
  const double largest = values(values.size() - 1);
  double smallest = largest;
  for (Index i = values.size() - 1; i >= 0 && values(i) > kNoInformation; --i) smallest = values(i);
  return largest / smallest;
}

double Information::log_determinant() const {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(scaled_, Eigen::EigenvaluesOnly);
  double sum = solver.eigenvalues().cwiseMax(kNoInformation).array().log().sum();
  for (const double scale : scale_)
    if (scale > 0) sum -= 2 * std::log(scale);
  return sum;
}

std::size_t Information::undetermined() const {
  if (inverse_) return 0;
  const Directions& of = directions();
  std::size_t count = 0;
  for (Index i = 0; i < of.values.size(); ++i)
    if (!of.informed(i)) ++count;
  return count - static_cast<std::size_t>((scale_.array() == 0).count());
}

}  // namespace identify
