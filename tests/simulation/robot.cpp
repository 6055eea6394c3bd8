#include "tests/simulation/robot.hpp"

#include <cmath>
#include <random>
#include <utility>

#include "identify/geometry/angle.hpp"
#include "tests/identify/linear_robots.hpp"
#include "tests/identify/simulated_campaign.hpp"
#include "tests/simulation/stream.hpp"

namespace simulation {
namespace {

using Eigen::Vector3d;
using identify::kDegree;

double distance_mm(const identify::ChainAxis& axis, const Vector3d& point) {
  return axis.direction.cross(point - axis.point_mm).norm();
}

}  // namespace

Robot kr5(std::size_t targets) {
  Robot robot;
  robot.arm = robot.specified = identify::test::kr5_arc();
  robot.targets_mm = {robot.arm.tool_mm, {-160, 130, 150}, {-90, -190, 260}};
  robot.targets_mm.resize(targets);
  robot.links = {{30, {-90, 0, 0}}, {20, {-300, 0, 0}}, {25, {0, 0, 150}},
                 {4, {0, 0, 0}},    {3, {0, 0, 50}},    {6, {0, 0, 120}}};
  robot.elastic = {1, 2};
  return robot;
}

Robot iiwa(std::size_t targets) {
  Robot robot;
  const auto row = [&](double b, double alpha_deg) {
    robot.arm.rows.push_back({b, 0, 0, alpha_deg * kDegree});
  };
  row(360, -90);
  row(0, 90);
  row(420, 90);
  row(0, -90);
  row(400, -90);
  row(0, 90);
  row(126, 0);
  robot.arm.positive.assign(7, 1);
  robot.arm.home_rad.assign(7, 0.0);
  robot.arm.tool_mm = {180, 60, 130};
  robot.specified = robot.arm;
  robot.targets_mm = {robot.arm.tool_mm, {-140, 130, 90}, {-60, -170, 200}};
  robot.targets_mm.resize(targets);
  robot.links = {{5, {0, 0, 0}},   {6, {0, 100, 0}}, {4, {0, 0, 0}},  {4, {0, 100, 0}},
                 {2, {0, 0, -50}}, {2, {0, 0, 0}},   {5, {0, 0, 100}}};
  robot.elastic = {1, 3};
  std::vector<double> bent;
  for (const double home : {10, 35, -20, -70, 30, 50, 15}) bent.push_back(home * kDegree);
  return at_home(std::move(robot), bent);
}

Robot palletizer() {
  Robot robot;
  identify::Arm& arm = robot.arm;
  arm.rows = {{800, 0, 300, -90 * kDegree},
              {0, -80 * kDegree, 1100, 0},
              {0, 60 * kDegree, 1200, 90 * kDegree},
              {0, 0, 0, 0}};
  arm.home_rad = {0, -80 * kDegree, 60 * kDegree, 0};
  arm.positive.assign(4, 1);
  arm.tool_mm = {300, 0, 200};
  robot.specified = arm;
  robot.targets_mm = {arm.tool_mm};
  return robot;
}

Robot kr5_on_rail() {
  Robot robot;
  robot.arm = robot.specified = identify::test::on_linear_unit();
  robot.targets_mm = {robot.arm.tool_mm};
  return robot;
}

Robot built(Robot robot, std::uint32_t seed) {
  auto random = stream(seed, Source::built);
  std::normal_distribution<> normal;
  for (auto& row : robot.arm.rows) {
    row.b_mm += 0.5 * normal(random);
    row.theta_rad += 0.05 * kDegree * normal(random);
    row.a_mm += 0.5 * normal(random);
    row.alpha_rad += 0.05 * kDegree * normal(random);
  }
  auto weights = stream(seed, Source::weights);
  for (Link& link : robot.links) {
    link.mass_kg *= std::exp(0.5 * normal(weights));
    for (double& coordinate : link.center_mm) coordinate += 80 * normal(weights);
  }
  return robot;
}

Robot at_home(Robot robot, const std::vector<double>& home_rad) {
  for (identify::Arm* arm : {&robot.specified, &robot.arm}) {
    for (std::size_t j = 0; j < arm->joints(); ++j) {
      const double moved = arm->positive[j] * (home_rad[j] - arm->home_rad[j]);
      if (arm->is_linear(j))
        arm->rows[j].b_mm += identify::kLinear_mm * moved;
      else
        arm->rows[j].theta_rad += moved;
    }
    arm->home_rad = home_rad;
  }
  return robot;
}

Robot at_random_home(const Robot& robot, std::uint32_t seed) {
  auto random = stream(seed, Source::home);
  std::uniform_real_distribution<> off(-35 * kDegree, 35 * kDegree);
  while (true) {
    std::vector<double> home = robot.arm.home_rad;
    for (double& angle : home) angle += off(random);
    Robot moved = at_home(robot, home);
    if (fit_for_sweeps(chain_of(moved))) return moved;
  }
}

bool fit_for_sweeps(const identify::Chain& chain) {
  constexpr double kLeastRadius_mm = 80;
  constexpr double kLeastSine = 0.2;
  constexpr double kLeastDistance_mm = 50;
  for (const auto& axis : chain.axes)
    for (const Vector3d& target : chain.targets_mm)
      if (distance_mm(axis, target) < kLeastRadius_mm) return false;
  for (std::size_t j = 2; j < chain.axes.size(); ++j) {
    const auto& first = chain.axes[j - 2];
    const auto& second = chain.axes[j];
    if (first.direction.cross(second.direction).norm() < kLeastSine &&
        distance_mm(first, second.point_mm) < kLeastDistance_mm)
      return false;
  }
  return true;
}

identify::Chain chain_of(const Robot& robot) {
  identify::Chain chain;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (std::size_t j = 0; j < robot.arm.rows.size(); ++j) {
    chain.axes.push_back({robot.arm.positive[j] * Vector3d(frame.linear().col(2)),
                          frame.translation(), robot.arm.is_linear(j)});
    frame = frame * identify::transform(robot.arm.rows[j]);
  }
  for (const Vector3d& target : robot.targets_mm) chain.targets_mm.push_back(frame * target);
  chain.tool = frame.linear();
  return chain;
}

}  // namespace simulation
