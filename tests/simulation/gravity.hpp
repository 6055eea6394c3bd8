#pragma once

#include <vector>

#include "tests/simulation/robot.hpp"

namespace simulation {

/// How the weight of its links bends a robot: each elastic joint turns in proportion to the torque
/// about its axis at the pose, tau_j = z_j . sum over links k >= j of (c_k - p_j) x m_k g.
class Sag {
 public:
  /// `worst_rad`: of each elastic joint at the worst of some hundred poses.
  Sag(const Robot& robot, double worst_rad);

  /// How far each joint is turned by the load, positive rotation, joints having turned by `turns`
  /// from home. To first order: by the torque of the arm that is not bent.
  [[nodiscard]] identify::Turns at(const identify::Turns& turns) const;

  /// About each joint, positive rotation, N m.
  [[nodiscard]] identify::Turns torques(const identify::Turns& turns) const;

 private:
  identify::Chain home_;
  Eigen::Vector3d up_;
  std::vector<double> weights_n_;
  std::vector<Eigen::Vector3d> centers_mm_;  ///< at home
  identify::Turns compliance_{};             ///< rad / N m
};

}  // namespace simulation
