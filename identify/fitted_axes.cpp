#include "identify/fitted_axes.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

}  // namespace

void set_fitted_axes(ChainEstimate& estimate, const ChainFit& fit, const std::vector<bool>& known,
                     std::size_t targets) {
  const std::size_t joints = known.size();
  estimate.chain = fit.chain;
  const ChainParameters parameters{joints, fit.chain.targets_mm.size()};
  const auto tool = static_cast<Index>(6 * joints + 3 * targets);
  const auto rows = tool + (estimate.with_orientation ? 3 : 0);
  MatrixXd by_parameter = MatrixXd::Zero(rows, fit.covariance.rows());
  estimate.axes.assign(joints, std::nullopt);
  for (std::size_t j = 0; j < joints; ++j) {
    if (!known[j]) continue;
    ChainAxis& axis = estimate.chain.axes[j];
    const auto basis = across(axis.direction);
    const double along = axis.direction.dot(estimate.chain.targets_mm.front() - axis.point_mm);
    const auto row = static_cast<Index>(6 * j);
    by_parameter.block<3, 2>(row, parameters.axis(j)) = basis;
    by_parameter.block<3, 2>(row + 3, parameters.axis(j)) = along * basis;
    by_parameter.block<3, 2>(row + 3, parameters.axis(j) + 2) = basis;
    axis.point_mm += along * axis.direction;
  }
  for (std::size_t t = 0; t < targets; ++t)
    by_parameter.block<3, 3>(static_cast<Index>(6 * joints + 3 * t), parameters.target(t)) =
        Eigen::Matrix3d::Identity();
  if (estimate.with_orientation)
    by_parameter.block<3, 3>(tool, parameters.tool()) = Eigen::Matrix3d::Identity();
  estimate.covariance =
      estimate.samples_per_independent *
      by_parameter.lazyProduct(MatrixXd(fit.covariance.lazyProduct(by_parameter.transpose())));
  estimate.chain.targets_mm.resize(targets);
  for (std::size_t j = 0; j < joints; ++j) {
    if (!known[j]) continue;
    const auto row = static_cast<Index>(6 * j);
    const Axis axis{estimate.chain.axes[j].direction, estimate.chain.axes[j].point_mm,
                    estimate.covariance.block<6, 6>(row, row)};
    const bool finite = axis.direction.allFinite() && axis.point_mm.allFinite();
    if (finite && axis.direction_sigma_rad() < kWorstDirection_rad) estimate.axes[j] = axis;
  }
}

}  // namespace identify
