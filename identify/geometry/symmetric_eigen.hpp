#pragma once

#include <Eigen/Eigenvalues>

// Eigenvalues and eigenvectors of symmetric matrices, compiled once in symmetric_eigen.cpp: each
// file that makes them anew takes some two seconds longer. Only for the plain types themselves, so
// give the solver a matrix and no expression.
extern template class Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;
extern template Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>&
Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>::compute(const Eigen::EigenBase<Eigen::MatrixXd>&,
                                                        int);
extern template class Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>;
extern template Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>&
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>::compute(const Eigen::EigenBase<Eigen::Matrix3d>&,
                                                        int);

namespace identify {

/// The standard deviation along the direction that is known worst; infinite where one is not known.
[[nodiscard]] double largest_sigma(const Eigen::Matrix3d& covariance);

/// The X of least norm that fits `left` X = `right` best, whatever the rank of `left`.
[[nodiscard]] Eigen::MatrixXd least_norm(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right);

}  // namespace identify
