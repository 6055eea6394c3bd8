#include <cmath>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/line.hpp"
#include "identify/identification.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

constexpr double kFullTurn = 2 * kPi;

}  // namespace

std::optional<SeenTurn> seen_turn(const Identification& found, std::size_t joint,
                                  std::size_t target, const Sample& sample) {
  if (!found.chain) return std::nullopt;
  const ChainEstimate& estimate = *found.chain;
  if (!estimate.axes[joint] || target >= estimate.chain.targets_mm.size() || !sample.has_position)
    return std::nullopt;
  Turns turns{};
  for (std::size_t k = 0; k < found.joints.size(); ++k)
    if (estimate.axes[k] && found.home_rad[k] && sample.joints > k)
      turns[k] = sample.angles_rad[k] - *found.home_rad[k];
  for (std::size_t k = 0; k < estimate.locked_rad.size(); ++k)
    if (k != joint) turns[k] += estimate.locked_rad[k];
  const ChainAxis& axis = estimate.chain.axes[joint];
  const Vector3d& z = axis.direction;
  // The target as the joints behind carry it, and what was seen as if those before stood at home.
  Vector3d start = estimate.chain.targets_mm[target];
  for (std::size_t k = estimate.chain.axes.size(); k-- > joint + 1;)
    start = estimate.chain.axes[k].displacement(turns[k]) * start;
  Vector3d here = sample.position_mm;
  for (std::size_t k = 0; k < joint; ++k)
    here = estimate.chain.axes[k].displacement(-turns[k]) * here;
  start -= axis.point_mm;
  here -= axis.point_mm;
  SeenTurn seen;
  if (axis.linear) {
    const Vector3d off = here - start;
    seen.turn_rad = z.dot(off) / kLinear_mm;
    const Eigen::Vector2d beside = across(z).transpose() * off;
    seen.axial_mm = beside(0);
    seen.radial_mm = beside(1);
    if (sample.joints > joint && found.home_rad[joint]) {
      seen.angle_error_rad = turns[joint] - seen.turn_rad;
      seen.curve_rad = estimate.angles[joint].curve_at(seen.turn_rad);
    }
    return seen;
  }
  const Vector3d start_arm = start - z * z.dot(start);
  const Vector3d arm = here - z * z.dot(here);
  seen.turn_rad = std::atan2(z.dot(start_arm.cross(arm)), start_arm.dot(arm));
  seen.axial_mm = z.dot(here - start);
  seen.radial_mm = arm.norm() - start_arm.norm();
  if (sample.joints > joint && found.home_rad[joint]) {
    seen.angle_error_rad = std::remainder(turns[joint] - seen.turn_rad, kFullTurn);
    seen.curve_rad = estimate.angles[joint].curve_at(turns[joint] - *seen.angle_error_rad);
  }
  return seen;
}

}  // namespace identify
