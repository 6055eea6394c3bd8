#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "identify/poses/arm_fit.hpp"

namespace identify {

/// Lengths and angles count alike in the columns below: a radian moves what is a metre away by a
/// metre.
inline constexpr double kReach_mm = 1000;

/// The numbers of a placed arm that can be let go, in the order of their columns: a shift of the
/// base (mm), a rotation of it (rad times kReach_mm), the targets (mm), then, as far as `freedom`
/// goes, of all joints the zeros (of a linear joint mm), b and a of each row, alpha and beta of
/// each row.
struct ArmNumbers {
  std::size_t joints = 0;
  std::size_t targets = 0;
  Freedom freedom = Freedom::frames;

  [[nodiscard]] Eigen::Index count() const {
    const auto n = static_cast<Eigen::Index>(joints);
    const Eigen::Index rows = freedom == Freedom::frames    ? 0
                              : freedom == Freedom::zeros   ? n
                              : freedom == Freedom::lengths ? 3 * n
                                                            : 5 * n;
    return 6 + static_cast<Eigen::Index>(3 * targets) + rows;
  }
  [[nodiscard]] Eigen::Index target(std::size_t t) const {
    return 6 + static_cast<Eigen::Index>(3 * t);
  }
  [[nodiscard]] Eigen::Index zero(std::size_t j) const {
    return target(targets) + static_cast<Eigen::Index>(j);
  }
  [[nodiscard]] Eigen::Index b(std::size_t j) const {
    return zero(joints) + static_cast<Eigen::Index>(2 * j);
  }
  [[nodiscard]] Eigen::Index a(std::size_t j) const { return b(j) + 1; }
  [[nodiscard]] Eigen::Index alpha(std::size_t j) const {
    return b(joints) + static_cast<Eigen::Index>(2 * j);
  }
  [[nodiscard]] Eigen::Index beta(std::size_t j) const { return alpha(j) + 1; }
};

/// How a pose's position changes with each number: 3 by numbers.count(). b of parallel axes and
/// beta of others change nothing.
[[nodiscard]] Eigen::MatrixXd arm_columns(const PlacedArm& placed, const Pose& pose,
                                          const ArmNumbers& numbers);

/// The arm after the change `by` of its numbers.
[[nodiscard]] PlacedArm moved(const PlacedArm& placed, const ArmNumbers& numbers,
                              const Eigen::VectorXd& by);

}  // namespace identify
