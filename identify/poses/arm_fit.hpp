#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "identify/chain/chain.hpp"
#include "identify/dh/dh.hpp"
#include "identify/poses/pose.hpp"

namespace identify {

/// What of a specified arm is let go to fit poses, each with those before it.
enum class Freedom {
  frames,   ///< where the base stands, and where the targets are on the last frame
  zeros,    ///< where each joint's angle is zero
  lengths,  ///< a and b of all rows
  twists,   ///< alpha, and beta beside parallel axes
};
inline constexpr std::size_t kFreedoms = 4;

/// An arm that stands in the measurement frame.
struct PlacedArm {
  Arm arm;
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();  ///< of the arm in that frame
  std::vector<Eigen::Vector3d> targets_mm;                 ///< in the frame after the last row

  [[nodiscard]] Eigen::Vector3d position_mm(std::size_t target, const Sample& sample) const;
  /// With home as the arm has it; its axes are along positive rotation.
  [[nodiscard]] Chain chain() const;
};

/// The arm with the least sum of the poses' weighted squared distances, in mm, by Gauss-Newton from
/// `start`. What the poses do not determine, or not apart from another number (the first joint's
/// zero from the base, say), stays as near to `start` as it can be. `weights`: one a pose.
[[nodiscard]] PlacedArm fitted(const PlacedArm& start, Freedom freedom,
                               const std::vector<Pose>& poses, const Eigen::VectorXd& weights);

struct ArmNumbers;  // arm_columns.hpp

/// As above, with these columns of `numbers` let go.
[[nodiscard]] PlacedArm fitted(const PlacedArm& start, const ArmNumbers& numbers,
                               const std::vector<Eigen::Index>& free,
                               const std::vector<Pose>& poses, const Eigen::VectorXd& weights);

/// As above, from anywhere: base and targets by the positions, then up to `freedom`, poses that are
/// far off counting little. `targets`: how many there are.
[[nodiscard]] PlacedArm placed_robustly(const Arm& arm, Freedom freedom,
                                        const std::vector<Pose>& all, std::size_t targets);

/// The rotation and shift that take `from` to `to` best, a column a point (Kabsch, Acta Cryst. A32,
/// 1976).
[[nodiscard]] Eigen::Isometry3d registered(const Eigen::Matrix3Xd& from,
                                           const Eigen::Matrix3Xd& to);

/// The distance of each pose from where the arm has it, mm.
[[nodiscard]] Eigen::VectorXd distances_mm(const PlacedArm& arm, const std::vector<Pose>& poses);

/// The middle one of them.
[[nodiscard]] double middle_of(const Eigen::VectorXd& distances);

}  // namespace identify
