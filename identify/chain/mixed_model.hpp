#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace identify {

/// One stroke's share in the normal equations: the weighted sums of products of all columns that it
/// knows, C^T W C with C = (own, shared, home's, parameters, y). Random effects are nested: a
/// stroke belongs to one group, whose strokes share effects, and a group to one home, likewise.
struct StrokeProducts {
  Eigen::MatrixXd products;              ///< square, symmetric
  std::size_t group = 0;                 ///< one stroke after the other, in any order
  std::vector<Eigen::Index> parameters;  ///< which of all parameters its columns are
};

/// Variances of the random effects, in the order of the columns; an effect of size 0 does nothing.
struct EffectVariances {
  std::vector<Eigen::VectorXd> own;     ///< one a stroke
  std::vector<Eigen::VectorXd> shared;  ///< one a group
  std::vector<Eigen::VectorXd> home;    ///< one a home
};

/// The mixed model y = X b + Z u + e, u ~ N(0, D) with D diagonal and known, e weighed: the normal
/// equations of b with u eliminated (Henderson 1975, Biometrics 31, eq. 3), which are those of
/// generalised least squares with the covariance V = Z D Z^T + W^-1.
struct Eliminated {
  Eigen::MatrixXd normal;      ///< of the parameters
  Eigen::VectorXd gradient;    ///< its right side
  double squares = 0;          ///< y^T V^-1 y, before b is fitted
  double log_determinant = 0;  ///< of V, but for that of the weights: log |I + D Z^T W Z|
};
/// `home_of`: of each group.
[[nodiscard]] Eliminated eliminate(const std::vector<StrokeProducts>& strokes,
                                   const std::vector<std::size_t>& home_of,
                                   const EffectVariances& variances, Eigen::Index parameters);

}  // namespace identify
