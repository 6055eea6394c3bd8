#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "identify/dh/dh.hpp"

namespace identify {

/// Which angles each joint may take, rad, one pair a joint.
using JointRanges = std::vector<std::array<double, 2>>;

/// Finds the angles at which an arm's target stands at a point of its base.
class ArmReach {
 public:
  ArmReach(Arm arm, JointRanges ranges);

  /// From home, joint 1 turned so that the target is nearest to the point, by damped steps of least
  /// size (Wampler, IEEE Trans. SMC 16, 1986): of all ways to reach it one near home, the
  /// same in every call and for points side by side much alike. Nothing where it does not get
  /// within 0.001 mm.
  [[nodiscard]] std::optional<std::vector<double>> angles_at(const Eigen::Vector3d& point_mm) const;
  /// The box about what can be reached: least and most of each coordinate.
  [[nodiscard]] std::array<Eigen::Vector3d, 2> box() const;

 private:
  [[nodiscard]] Eigen::Vector3d target_mm(const std::vector<double>& angles_rad) const;

  Arm arm_;
  JointRanges ranges_;
  struct Start {
    std::vector<double> angles_rad;
    Eigen::Vector3d target_mm;
  };
  std::vector<Start> starts_;
};

}  // namespace identify
