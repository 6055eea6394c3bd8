#include "identify/prediction.hpp"

#include <algorithm>
#include <cmath>

#include "identify/chain/chain_fit.hpp"
#include "identify/chain/chain_start.hpp"
#include "identify/chain/chain_table.hpp"
#include "identify/dh/placed_axes.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/geometry/spread.hpp"

namespace identify {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Standard deviation of x - round(x), unit `step`, x Gaussian about a whole number of steps: a
/// locked joint stands at its home, which has no more decimals than are printed. From the Fourier
/// series of the saw tooth.
double rounding_error(double step, double sigma) {
  if (!(step > 0)) return 0;
  double variance = 1.0 / 12;
  for (int k = 1; k <= 100; ++k) {
    const double share = std::exp(-2 * std::pow(kPi * k * sigma / step, 2));
    variance += (k % 2 == 0 ? share : -share) / (kPi * kPi * k * k);
  }
  return step * std::sqrt(std::max(0.0, variance));
}

/// The specified arm as it stands at the rehearsal's home, in its own base, along positive
/// rotation.
Chain specified_chain(const Identification& rehearsed, const Arm& arm) {
  Chain chain;
  Isometry3d frame = Isometry3d::Identity();
  for (std::size_t j = 0; j < arm.joints(); ++j) {
    chain.axes.push_back({arm.positive[j] * Vector3d(frame.linear().col(2)),
                          Vector3d(frame.translation()), arm.is_linear(j)});
    frame = frame * transform(rehearsed.specified[j]);
  }
  chain.targets_mm = {frame * arm.tool_mm};
  chain.tool = frame.linear();
  return chain;
}

/// The covariance of `fit`, whose weights are not quite those of its errors (Huber, 5th Berkeley
/// Symposium, 1967: "sandwich"). The estimator takes printed numbers for independent; but A, B and
/// C are rounded each by itself, which is not alike about all directions, and where one of them
/// follows a single joint it shares that joint's rounding. The errors are the rehearsal's own, at
/// the true chain.
template <int Size>
Eigen::MatrixXd covariance_by_errors(const ChainFit& fit,
                                     const std::vector<ChainObservation>& samples,
                                     const ChainNoise& noise) {
  ChainPose pose(fit.chain);
  ChainResidual<Size> residual;
  const Eigen::Index count =
      ChainParameters{fit.chain.axes.size(), fit.chain.targets_mm.size()}.count(Size == 6);
  const Eigen::MatrixXd covariance = fit.covariance.topLeftCorner(count, count);
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(count, count);
  for (const ChainObservation& sample : samples) {
    pose.set(sample.target, sample.turns, true);
    residual.set(fit.chain, sample, pose, noise);
    const Eigen::VectorXd pull = pose.by_parameter.topLeftCorner(Size, spread.rows()).transpose() *
                                 (residual.weight * residual.error);
    spread.noalias() += pull * pull.transpose();
  }
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(fit.covariance.rows(), fit.covariance.cols());
  all.topLeftCorner(count, count) = covariance * spread * covariance;
  return all;
}

/// What printing leaves out does not average out, as whole strokes are rounded alike: `expected`
/// gets what the rehearsal's own estimate has of it.
void add_print(ChainEstimate& expected, const Identification& rehearsed) {
  if (!rehearsed.chain) return;
  for (const ChainEstimate::Part& part : rehearsed.chain->parts) {
    if (part.cause != Cause::print || part.covariance.rows() != expected.covariance.rows())
      continue;
    expected.covariance += part.covariance;
    for (std::size_t j = 0; j < expected.axes.size(); ++j) {
      const auto row = static_cast<Eigen::Index>(6 * j);
      if (expected.axes[j]) expected.axes[j]->covariance += part.covariance.block<6, 6>(row, row);
    }
  }
}

void predict_from(ChainNodes& nodes, const std::vector<ChainObservation>& samples,
                  const Identification& rehearsed, const Campaign& campaign, const Chain& chain,
                  ChainNoise& noise, Prediction& prediction) {
  const std::size_t joints = campaign.joints;
  std::vector<bool> swept(joints, false);
  for (const StrokeMoments& stroke : nodes.strokes) swept[stroke.content.joint] = true;
  // One joint alone is told by its circle, which uses neither angles nor orientation.
  for (std::size_t j = 0; j < joints; ++j)
    if (!rehearsed.chain || rehearsed.chain->angles[j].trust != AngleTrust::trusted)
      noise.swept_rad[j] = kFreeAngle;
  // Only the turns matter, and those to what the wobble is beside a sweep.
  if (!nodes.with_angles)
    static_cast<void>(starting_targets(chain, nodes.observations, nodes.targets, false));

  ChainEstimate expected;
  expected.with_orientation = rehearsed.chain && rehearsed.chain->with_orientation;
  ChainFit fit = fit_chain(chain, nodes, noise, {}, expected.with_orientation, 0);
  if (nodes.with_angles)
    fit.covariance = expected.with_orientation ? covariance_by_errors<6>(fit, samples, noise)
                                               : covariance_by_errors<3>(fit, samples, noise);
  set_fitted_axes(expected, fit, swept, 1);
  place_linear_axes(expected, campaign, rehearsed.specified);
  add_print(expected, rehearsed);
  const TableAxes axes = table_axes(expected, campaign);
  prediction.axes = expected.axes;
  prediction.dh = campaign.device_frame ? device_table_of(axes, joints, rehearsed.specified)
                                        : table_of(axes, joints, rehearsed.specified);
}

}  // namespace

