#include "identify/chain/target_level.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "identify/dh/dh_comparison.hpp"
#include "identify/dh/dh_extraction.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// A target that is elsewhere on the tool is no farther off along the axis, in times of across.
constexpr double kAlongToAcross = 3;
constexpr double kFollows = 0.5;  // mm a mm

/// The row of a linear joint whose b goes along with the target along the last axis, and by how
/// much.
struct Follower {
  std::size_t row = 0;
  double b_mm = 0;
  double slope = 0;
};
std::optional<Follower> follower_of(const PlacedAxes& at_level, const std::vector<DhRow>& specified,
                                    double size_mm) {
  const auto table = extract_dh(at_level.z, size_mm, specified);
  const Eigen::VectorXd follows = dh_jacobian(at_level.z, size_mm, specified) *
                                  (at_level.by_given.rightCols<3>() * at_level.z.back()->direction);
  for (std::size_t i = 0; i < table.size(); ++i)
    if (const double slope = follows(static_cast<Index>(5 * i));
        table[i].linear && std::abs(slope) > kFollows)
      return Follower{i, table[i].b_mm.value, slope};
  return std::nullopt;
}

/// How the first axis, as that of a linear joint, goes along with the target, across it.
Vector3d first_across(const PlacedAxes& at_level) {
  const Vector3d& along = at_level.z.front()->direction;
  const Vector3d moved =
      at_level.by_given.block<3, 3>(3, at_level.by_given.cols() - 3) * at_level.z.back()->direction;
  return moved - along * along.dot(moved);
}

/// How much higher the target is where a first axis that goes along runs through the frame's
/// origin, or b of a linear joint's row, whichever follows, is as specified.
double higher_by_base_mm(const PlacedAxes& at_level, const std::vector<DhRow>& specified,
                         double size_mm) {
  if (const Vector3d across = first_across(at_level); across.norm() > kFollows)
    return -across.dot(at_level.z.front()->point_mm) / across.squaredNorm();
  const auto row = follower_of(at_level, specified, size_mm);
  return row ? (specified[row->row].b_mm - row->b_mm) / row->slope : 0;
}

/// By how much the first axis, if it does not go along, misses the origin of the frame.
double off_origin_mm(const PlacedAxes& at_level) {
  const Axis& first = *at_level.z.front();
  return first_across(at_level).norm() > kFollows ? 0
                                                  : first.direction.cross(first.point_mm).norm();
}

}  // namespace

TargetLevel target_level(const std::vector<std::optional<Axis>>& z, const Vector3d& target_mm,
                         const Eigen::MatrixXd& covariance, const Campaign& campaign,
                         const std::vector<DhRow>& specified, double size_mm) {
  if (!z.back() || !campaign.specified || specified.empty()) return {target_mm, 0};
  const Vector3d& up = z.back()->direction;
  const Vector3d tool = transform(specified.back()) * campaign.specified->tool_mm;
  TargetLevel level{target_mm - tool.z() * up, 0};
  if (std::any_of(z.begin(), z.end(), [](const auto& axis) { return !axis; })) return level;
  const PlacedAxes described = placed(z, level.at_mm, covariance, specified, size_mm);
  const auto last =
      last_frame(*described.z.front(), extract_dh(described.z, size_mm, specified), specified);
  if (!last) return level;
  const double across_mm =
      (last->inverse() * target_mm - campaign.specified->tool_mm).head<2>().norm();
  if (campaign.device_frame) {
    level.open_mm = across_mm;
    return level;
  }
  const double higher_mm = higher_by_base_mm(described, specified, size_mm);
  const double elsewhere_mm = off_origin_mm(described);
  level.at_mm += higher_mm * up;
  if (elsewhere_mm > kMostOff_mm)
    level.open_mm = std::max(elsewhere_mm, std::abs(higher_mm));
  else if (std::abs(higher_mm) > kMostOff_mm + kAlongToAcross * across_mm)
    level.open_mm = std::abs(higher_mm);
  return level;
}

Eigen::VectorXd change_with_level(const PlacedAxes& at_level, const std::vector<DhRow>& specified,
                                  double size_mm) {
  const Vector3d& up = at_level.z.back()->direction;
  Eigen::VectorXd change = at_level.by_given.rightCols<3>() * up;
  if (!at_level.z.front()->linear && follower_of(at_level, specified, size_mm))
    for (Index at = 3; at < change.size(); at += 6) change.segment<3>(at) -= up;
  return change;
}

}  // namespace identify
