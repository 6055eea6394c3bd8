#include "tests/simulation/gravity.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "identify/geometry/angle.hpp"

namespace simulation {
namespace {

using Eigen::Vector3d;

constexpr double kGravity = 9.81;  // m / s^2

}  // namespace

Sag::Sag(const Robot& robot, double worst_rad) : home_(chain_of(robot)), up_(robot.up) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (std::size_t j = 0; j < robot.arm.joints(); ++j) {
    frame = frame * identify::transform(robot.arm.rows[j]);
    const Link link = robot.links.empty() ? Link{} : robot.links[j];
    weights_n_.push_back(kGravity * link.mass_kg);
    centers_mm_.push_back(frame * link.center_mm);
  }
  if (worst_rad == 0) return;
  constexpr int kPoses = 400;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<> angle(-identify::kPi, identify::kPi);
  identify::Turns worst{};
  for (int i = 0; i < kPoses; ++i) {
    identify::Turns turns{};
    for (std::size_t j = 0; j < home_.axes.size(); ++j) turns[j] = angle(random);
    const identify::Turns here = torques(turns);
    for (std::size_t j = 0; j < here.size(); ++j) worst[j] = std::max(worst[j], std::abs(here[j]));
  }
  for (const std::size_t j : robot.elastic) compliance_[j] = worst_rad / worst[j];
}

identify::Turns Sag::at(const identify::Turns& turns) const {
  identify::Turns bent = torques(turns);
  for (std::size_t j = 0; j < bent.size(); ++j) bent[j] *= compliance_[j];
  return bent;
}

identify::Turns Sag::torques(const identify::Turns& turns) const {
  const std::size_t joints = home_.axes.size();
  std::vector<Vector3d> directions, points, centers;
  Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
  for (std::size_t j = 0; j < joints; ++j) {
    const Vector3d& direction = home_.axes[j].direction;
    const Vector3d& point = home_.axes[j].point_mm;
    directions.emplace_back(moved.linear() * direction);
    points.emplace_back(moved * point);
    moved = moved * Eigen::Translation3d(point) * Eigen::AngleAxisd(turns[j], direction) *
            Eigen::Translation3d(-point);
    centers.emplace_back(moved * centers_mm_[j]);
  }
  identify::Turns torques{};
  Vector3d moment = Vector3d::Zero();  // of the weights, about the base's origin
  double weight = 0;
  for (std::size_t j = joints; j-- > 0;) {
    const Vector3d down = -weights_n_[j] * up_;
    moment += centers[j].cross(down);
    weight += weights_n_[j];
    const Vector3d about = moment + points[j].cross(weight * up_);
    torques[j] = directions[j].dot(about) / 1000;
  }
  return torques;
}

}  // namespace simulation
