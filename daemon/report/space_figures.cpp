#include "daemon/report/space_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "daemon/drawing/plot.hpp"
#include "daemon/drawing/view.hpp"
#include "daemon/text/numbers.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

constexpr std::size_t kCircleSteps = 72;
/// A circle with a smaller diameter than so many px has an inset.
constexpr double kTooSmall_px = 36;

const Vector3d kNowhere = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

/// What is drawn of one joint.
struct JointShape {
  std::size_t index = 0;
  Vector3d centre = kNowhere;  // of the circle; of a linear joint a point of its line
  Vector3d normal = kNowhere;
  double radius = 0;
  double length = 0;  // of the line of a linear joint
  Vector3d on_axis = kNowhere;
  Vector3d along_axis = kNowhere;
  Points circle;
  Points moved;  // of all strokes
};

Points whole_circle(const Vector3d& centre, const Vector3d& normal, double radius) {
  Points points;
  if (!centre.allFinite() || !normal.allFinite() || !(radius > 0)) return points;
  const Vector3d u = normal.unitOrthogonal();
  const Vector3d v = normal.cross(u);
  for (std::size_t k = 0; k <= kCircleSteps; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / kCircleSteps;
    points.push_back(centre + radius * (std::cos(angle) * u + std::sin(angle) * v));
  }
  return points;
}

