#include "identify/geometry/symmetric_eigen.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/QR>

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::SelfAdjointEigenSolver;

template class Eigen::SelfAdjointEigenSolver<MatrixXd>;
template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const Eigen::EigenBase<MatrixXd>&, int);
template class Eigen::SelfAdjointEigenSolver<Matrix3d>;
template SelfAdjointEigenSolver<Matrix3d>& SelfAdjointEigenSolver<Matrix3d>::compute(
    const Eigen::EigenBase<Matrix3d>&, int);

namespace identify {

double largest_sigma(const Matrix3d& covariance) {
  if (!covariance.allFinite()) return std::numeric_limits<double>::infinity();
  const SelfAdjointEigenSolver<Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()(2)));
}

MatrixXd least_norm(const MatrixXd& left, const MatrixXd& right) {
  return Eigen::CompleteOrthogonalDecomposition<MatrixXd>(left).solve(right);
}

}  // namespace identify
