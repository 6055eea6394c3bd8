#include "identify/poses/pose_outlook.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "identify/chain/chain_fit.hpp"
#include "identify/chain/chain_table.hpp"
#include "identify/geometry/information.hpp"
#include "identify/geometry/symmetric_eigen.hpp"
#include "identify/poses/arm_fit.hpp"
#include "identify/poses/observability.hpp"
#include "identify/poses/pose_estimate.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;

ChainParameters forecast_parameters(const PoseModel& model) {
  return {model.chain.axes.size(), model.chain.targets_mm.size()};
}

}  // namespace

std::size_t fewest_poses(std::size_t joints) {
  const ChainParameters parameters{joints, 1};
  return static_cast<std::size_t>(parameters.count(false) + kSpareRows + 2) / 3;
}

PoseForecast::PoseForecast(const Campaign& campaign, const PoseNoise& noise)
    : campaign_(campaign), noise_(noise) {
  const Arm& arm = *campaign.specified;
  model_.chain = PlacedArm{arm, Eigen::Isometry3d::Identity(), {arm.tool_mm}}.chain();
  model_.chain.up = campaign.up;
  model_.home_rad = arm.home_rad;
}

PoseRow PoseForecast::row(const std::vector<double>& angles_rad) const {
  Pose pose;
  std::copy(angles_rad.begin(), angles_rad.end(), pose.sample.angles_rad.begin());
  pose.sample.joints = static_cast<std::uint8_t>(angles_rad.size());
  pose.sample.position_mm = model_.position_mm(pose);
  PoseRow row = pose_row(model_, pose, false);
  row.by_parameter.conservativeResize(Eigen::NoChange, forecast_parameters(model_).count(false));
  return row;
}

MatrixXd PoseForecast::candidate(const PoseRow& row) const {
  MatrixXd columns = row.by_parameter;
  const ChainParameters parameters = forecast_parameters(model_);
  for (std::size_t j = 0; j < parameters.joints; ++j)
    columns.middleCols<2>(parameters.axis(j)) /= kMetre_mm;
  return noise_.covariance(row.by_own).llt().matrixL().solve(columns);
}

PoseOutlook PoseForecast::outlook(const std::vector<PoseRow>& poses,
                                  const std::vector<PoseRow>& workspace) const {
  const Index count = forecast_parameters(model_).count(false);
  MatrixXd normal = MatrixXd::Zero(count, count);
  for (const PoseRow& row : poses)
    normal +=
        row.by_parameter.transpose() * noise_.covariance(row.by_own).llt().solve(row.by_parameter);
  const Information information(normal);
  const MatrixXd open = information.open();
  ChainFit fit;
  fit.chain = model_.chain;
  fit.covariance = information.covariance() + open * open.transpose();

  PoseOutlook found;
  for (const PoseRow& row : workspace)
    found.displacement_mm =
        std::max(found.displacement_mm,
                 largest_sigma(row.by_parameter * fit.covariance * row.by_parameter.transpose()));
  ChainEstimate expected;
  set_fitted_axes(expected, fit, std::vector<bool>(campaign_.joints, true), 1);
  std::vector<DhRow> specified = campaign_.specified->rows;
  place_linear_axes(expected, campaign_, specified);
  found.axes = expected.axes;
  found.dh = device_table_of(table_axes(expected, campaign_), campaign_.joints, specified);
  return found;
}

PoseOutlook mean(const std::vector<PoseOutlook>& outlooks) {
  PoseOutlook mean = outlooks.front();
  const auto count = static_cast<double>(outlooks.size());
  for (std::size_t j = 0; j < mean.dh.size(); ++j)
    for (const DhNumberName& of : kDhNumbers) {
      double variance = 0;
      for (const PoseOutlook& one : outlooks) {
        const DhNumber& seen = one.dh[j].*of.number;
        variance += seen.sigma * seen.sigma;
        if (seen.knowledge == Knowledge::undetermined)
          (mean.dh[j].*of.number).knowledge = Knowledge::undetermined;
      }
      (mean.dh[j].*of.number).sigma = std::sqrt(variance / count);
    }
  double square = 0;
  for (const PoseOutlook& one : outlooks) square += one.displacement_mm * one.displacement_mm;
  mean.displacement_mm = std::sqrt(square / count);
  return mean;
}

}  // namespace identify
