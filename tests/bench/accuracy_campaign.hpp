#pragma once

// Campaigns of one sweep a joint and target, and the Cramér-Rao bound that belongs to them.

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Dense>

#include "identify/chain/chain.hpp"
#include "identify/dh/dh_extraction.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"
#include "tests/simulation/simulation.hpp"

namespace accuracy {

using identify::kDegree;

struct Range {
  double start_deg;
  double end_deg;
};

/// An arm and how far each joint is swept: by the controller's angles, the others at home.
struct Simulated {
  identify::Arm arm;
  std::vector<Range> ranges;
  std::vector<Eigen::Vector3d> targets_mm;  ///< in the frame after the last row
  int samples = 400;                        ///< a sweep
};

inline simulation::Robot robot_of(const Simulated& robot) {
  simulation::Robot made;
  made.specified = made.arm = robot.arm;
  made.targets_mm = robot.targets_mm;
  return made;
}

/// The first joint's sweep takes 4 ms a sample, the others' are as fast.
inline simulation::Simulation simulation_of(const Simulated& robot, const simulation::World& world,
                                            std::uint32_t seed) {
  simulation::Strokes strokes;
  strokes.samples = robot.samples;
  for (std::size_t j = 0; j < robot.ranges.size(); ++j) {
    const double home = robot.arm.home_rad[j] / kDegree;
    strokes.ranges_deg.push_back(
        {robot.ranges[j].start_deg - home, robot.ranges[j].end_deg - home});
  }
  strokes.speed_deg_s =
      std::abs(robot.ranges[0].end_deg - robot.ranges[0].start_deg) / (0.004 * (robot.samples - 1));
  return {robot_of(robot), strokes, world, seed};
}

inline std::vector<identify::Sweep> sweeps_of(const Simulated& robot,
                                              const simulation::World& world, std::uint32_t seed) {
  return simulation_of(robot, world, seed).sweeps();
}

inline identify::Campaign campaign_of(const Simulated& robot, const simulation::World& world) {
  return simulation_of(robot, world, 1).campaign();
}

/// A controller whose joints wobble and whose positions come from their encoders.
inline simulation::World controller(int decimals = 4) {
  simulation::World world;
  world.controller = true;
  world.angles = true;
  world.wobble_deg = 0.0005;
  world.decimals = decimals;
  return world;
}

/// A device that knows no angles.
inline simulation::World tracker(double position_mm = 0.02) {
  simulation::World world;
  world.noise.range_mm = world.noise.across_mm = position_mm;
  return world;
}

/// The DH table with the standard deviations that no unbiased estimator gets below: from the Fisher
/// information of the true model by numerical differences, apart from the estimator's own code.
/// `believed`: whether the sweeping joint's angle is data.
inline std::vector<identify::DhEstimate> bound(const Simulated& robot,
                                               const simulation::World& world, bool believed) {
  using Eigen::Index;
  const identify::Chain chain = chain_of(robot_of(robot));
  const std::size_t joints = chain.axes.size();
  const identify::ChainParameters parameters{joints, chain.targets_mm.size()};
  const Index count = parameters.count(false);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(count, count);
  const identify::Resolution steps = campaign_of(robot, world).resolution;
  const double quantum = steps.angle_rad / std::sqrt(12.0);
  const double position = std::hypot(world.noise.across_mm, steps.position_mm / std::sqrt(12.0));
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
          if (k != j || believed) covariance += quantum * quantum * column * column.transpose();
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