std::vector<JointShape> shapes_of(const ReportFolder& folder) {
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

/// The arm as its axes have it at home: from the frame's origin, or the foot below it, along the
/// common perpendiculars to the target.
Points skeleton(const ReportFolder& folder, const std::vector<JointShape>& shapes) {
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

/// All that a figure must hold, without what is infinitely long.
Points extent_of(const std::vector<JointShape>& shapes, const Points& arm) {
  Points all = arm;
  for (const JointShape& shape : shapes) {
    all.insert(all.end(), shape.circle.begin(), shape.circle.end());
    all.insert(all.end(), shape.moved.begin(), shape.moved.end());
    if (shape.circle.empty() && shape.on_axis.allFinite()) all.push_back(shape.on_axis);
  }
  return all;
}

struct Ball {
  Vector3d middle = Vector3d::Zero();
  double radius = 1;
};

Ball ball_around(const Points& points) {
  if (points.empty()) return {};
  Vector3d low = points.front();
  Vector3d high = low;
  for (const Vector3d& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  return {(low + high) / 2, std::max((high - low).norm() / 2, 1e-6)};
}

void draw_joint(Picture& picture, const View& view, const JointShape& shape, double axis_length) {
  const auto kind = joint_line(shape.index);
  picture.path(view.spots(shape.circle), kind);
  picture.dots(view.spots(shape.moved), joint_dots(shape.index));
  if (shape.on_axis.allFinite()) {
    const Vector3d foot =
        shape.centre.allFinite()
            ? Vector3d(shape.on_axis +
                       shape.along_axis * shape.along_axis.dot(shape.centre - shape.on_axis))
            : shape.on_axis;
    picture.line(view.spot(foot - axis_length * shape.along_axis),
                 view.spot(foot + axis_length * shape.along_axis), kind + " hair whole");
  }
  if (!shape.centre.allFinite()) return;
  const Spot centre = view.spot(shape.centre);
  const Spot tip = view.spot(shape.centre + 0.8 * axis_length * shape.normal);
  picture.circle(centre, 1.8, joint_fill(shape.index));
  picture.arrow(centre, tip, kind + " whole");
}

/// The joints' names, each beside the tip of its normal or its centre, where no other name is.
void name_joints(Picture& picture, const View& view, const std::vector<JointShape>& shapes,
                 double axis_length) {
  std::vector<Spot> taken;
  for (const JointShape& shape : shapes) {
    if (!shape.centre.allFinite() && !shape.on_axis.allFinite()) continue;
    const Vector3d tip = shape.centre.allFinite()
                             ? Vector3d(shape.centre + 0.8 * axis_length * shape.normal)
                             : Vector3d(shape.on_axis + axis_length * shape.along_axis);
    Spot at = view.spot(tip) + Spot(5, -4);
    for (std::size_t tries = 0; tries < 12; ++tries) {
      const bool free = std::none_of(taken.begin(), taken.end(), [&](const Spot& other) {
        return std::abs(other.x() - at.x()) < 18 && std::abs(other.y() - at.y()) < 11;
      });
      if (free) break;
      at.y() += 11;
    }
    taken.push_back(at);
    picture.words(at, "A" + std::to_string(shape.index + 1), Anchor::start, "strong");
  }
}

/// X, Y and Z of the frame of the measurements, in a corner.
void draw_triad(Picture& picture, const View& view, const Spot& corner) {
  constexpr double kLength = 26;
  const Spot origin = view.spot(Vector3d::Zero());
  for (int axis = 0; axis < 3; ++axis) {
    const Spot way = view.spot(Vector3d::Unit(axis) / view.scale()) - origin;
    const Spot tip = corner + kLength * way;
    picture.arrow(corner, tip, "axis");
    picture.words(tip + 8 * way.normalized() + Spot(0, 3), std::string(1, "XYZ"[axis]),
                  Anchor::middle, "small");
  }
}

/// "500 mm" and a line as long as that.
void draw_scale(Picture& picture, const View& view, const Frame& frame) {
  const auto marks = ticks({0, frame.width / 3 / view.scale()}, 1);
  if (marks.size() < 2) return;
  const double length = marks[1];
  const Spot left(frame.left + 6, frame.bottom() - 6);
  const Spot right = left + Spot(length * view.scale(), 0);
  picture.line(left, right, "axis");
  for (const Spot& end : {left, right}) picture.line(end + Spot(0, -3), end + Spot(0, 3), "axis");
  picture.words(right + Spot(5, 3), tick_text(length, length) + " mm", Anchor::start, "small");
}

void draw_space(Picture& picture, const View& view, const std::vector<JointShape>& shapes,
                const Points& arm, double axis_length) {
  picture.path(view.spots(arm), "arm");
  for (const JointShape& shape : shapes) draw_joint(picture, view, shape, axis_length);
  name_joints(picture, view, shapes, axis_length);
}

void draw_flat_view(Picture& picture, View view, const Frame& frame, const char* title,
                    const std::array<const char*, 2>& axes, const std::vector<JointShape>& shapes,
                    const Points& arm, const Points& extent, double axis_length) {
  constexpr double kRoom = 14;
  view.fit(extent, {frame.left + kRoom, frame.top + kRoom, frame.width - 2 * kRoom,
                    frame.height - 2 * kRoom});
  const Eigen::Vector2d low = view.place({frame.left, frame.bottom()});
  const Eigen::Vector2d high = view.place({frame.right(), frame.top});
  Plot plot(picture, frame, {{low.x(), high.x()}, axes[0], false, 5},
            {{low.y(), high.y()}, axes[1], false, 5});
  draw_space(plot.inside(), view, shapes, arm, axis_length);
  picture.words({frame.left, frame.top - 6}, title, Anchor::start, "strong");
}

/// The frame of the decomposition of the points of a joint, eq. (3).
struct Decomposition {
  Vector3d mean = kNowhere;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // V1, V2, V3
  Vector3d singular = Vector3d::Zero();                // sigma 1 to 3, mm
  std::size_t count = 0;
};

Decomposition decompose(const PointSums& sums) {
  Decomposition found;
  if (sums.count < 3) return found;
  const double m = static_cast<double>(sums.count);
  const Vector3d mean = sums.sum / m;
  const Eigen::Matrix3d scatter = sums.products - m * mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  found.mean = sums.origin + mean;
  found.axes = solver.eigenvectors().rowwise().reverse();
  found.singular = solver.eigenvalues().reverse().cwiseMax(0).cwiseSqrt();
  if (found.axes.determinant() < 0) found.axes.col(2) *= -1;
  found.count = sums.count;
  return found;
}

constexpr double kPanel = 226;
constexpr double kPanelGap = 14;
constexpr double kPanelHeight = 160;
constexpr double kPanelRoom = 30;
constexpr std::size_t kPanelsInRow = 3;

Frame panel(std::size_t index) {
  return {1 + static_cast<double>(index % kPanelsInRow) * (kPanel + kPanelGap),
          static_cast<double>(index / kPanelsInRow) * (kPanelHeight + kPanelRoom) + 18, kPanel,
          kPanelHeight};
}

double panels_height(std::size_t count) {
  return static_cast<double>((count + kPanelsInRow - 1) / kPanelsInRow) *
         (kPanelHeight + kPanelRoom);
}

constexpr double kPanelsWidth = kPanelsInRow * kPanel + (kPanelsInRow - 1) * kPanelGap + 2;

Frame within(const Frame& frame, double room) {
  return {frame.left + room, frame.top + room, frame.width - 2 * room, frame.height - 2 * room};
}

void draw_circle_panel(Picture& picture, const JointShape& shape, const Frame& frame) {
  picture.words({frame.left, frame.top - 5}, "Joint " + std::to_string(shape.index + 1),
                Anchor::start, "strong");
  picture.bar(frame, "hollow axis");
  Points all = shape.circle;
  all.insert(all.end(), shape.moved.begin(), shape.moved.end());
  const double size = shape.radius > 0 ? shape.radius : std::max(shape.length / 2, 1e-6);
  const Vector3d tip = shape.centre + 0.9 * size * shape.normal;
  all.push_back(shape.centre);
  all.push_back(tip);
  View view = View::oblique();
  view.fit(all, within(frame, 26));
  picture.dots(view.spots(shape.moved), joint_dots(0));
  picture.path(view.spots(shape.circle), "axis");
  if (shape.length > 0)
    picture.line(view.spot(shape.centre - 0.5 * shape.length * shape.normal),
                 view.spot(shape.centre + 0.5 * shape.length * shape.normal), "axis");
  const Spot centre = view.spot(shape.centre);
  picture.circle(centre, 2.2, "");
  picture.words(centre + Spot(5, 11), "C");
  picture.arrow(centre, view.spot(tip), "axis");
  picture.words(view.spot(tip) + Spot(5, 4), "n");
  draw_triad(picture, view, {frame.left + 24, frame.bottom() - 16});
  const std::string text = shape.radius > 0 ? "r = " + fixed(shape.radius, 4) + " mm"
                                            : "length " + fixed(shape.length, 3) + " mm";
  picture.words({frame.right() - 6, frame.top + 14}, text, Anchor::end, "small");
}

void draw_decomposition_panel(Picture& picture, const JointShape& shape, const Decomposition& found,
                              const Frame& frame) {
  picture.words({frame.left, frame.top - 5}, "Joint " + std::to_string(shape.index + 1),
                Anchor::start, "strong");
  picture.bar(frame, "hollow axis");
  // The longest axis is drawn as long as the points reach, the others in proportion.
  Points places;
  double reach = 0;
  for (const Vector3d& point : shape.moved) {
    places.emplace_back(found.axes.transpose() * (point - found.mean));
    reach = std::max(reach, std::abs(places.back().x()));
  }
  const double scale = found.singular(0) > 0 ? 1.15 * reach / found.singular(0) : 0;
  Points all = places;
  std::array<Vector3d, 3> tips;
  for (int axis = 0; axis < 3; ++axis) {
    tips[static_cast<std::size_t>(axis)] = scale * found.singular(axis) * Vector3d::Unit(axis);
    all.push_back(tips[static_cast<std::size_t>(axis)]);
    all.emplace_back(-tips[static_cast<std::size_t>(axis)]);
  }
  View view = View::nearly_flat();
  view.fit(all, within({frame.left, frame.top, frame.width, frame.height - 38}, 22));
  picture.dots(view.spots(places), joint_dots(0));
  const Spot mean = view.spot(Vector3d::Zero());
  picture.circle(mean, 2, "");
  static constexpr std::array<const char*, 3> kAxisNames{"V₁", "V₂", "V₃"};
  static constexpr double kShortest_px = 10;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Spot tip = view.spot(tips[axis]);
    const Spot way = view.spot(Vector3d::Unit(static_cast<int>(axis))) - mean;
    // Where the axis is too short to be seen, its direction is shown.
    const bool seen = (tip - mean).norm() >= kShortest_px;
    const Spot end = seen ? tip : Spot(mean + 22 * way.normalized());
    picture.arrow(mean, end, seen ? "axis whole" : "limit");
    picture.words(end + 9 * way.normalized() + Spot(0, 3), kAxisNames[axis], Anchor::middle,
                  "small");
  }
  std::string lengths;
  for (int axis = 0; axis < 3; ++axis)
    lengths += (axis > 0 ? "   " : "") +
               std::string(std::array{"σ₁ ", "σ₂ ", "σ₃ "}[static_cast<std::size_t>(axis)]) +
               fixed(found.singular(axis), axis < 2 ? 1 : 4);
  picture.words({frame.left + 8, frame.bottom() - 20}, lengths + " mm", Anchor::start, "small");
  picture.words(
      {frame.left + 8, frame.bottom() - 8},
      std::to_string(found.count) + " points, rms off the plane " +
          fixed(1000 * found.singular(2) / std::sqrt(static_cast<double>(found.count)), 2) + " µm",
      Anchor::start, "small");
}

}  // namespace

Markup add_figure(Markup parent, std::string_view title, std::string_view text) {
  auto figure = parent.add("figure");
  auto caption = figure.add("figcaption");
  caption.put("b", title);
  if (!text.empty()) caption.text(std::string(" ") += text);
  return figure;
}

void add_axes_figure(Markup parent, const ReportFolder& folder) {
  const auto shapes = shapes_of(folder);
  const Points arm = skeleton(folder, shapes);
  const Points extent = extent_of(shapes, arm);
  if (extent.empty()) return;
  const Ball ball = ball_around(extent);
  const double axis_length = 0.22 * ball.radius;
  auto figure = add_figure(
      parent, "Fitted circle for each joint motion.",
      std::string("As figure 7 of the paper: each circle is drawn whole, the range that was moved "
                  "is thick. A dot is a centre, an arrow a normal, a thin line a joint's axis.") +
          (arm.empty() ? ""
                       : " The grey line is the arm at home, along its axes and their common "
                         "perpendiculars."));
  constexpr double kWidth = 270;
  constexpr double kHeight = 250;
  constexpr double kLeft = 58;
  constexpr double kSecond = kLeft + kWidth + 86;
  std::vector<JointShape> small;
  View whole = View::perspective(ball.middle, ball.radius);
  const Frame last{kSecond - 40, 46 + kHeight + 50, kWidth + 40, kHeight};
  whole.fit(extent, within(last, 20));
  for (const JointShape& shape : shapes)
    if (shape.radius > 0 && 2 * shape.radius * whole.scale() < kTooSmall_px) small.push_back(shape);
  constexpr double kInset = 130;
  const double height = 46 + 2 * kHeight + 50 + 40 + (small.empty() ? 0 : kInset + 30);
  Picture picture(figure, kSecond + kWidth + 20, height,
                  "fitted circles of all joints from above, front, side and in perspective");
  draw_flat_view(picture, View::top(), {kLeft, 20, kWidth, kHeight}, "From above",
                 {"X, mm", "Y, mm"}, shapes, arm, extent, axis_length);
  draw_flat_view(picture, View::front(), {kSecond, 20, kWidth, kHeight}, "From the front",
                 {"X, mm", "Z, mm"}, shapes, arm, extent, axis_length);
  draw_flat_view(picture, View::side(), {kLeft, last.top, kWidth, kHeight}, "From the side",
                 {"Y, mm", "Z, mm"}, shapes, arm, extent, axis_length);
  picture.words({last.left, last.top - 6}, "In perspective", Anchor::start, "strong");
  draw_space(picture, whole, shapes, arm, axis_length);
  draw_triad(picture, whole, {last.left + 26, last.bottom() + 16});
  for (std::size_t i = 0; i < small.size() && i < 5; ++i) {
    const Frame inset{kLeft + static_cast<double>(i) * (kInset + 10), height - kInset - 4, kInset,
                      kInset};
    View view = View::oblique();
    view.fit(small[i].circle, within(inset, 26));
    picture.bar(inset, "hollow axis");
    picture.words({inset.left + 5, inset.top + 13},
                  "Joint " + std::to_string(small[i].index + 1) + ", " +
                      fixed(view.scale() / whole.scale(), 0) + "-fold",
                  Anchor::start, "small");
    Picture cut = picture.inside(inset);
    draw_joint(cut, view, small[i], 0.7 * small[i].radius);
    draw_scale(picture, view, inset);
  }
}

void add_circle_figures(Markup parent, const ReportFolder& folder) {
  std::vector<JointShape> drawn;
  for (auto& shape : shapes_of(folder))
    if (shape.centre.allFinite() && !shape.moved.empty()) drawn.push_back(std::move(shape));
  if (drawn.empty()) return;
  auto circles = add_figure(parent, "Circle, centre and normal of each joint.",
                            "As figure 3 of the paper, in the frame of the measurements (X, Y, Z). "
                            "C is the centre, n the normal. The measured points are thick.");
  Picture circle_picture(circles, kPanelsWidth, panels_height(drawn.size()),
                         "the circle, its centre and its normal, for each joint");
  for (std::size_t i = 0; i < drawn.size(); ++i)
    draw_circle_panel(circle_picture, drawn[i], panel(i));
  auto spread = add_figure(
      parent, "Spread of the points of each joint.",
      "As figure 4 of the paper: the points in the frame (V₁, V₂, V₃) of their singular value "
      "decomposition. The axes are as long, beside each other, as the singular values σ. A dashed "
      "arrow is an axis that is too short to be seen: V₃ is the normal of the plane.");
  Picture spread_picture(spread, kPanelsWidth, panels_height(drawn.size()),
                         "points and singular values of each joint");
  for (std::size_t i = 0; i < drawn.size(); ++i)
    if (drawn[i].index < folder.sums.size())
      draw_decomposition_panel(spread_picture, drawn[i], decompose(folder.sums[drawn[i].index]),
                               panel(i));
}

}  // namespace sweepd
