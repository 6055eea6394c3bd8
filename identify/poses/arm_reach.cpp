#include "identify/poses/arm_reach.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/Cholesky>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/halton.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kReachStarts = 24;
constexpr std::size_t kPosesOfBox = 500;
constexpr int kMostReachSteps = 60;
/// Without a gain of a hundredth for so many steps it goes no nearer.
constexpr int kPatience = 6;
constexpr double kLongestStep_mm = 150;
constexpr double kDamping_mm = 20;
constexpr double kThere_mm = 1e-3;

/// How the target moves with each joint, mm/rad, and where it is.
Eigen::Matrix3Xd reach_jacobian(const Arm& arm, const std::vector<double>& angles,
                                Vector3d& target) {
  Eigen::Matrix3Xd z(3, static_cast<Index>(arm.joints())), at = z;
  Isometry3d frame = Isometry3d::Identity();
  for (Index j = 0; j < z.cols(); ++j) {
    const auto joint = static_cast<std::size_t>(j);
    z.col(j) = arm.positive[joint] * frame.linear().col(2);
    at.col(j) = frame.translation();
    frame = frame * transform(arm.row_at(joint, angles[joint]));
  }
  target = frame * arm.tool_mm;
  for (Index j = 0; j < z.cols(); ++j)
    z.col(j) = arm.is_linear(static_cast<std::size_t>(j))
                   ? Vector3d(kLinear_mm * z.col(j))
                   : Vector3d(z.col(j)).cross(target - at.col(j));
  return z;
}

}  // namespace

ArmReach::ArmReach(Arm arm, JointRanges ranges) : arm_(std::move(arm)), ranges_(std::move(ranges)) {
  std::vector<double> home = arm_.home_rad;
  for (std::size_t j = 0; j < home.size(); ++j)
    home[j] = std::clamp(home[j], ranges_[j][0], ranges_[j][1]);
  for (std::size_t k = 0; k < kReachStarts; ++k) {
    const auto& [least, most] = ranges_[0];
    home[0] = least + (most - least) * (static_cast<double>(k) + 0.5) / kReachStarts;
    starts_.push_back({home, target_mm(home)});
  }
}

Vector3d ArmReach::target_mm(const std::vector<double>& angles_rad) const {
  return forward_kinematics(arm_, angles_rad) * arm_.tool_mm;
}

std::optional<std::vector<double>> ArmReach::angles_at(const Vector3d& point_mm) const {
  const auto nearest =
      std::min_element(starts_.begin(), starts_.end(), [&](const Start& one, const Start& other) {
        return (one.target_mm - point_mm).norm() < (other.target_mm - point_mm).norm();
      });
  std::vector<double> angles = nearest->angles_rad;
  double best = (nearest->target_mm - point_mm).norm();
  for (int step = 0, without_gain = 0; step < kMostReachSteps && without_gain < kPatience; ++step) {
    Vector3d target;
    const Eigen::Matrix3Xd by_joint = reach_jacobian(arm_, angles, target);
    Vector3d off = point_mm - target;
    const double distance = off.norm();
    if (distance < kThere_mm) return angles;
    without_gain = distance < 0.99 * best ? 0 : without_gain + 1;
    best = std::min(best, distance);
    if (distance > kLongestStep_mm) off *= kLongestStep_mm / distance;
    const double damping = std::min(kDamping_mm, distance);
    Eigen::Matrix3d normal = by_joint * by_joint.transpose();
    normal.diagonal().array() += damping * damping;
    const VectorXd by = by_joint.transpose() * normal.llt().solve(off);
    for (std::size_t j = 0; j < angles.size(); ++j)
      angles[j] = std::clamp(angles[j] + by(static_cast<Index>(j)), ranges_[j][0], ranges_[j][1]);
  }
  return std::nullopt;
}

std::array<Vector3d, 2> ArmReach::box() const {
  std::array<Vector3d, 2> box{starts_.front().target_mm, starts_.front().target_mm};
  for (std::size_t k = 1; k <= kPosesOfBox; ++k) {
    std::vector<double> angles = halton_point(k, ranges_.size());
    for (std::size_t j = 0; j < angles.size(); ++j)
      angles[j] = ranges_[j][0] + (ranges_[j][1] - ranges_[j][0]) * angles[j];
    const Vector3d target = target_mm(angles);
    box[0] = box[0].cwiseMin(target);
    box[1] = box[1].cwiseMax(target);
  }
  return box;
}

}  // namespace identify