ChainNoise printed_noise(const Resolution& resolution, double wobble_rad, std::size_t joints) {
  ChainNoise noise;
  noise.position_mm = kEvenlySpread * resolution.position_mm;
  noise.orientation_rad = kEvenlySpread * resolution.angle_rad;
  noise.locked_rad = rounding_error(resolution.angle_rad, wobble_rad);
  noise.swept_rad.assign(joints, kEvenlySpread * resolution.angle_rad);
  return noise;
}

ChainNoise device_noise(double position_mm, double wobble_rad, std::size_t joints) {
  ChainNoise noise;
  noise.position_mm = position_mm;
  noise.locked_rad = wobble_rad;
  noise.swept_rad.assign(joints, kFreeAngle);
  return noise;
}

Prediction predict(const Identification& rehearsed, const Campaign& campaign, ChainNoise noise) {
  const Arm& arm = *campaign.specified;
  const std::size_t joints = arm.joints();
  const Chain chain = specified_chain(rehearsed, arm);
  Prediction prediction;
  prediction.dh.resize(joints);
  prediction.axes.resize(joints);
  for (const ChainAxis& axis : chain.axes)
    prediction.radius_mm.push_back(
        axis.direction.cross(chain.targets_mm.front() - axis.point_mm).norm());
  auto axes = starting_axes(rehearsed);
  for (std::size_t j = 0; j < joints; ++j)
    if (axes[j]) axes[j] = chain.axes[j];
  ChainNodes nodes = chain_nodes(rehearsed, axes, campaign.resolution);
  if (!nodes.strokes.empty())
    predict_from(nodes, chain_samples(rehearsed, axes), rehearsed, campaign, chain, noise,
                 prediction);
  return prediction;
}

Prediction mean(const std::vector<Prediction>& predictions) {
  Prediction mean = predictions.front();
  const auto count = static_cast<double>(predictions.size());
  for (std::size_t j = 0; j < mean.dh.size(); ++j) {
    for (const DhNumberName& of : kDhNumbers) {
      double variance = 0;
      for (const Prediction& one : predictions)
        variance += std::pow((one.dh[j].*of.number).sigma, 2);
      (mean.dh[j].*of.number).sigma = std::sqrt(variance / count);
    }
    if (!mean.axes[j]) continue;
    mean.axes[j]->covariance.setZero();
    for (const Prediction& one : predictions)
      if (one.axes[j]) mean.axes[j]->covariance += one.axes[j]->covariance / count;
  }
  return mean;
}

}  // namespace identify
