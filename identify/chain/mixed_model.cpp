#include "identify/chain/mixed_model.hpp"

#include <cmath>

#include <Eigen/Cholesky>

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Takes the first columns, effects with these variances, out of the products; what is left is of
/// the others. In units of their own standard deviations, so that a variance may be zero.
MatrixXd without_effects(const MatrixXd& products, const VectorXd& variances,
                         double& log_determinant) {
  const Index effects = variances.size();
  const Index rest = products.rows() - effects;
  if (effects == 0) return products;
  const VectorXd sigma = variances.cwiseSqrt();
  MatrixXd inner =
      sigma.asDiagonal() * products.topLeftCorner(effects, effects) * sigma.asDiagonal();
  inner.diagonal().array() += 1;
  const Eigen::LLT<MatrixXd> solver(inner);
  const MatrixXd side =
      solver.matrixL().solve(MatrixXd(sigma.asDiagonal() * products.topRightCorner(effects, rest)));
  log_determinant += 2 * solver.matrixLLT().diagonal().array().log().sum();
  MatrixXd left = products.bottomRightCorner(rest, rest);
  left.noalias() -= side.transpose() * side;
  return left;
}

/// Adds to `sum`, whose columns are (first ones, all parameters, y), products whose columns are
/// (the same first ones, these parameters, y).
void add(MatrixXd& sum, Index first, Index parameters, const MatrixXd& products,
         const std::vector<Index>& which) {
  const Index size = first + parameters + 1;
  if (sum.size() == 0) sum = MatrixXd::Zero(size, size);
  std::vector<Index> place;
  for (Index k = 0; k < first; ++k) place.push_back(k);
  for (const Index parameter : which) place.push_back(first + parameter);
  place.push_back(size - 1);
  for (Index c = 0; c < products.cols(); ++c)
    for (Index r = 0; r < products.rows(); ++r)
      sum(place[static_cast<std::size_t>(r)], place[static_cast<std::size_t>(c)]) += products(r, c);
}

}  // namespace

Eliminated eliminate(const std::vector<StrokeProducts>& strokes,
                     const std::vector<std::size_t>& home_of, const EffectVariances& variances,
                     Index parameters) {
  Eliminated all;
  std::vector<MatrixXd> groups(variances.shared.size());
  std::vector<MatrixXd> homes(variances.home.size());
  MatrixXd whole = MatrixXd::Zero(parameters + 1, parameters + 1);
  for (std::size_t s = 0; s < strokes.size(); ++s) {
    const std::size_t group = strokes[s].group;
    add(groups[group], variances.shared[group].size() + variances.home[home_of[group]].size(),
        parameters, without_effects(strokes[s].products, variances.own[s], all.log_determinant),
        strokes[s].parameters);
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (groups[g].size() == 0) continue;
    MatrixXd& home = homes[home_of[g]];
    const MatrixXd left = without_effects(groups[g], variances.shared[g], all.log_determinant);
    home = home.size() == 0 ? left : MatrixXd(home + left);
  }
  for (std::size_t h = 0; h < homes.size(); ++h)
    if (homes[h].size() > 0)
      whole += without_effects(homes[h], variances.home[h], all.log_determinant);
  all.normal = whole.topLeftCorner(parameters, parameters);
  all.gradient = whole.topRightCorner(parameters, 1);
  all.squares = whole(parameters, parameters);
  return all;
}

}  // namespace identify
