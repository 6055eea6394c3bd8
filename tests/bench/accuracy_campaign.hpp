#pragma once

// Sweeps of a simulated arm as the accuracy benchmark needs them, with every source of error on its
// own, and the Cramér-Rao bound that belongs to them.

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Dense>

#include "identify/angle.hpp"
#include "identify/chain.hpp"
#include "identify/dh_extraction.hpp"
#include "identify/identification.hpp"

namespace accuracy {

using identify::kArcsec;
using identify::kDegree;
struct Range {
  double start_deg;
  double end_deg;
};

/// How positions and angles are measured.
struct Regime {
  double wobble_deg = 0;   ///< of every joint, sigma, known through the angles
  double step = 0;         ///< unit of the last decimal of mm and degrees; 0: exact
  double position_mm = 0;  ///< of a measuring device, isotropic
  double correlation = 0;  ///< of its errors, AR(1)
  bool angles = true;      ///< in the telegram
  double outlier_share = 0;
  double outlier_mm = 5;
  std::optional<std::size_t> sagging;  ///< joint whose angle is off
  double sag_arcsec = 0;
  double sag_periods = 1;  ///< a turn
};

/// How far a joint's angle is off.
inline double sag_at(const Regime& regime, std::size_t joint, double angle_rad) {
  if (joint != regime.sagging) return 0;
  return regime.sag_arcsec * kArcsec * std::sin(regime.sag_periods * angle_rad + 0.7);
}

struct Simulated {
  identify::Arm arm;
  std::vector<Range> ranges;
  std::vector<Eigen::Vector3d> targets_mm;  ///< in the frame after the last row
  int samples = 400;                        ///< a sweep
};

/// The arm as a chain at home, along positive rotation, in the arm's base.
inline identify::Chain chain_of(const Simulated& robot) {
  identify::Chain chain;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (std::size_t j = 0; j < robot.arm.rows.size(); ++j) {
    chain.axes.push_back(
        {robot.arm.positive[j] * Eigen::Vector3d(frame.linear().col(2)), frame.translation()});
    frame = frame * identify::transform(robot.arm.rows[j]);
  }
  for (const auto& target : robot.targets_mm) chain.targets_mm.push_back(frame * target);
  return chain;
}

inline double rounded(double value, double step) {
  return step > 0 ? step * std::round(value / step) : value;
}

/// One sweep of each joint, for each target, the others at home.
inline std::vector<identify::Sweep> sweeps_of(const Simulated& robot, const Regime& regime,
                                              std::uint32_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<> normal;
  std::uniform_real_distribution<> uniform;
  const std::size_t joints = robot.arm.joints();
  const identify::Chain chain = chain_of(robot);
  std::vector<identify::Sweep> sweeps;
  double time = 0;
  for (std::size_t j = 0; j < joints; ++j) {
    for (std::size_t t = 0; t < robot.targets_mm.size(); ++t) {
      std::vector<identify::Sample> samples;
      Eigen::Vector3d error = Eigen::Vector3d::Zero();
      for (int i = 0; i < robot.samples; ++i) {
        const double share = static_cast<double>(i) / (robot.samples - 1);
        identify::Turns turns{};
        for (std::size_t k = 0; k < joints; ++k)
          turns[k] = regime.wobble_deg * kDegree * normal(random);
        turns[j] += (robot.ranges[j].start_deg +
                     share * (robot.ranges[j].end_deg - robot.ranges[j].start_deg)) *
                        kDegree -
                    robot.arm.home_rad[j];
        identify::Sample sample;
        sample.time_s = time += 0.004;
        sample.has_position = true;
        Eigen::Vector3d fresh;
        for (Eigen::Index k = 0; k < 3; ++k) fresh(k) = normal(random);
        const double old = i == 0 ? 0 : regime.correlation;
        error = old * error + std::sqrt(1 - old * old) * fresh;
        sample.position_mm = chain.target_mm(t, turns) + regime.position_mm * error;
        if (uniform(random) < regime.outlier_share) {
          Eigen::Vector3d way(normal(random), normal(random), normal(random));
          sample.position_mm += regime.outlier_mm * way.normalized();
        }
        for (Eigen::Index k = 0; k < 3; ++k)
          sample.position_mm(k) = rounded(sample.position_mm(k), regime.step);
        if (regime.angles) {
          sample.joints = static_cast<std::uint8_t>(joints);
          for (std::size_t k = 0; k < joints; ++k) {
            double angle = robot.arm.home_rad[k] + turns[k];
            angle += sag_at(regime, k, angle);
            sample.angles_rad[k] = rounded(angle / kDegree, regime.step) * kDegree;
          }
        }
        samples.push_back(sample);
      }
      identify::Sweep sweep;
      sweep.samples = std::make_shared<const std::vector<identify::Sample>>(std::move(samples));
      sweep.joint = j;
      sweep.target = t;
      sweep.direction = robot.ranges[j].end_deg > robot.ranges[j].start_deg ? 1 : -1;
      sweep.range_rad = std::abs(robot.ranges[j].end_deg - robot.ranges[j].start_deg) * kDegree;
      sweeps.push_back(sweep);
    }
  }
  return sweeps;
}

inline identify::Campaign campaign_of(const Simulated& robot, const Regime& regime) {
  identify::Campaign campaign;
  campaign.joints = robot.arm.joints();
  campaign.specified = robot.arm;
  campaign.resolution = {regime.step, regime.step * kDegree};
  campaign.declared_home_rad = robot.arm.home_rad;
  return campaign;
}

/// The DH table with the standard deviations that no unbiased estimator gets below: from the Fisher
/// information of the true model by numerical differences, apart from the estimator's own code.
/// `believed`: whether the sweeping joint's angle is data.
inline std::vector<identify::DhEstimate> bound(const Simulated& robot, const Regime& regime,
                                               bool believed) {
  using Eigen::Index;
  const identify::Chain chain = chain_of(robot);
  const std::size_t joints = chain.axes.size();
  const identify::ChainParameters parameters{joints, chain.targets_mm.size()};
  const Index count = parameters.count(false);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(count, count);
  const double quantum = regime.step / std::sqrt(12.0);
  const double position = std::hypot(regime.position_mm, quantum);
  for (std::size_t j = 0; j < joints; ++j)
    for (std::size_t t = 0; t < chain.targets_mm.size(); ++t)
      for (int i = 0; i < robot.samples; ++i) {
        const double share = static_cast<double>(i) / (robot.samples - 1);
        identify::Turns turns{};
        turns[j] = (robot.ranges[j].start_deg +
                    share * (robot.ranges[j].end_deg - robot.ranges[j].start_deg)) *
                       kDegree -
                   robot.arm.home_rad[j];
        Eigen::MatrixXd jacobian(3, count);
        for (Index p = 0; p < count; ++p) {
          Eigen::VectorXd change = Eigen::VectorXd::Zero(count);
          change(p) = p < parameters.target(0) && p % 4 < 2 ? 1e-6 : 1e-3;
          jacobian.col(p) = (moved(chain, change).target_mm(t, turns) -
                             moved(chain, -change).target_mm(t, turns)) /
                            (2 * change(p));
        }
        Eigen::Matrix3d covariance = position * position * Eigen::Matrix3d::Identity();
        Eigen::Vector3d along = Eigen::Vector3d::Zero();
        for (std::size_t k = 0; k < joints; ++k) {
          identify::Turns above = turns, below = turns;
          above[k] += 1e-6;
          below[k] -= 1e-6;
          const Eigen::Vector3d column =
              (chain.target_mm(t, above) - chain.target_mm(t, below)) / 2e-6;
          if (k == j) along = column;
          const double angle = regime.angles ? quantum * kDegree : 0;
          if (k != j || believed) covariance += angle * angle * column * column.transpose();
        }
        Eigen::Matrix3d weight = covariance.inverse();
        if (!believed)
          weight -= weight * along * along.transpose() * weight / (along.dot(weight * along));
        information += jacobian.transpose() * weight * jacobian;
      }
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::MatrixXd covariance = scale.asDiagonal() *
                                     scaled.completeOrthogonalDecomposition().pseudoInverse() *
                                     scale.asDiagonal();
  std::vector<std::optional<identify::Axis>> z;
  Eigen::MatrixXd to_axes = Eigen::MatrixXd::Zero(static_cast<Index>(6 * joints), count);
  for (std::size_t j = 0; j < joints; ++j) {
    const auto basis = identify::across(chain.axes[j].direction);
    const auto row = static_cast<Index>(6 * j);
    to_axes.block<3, 2>(row, parameters.axis(j)) = robot.arm.positive[j] * basis;
    to_axes.block<3, 2>(row + 3, parameters.axis(j) + 2) = basis;
    z.push_back(
        identify::Axis{robot.arm.positive[j] * chain.axes[j].direction, chain.axes[j].point_mm});
  }
  const Eigen::MatrixXd of_axes = to_axes * covariance * to_axes.transpose();
  for (std::size_t j = 0; j < joints; ++j) {
    const auto row = static_cast<Index>(6 * j);
    z[j]->covariance = of_axes.block<6, 6>(row, row);
  }
  return extract_dh(z, 2000, robot.arm.rows, of_axes);
}

}  // namespace accuracy
