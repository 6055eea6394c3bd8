#include "daemon/report/joint_shapes.hpp"

#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

constexpr std::size_t kCircleSteps = 72;

Points whole_circle(const Vector3d& centre, const Vector3d& normal, double radius) {
  Points points;
  if (!centre.allFinite() || !normal.allFinite() || !(radius > 0)) return points;
  const Vector3d u = normal.unitOrthogonal();
  const Vector3d v = normal.cross(u);
  for (std::size_t k = 0; k <= kCircleSteps; ++k) {
    const double angle = 2 * kPi * static_cast<double>(k) / kCircleSteps;
    points.push_back(centre + radius * (std::cos(angle) * u + std::sin(angle) * v));
  }
  return points;
}

/// Where the common perpendicular of two axes meets them; on parallel axes beside `before`.
std::array<Vector3d, 2> feet(const JointShape& one, const JointShape& next,
                             const Vector3d& before) {
  const Vector3d across = one.along_axis.cross(next.along_axis);
  const auto onto = [](const Vector3d& point, const JointShape& shape) -> Vector3d {
    return shape.on_axis + shape.along_axis * shape.along_axis.dot(point - shape.on_axis);
  };
  constexpr double kParallel = 1e-2;
  if (across.norm() < kParallel) {
    const Vector3d foot = onto(before, one);
    return {foot, onto(foot, next)};
  }
  const Vector3d between = next.on_axis - one.on_axis;
  const double s = between.cross(next.along_axis).dot(across) / across.squaredNorm();
  const double t = between.cross(one.along_axis).dot(across) / across.squaredNorm();
  return {one.on_axis + s * one.along_axis, next.on_axis + t * next.along_axis};
}

}  // namespace

std::vector<JointShape> joint_shapes(const ReportFolder& folder) {
  std::vector<JointShape> shapes;
  for (const Json& joint : list_of(folder.result, "joints")) {
    JointShape shape;
    shape.index = shapes.size();
    const Json& circle = part_of(joint, "circle");
    const Json& line = part_of(joint, "line");
    if (circle.is_object()) {
      shape.centre = vector_of(part_of(circle, "center"));
      shape.normal = vector_of(part_of(circle, "normal"));
      shape.radius = number_of(circle, "radius_mm");
      shape.circle = whole_circle(shape.centre, shape.normal, shape.radius);
    } else if (line.is_object()) {
      shape.centre = vector_of(part_of(line, "point"));
      shape.normal = vector_of(part_of(line, "direction"));
      shape.length = number_of(line, "length_mm");
    }
    shape.on_axis = vector_of(part_of(part_of(joint, "axis"), "point"));
    shape.along_axis = vector_of(part_of(part_of(joint, "axis"), "direction"));
    for (const Stroke& stroke : folder.strokes) {
      if (stroke.joint != shape.index) continue;
      for (const StrokePoint& point : stroke.points) shape.moved.push_back(point.position_mm);
    }
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

std::vector<Vector3d> arm_at_home(const ReportFolder& folder,
                                  const std::vector<JointShape>& shapes) {
  Points arm;
  for (const JointShape& shape : shapes)
    if (!shape.on_axis.allFinite() || shape.length > 0) return arm;
  if (shapes.empty()) return arm;
  const JointShape& first = shapes.front();
  arm.push_back(first.on_axis - first.along_axis * first.along_axis.dot(first.on_axis));
  if (text_of(folder.result, "describes") != "controller_model") arm.clear();
  if (arm.empty()) arm.push_back(first.on_axis);
  for (std::size_t i = 0; i + 1 < shapes.size(); ++i)
    for (const Vector3d& foot : feet(shapes[i], shapes[i + 1], arm.back())) arm.push_back(foot);
  const Json& tool = part_of(part_of(part_of(folder.result, "models"), "exponentials"), "tool");
  const Vector3d target(number_of(tool, "x_mm"), number_of(tool, "y_mm"), number_of(tool, "z_mm"));
  if (target.allFinite()) arm.push_back(target);
  return arm;
}

}  // namespace sweepd
