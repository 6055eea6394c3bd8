#pragma once

// Outcomes as the chain estimator leaves them, made by hand: a KR 5 arc a little off its table, in
// the frame of a measuring device.

#include "daemon/results/outcome.hpp"
#include "daemon/text/units.hpp"
#include "tests/identify/simulated_campaign.hpp"

namespace sweepd::test {

inline constexpr double kDirectionSigma_rad = 2e-5;
inline constexpr double kPointSigma_mm = 0.01;

inline Outcome chain_outcome() {
  const identify::Arm arm = identify::test::kr5_arc();
  Outcome outcome;
  outcome.robot = "kr5-arc";
  outcome.positive = arm.positive;
  auto& found = outcome.identification;
  found.status = identify::Status::complete;
  found.estimator = identify::Estimator::chain;
  found.specified = arm.rows;
  found.joints.resize(6);
  auto& estimate = found.chain.emplace();
  Eigen::Isometry3d frame = Eigen::Translation3d(1200, -700, 300) *
                            Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized());
  std::vector<std::optional<identify::Axis>> z;
  for (std::size_t j = 0; j < 6; ++j) {
    estimate.chain.axes.push_back({-frame.linear().col(2), frame.translation()});
    identify::Axis axis{frame.linear().col(2), frame.translation()};
    const Eigen::Matrix3d across =
        Eigen::Matrix3d::Identity() - axis.direction * axis.direction.transpose();
    axis.covariance.topLeftCorner<3, 3>() = kDirectionSigma_rad * kDirectionSigma_rad * across;
    axis.covariance.bottomRightCorner<3, 3>() = kPointSigma_mm * kPointSigma_mm * across;
    z.emplace_back(axis);
    estimate.axes.emplace_back(axis.reversed());
    found.joints[j].axis = axis.reversed();
    identify::DhRow row = arm.rows[j];
    row.b_mm += 0.03 * static_cast<double>(j);
    row.a_mm -= 0.02;
    row.theta_rad += 1e-4;
    row.alpha_rad -= 5e-5;
    frame = frame * identify::transform(row);
    found.home_rad.emplace_back(arm.home_rad[j]);
  }
  estimate.chain.targets_mm = {frame * arm.tool_mm};
  estimate.covariance = Eigen::MatrixXd::Zero(39, 39);
  for (Eigen::Index j = 0; j < 6; ++j)
    estimate.covariance.block<6, 6>(6 * j, 6 * j) =
        estimate.axes[static_cast<std::size_t>(j)]->covariance;
  estimate.covariance.bottomRightCorner<3, 3>() = 1e-4 * Eigen::Matrix3d::Identity();
  estimate.dh = identify::extract_dh(z, 1500, arm.rows);
  estimate.summary.converged = true;
  found.dh = estimate.dh;
  return outcome;
}

/// Turns from home, all joints anywhere.
inline identify::Turns random_turns(std::mt19937& random) {
  std::uniform_real_distribution<> angle(-kPi, kPi);
  identify::Turns turns{};
  for (double& turn : turns) turn = angle(random);
  return turns;
}

/// How far a pose is from the chain's, mm.
inline double misfit_mm(const Outcome& outcome, const identify::Turns& turns,
                        const Eigen::Isometry3d& pose) {
  const auto& chain = outcome.identification.chain->chain;
  return (pose.translation() - chain.target_mm(0, turns)).norm();
}

/// How far its orientation is, as the norm of the difference of the matrices.
inline double misfit_of_rotation(const Outcome& outcome, const identify::Turns& turns,
                                 const Eigen::Isometry3d& pose) {
  const auto& chain = outcome.identification.chain->chain;
  return (pose.linear() - chain.displacement(turns).linear() * chain.tool).norm();
}

}  // namespace sweepd::test
