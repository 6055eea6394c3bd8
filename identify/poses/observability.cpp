#include "identify/poses/observability.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "identify/geometry/symmetric_eigen.hpp"

namespace identify {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Observability observability_of(const PoseFit& fit) {
  const ChainParameters parameters = fit.model.chain_parameters();
  VectorXd unit = VectorXd::Ones(fit.model.fixed_parameters());  // of a step of about a millimetre
  for (std::size_t j = 0; j < parameters.joints; ++j)
    unit.segment<2>(parameters.axis(j)).setConstant(1 / kMetre_mm);
  unit.tail(unit.size() - parameters.tool()).setConstant(1 / kMetre_mm);
  MatrixXd whole = MatrixXd::Zero(fit.model.parameters(), fit.model.parameters());
  for (const StandRows& stand : fit.counted())
    whole(stand.parameters, stand.parameters) += stand.columns * stand.columns.transpose();
  const MatrixXd normal =
      unit.asDiagonal() * whole.topLeftCorner(unit.size(), unit.size()) * unit.asDiagonal();
  Observability seen;
  double count = 0;
  for (std::size_t i = 0; i < fit.rows.size(); ++i) {
    const double weight = fit.weights(static_cast<Index>(i));
    if (weight == 0) continue;
    const PoseRow& row = fit.rows[i];
    count += weight;
    const Eigen::Matrix3d of =
        row.by_parameter.topRows<3>() * fit.covariance * row.by_parameter.topRows<3>().transpose();
    seen.displacement_mm = std::max(seen.displacement_mm, largest_sigma(of));
  }
  std::vector<Index> there;  // without a tool that was not seen
  for (Index i = 0; i < unit.size(); ++i)
    if (normal(i, i) > 0) there.push_back(i);
  if (there.empty()) return seen;  // no pose counts
  const VectorXd squares =
      Eigen::SelfAdjointEigenSolver<MatrixXd>(MatrixXd(normal(there, there))).eigenvalues();
  const VectorXd values = squares.cwiseMax(0.0).cwiseSqrt();
  seen.largest = values(values.size() - 1);
  seen.smallest = values(0);
  seen.mean = values(0) > 0 ? std::exp(values.array().log().mean()) / std::sqrt(count) : 0;
  return seen;
}

}  // namespace identify
