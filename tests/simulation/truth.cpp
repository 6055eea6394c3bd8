#include "tests/simulation/truth.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace simulation {
namespace {

using Eigen::Vector3d;

double angle_about(const Vector3d& axis, const Vector3d& from, const Vector3d& to) {
  return std::atan2(axis.dot(from.cross(to)), from.dot(to));
}

/// One row, and the frame to which it leads.
struct Step {
  identify::DhRow row;
  Vector3d origin;
  Vector3d x;
};

/// From the frame (origin, x, z) to the axis `next`, by the common normal or, of parallel axes, by
/// the plane across z, `b_mm` from the origin; its X points by `sign`.
Step step(const Vector3d& origin, const Vector3d& x, const Vector3d& z,
          const identify::ChainAxis& next, bool parallel, double b_mm, double sign) {
  const Vector3d& n = next.direction;
  Step found{{}, next.point_mm, x};
  Vector3d foot = origin;
  Vector3d normal;
  if (parallel) {
    foot += b_mm * z;
    found.origin = next.point_mm + n * (z.dot(foot - next.point_mm) / z.dot(n));
    normal = sign * (found.origin - foot).normalized();
  } else {
    const Vector3d across = z.cross(n);
    const Vector3d gap = next.point_mm - origin;
    normal = sign * across.normalized();
    // Feet of the common normal, by determinants.
    foot += z * (gap.cross(n).dot(across) / across.squaredNorm());
    found.origin = next.point_mm + n * (gap.cross(z).dot(across) / across.squaredNorm());
  }
  const Vector3d y = z.cross(normal);
  found.row = {z.dot(foot - origin), angle_about(z, x, normal), normal.dot(found.origin - foot),
               std::atan2(-n.dot(y), n.dot(z)), std::asin(std::clamp(n.dot(normal), -1.0, 1.0))};
  found.x = (normal - n * n.dot(normal)).normalized();
  return found;
}

}  // namespace

std::vector<identify::DhRow> true_table(const Simulation& simulation,
                                        const std::vector<identify::DhEstimate>& found,
                                        const std::vector<std::optional<double>>& home_rad) {
  const Robot& robot = simulation.robot();
  std::vector<double> home = robot.arm.home_rad;
  for (std::size_t j = 0; j < home_rad.size(); ++j)
    if (home_rad[j]) home[j] = *home_rad[j];
  // The Z axes of the table, in the measurement frame.
  std::vector<identify::ChainAxis> axes;
  Eigen::Isometry3d frame = simulation.base();
  const identify::Arm arm = simulation.arm_at(home);
  for (const identify::DhRow& row : arm.rows) {
    axes.push_back({frame.linear().col(2), frame.translation()});
    frame = frame * identify::transform(row);
  }
  const Eigen::Isometry3d first =
      identify::first_frame({simulation.base().linear().col(2), simulation.base().translation()});
  Vector3d origin = first.translation();
  Vector3d x = first.linear().col(0);
  std::vector<identify::DhRow> table;
  for (std::size_t j = 0; j + 1 < axes.size(); ++j) {
    const bool parallel = j < found.size() && (found[j].relation == identify::Relation::parallel ||
                                               found[j].relation == identify::Relation::coincident);
    const identify::DhRow& specified = robot.specified.rows[j];
    const auto misfit = [&](const Step& one) {
      constexpr double kSize_mm = 1000;
      return std::abs(one.row.a_mm - specified.a_mm) / kSize_mm +
             std::abs(identify::wrapped(one.row.alpha_rad - specified.alpha_rad));
    };
    Step best = step(origin, x, axes[j].direction, axes[j + 1], parallel, specified.b_mm, 1);
    const Step other =
        step(origin, x, axes[j].direction, axes[j + 1], parallel, specified.b_mm, -1);
    if (misfit(other) < misfit(best)) best = other;
    table.push_back(best.row);
    origin = best.origin;
    x = best.x;
  }
  table.emplace_back();
  return table;
}

std::vector<double> errors_in_sigmas(const Simulation& simulation,
                                     const identify::Identification& found) {
  using identify::wrapped;
  std::vector<double> errors;
  const auto truth = true_table(simulation, found.dh, found.home_rad);
  for (std::size_t j = 0; j < found.dh.size(); ++j) {
    const auto add = [&](const identify::DhNumber& number, double off) {
      if (number.knowledge == identify::Knowledge::identified) errors.push_back(off / number.sigma);
    };
    const identify::DhEstimate& row = found.dh[j];
    add(row.b_mm, row.b_mm.value - truth[j].b_mm);
    add(row.a_mm, row.a_mm.value - truth[j].a_mm);
    add(row.theta_rad, wrapped(row.theta_rad.value - truth[j].theta_rad));
    add(row.alpha_rad, wrapped(row.alpha_rad.value - truth[j].alpha_rad));
    add(row.beta_rad, row.beta_rad.value - truth[j].beta_rad);
  }
  return errors;
}

}  // namespace simulation
