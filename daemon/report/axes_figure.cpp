#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/drawing/plot.hpp"
#include "daemon/drawing/view.hpp"
#include "daemon/report/figures.hpp"
#include "daemon/report/joint_shapes.hpp"
#include "daemon/text/numbers.hpp"

namespace sweepd {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

/// A circle with a smaller diameter than so many px has an inset.
constexpr double kTooSmall_px = 36;

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

/// The joints' names within a frame, each beside the tip of its normal or its centre, where no
/// other name is.
void name_joints(Picture& picture, const View& view, const std::vector<JointShape>& shapes,
                 double axis_length, const Frame& frame) {
  constexpr double kWidth_px = 28, kHeight_px = 10;
  std::vector<Spot> taken;
  for (const JointShape& shape : shapes) {
    if (!shape.centre.allFinite() && !shape.on_axis.allFinite()) continue;
    const Vector3d tip = shape.centre.allFinite()
                             ? Vector3d(shape.centre + 0.8 * axis_length * shape.normal)
                             : Vector3d(shape.on_axis + axis_length * shape.along_axis);
    const Spot beside = view.spot(tip) + Spot(5, -4);
    Spot at(std::clamp(beside.x(), frame.left + 2, frame.right() - kWidth_px),
            std::clamp(beside.y(), frame.top + kHeight_px, frame.bottom() - 3));
    const double way = at.y() + 6 * kHeight_px > frame.bottom() ? -11 : 11;
    for (std::size_t tries = 0; tries < 12; ++tries) {
      const bool free = std::none_of(taken.begin(), taken.end(), [&](const Spot& other) {
        return std::abs(other.x() - at.x()) < kWidth_px && std::abs(other.y() - at.y()) < 11;
      });
      if (free) break;
      at.y() += way;
    }
    taken.push_back(at);
    picture.words(at, "A" + std::to_string(shape.index + 1), Anchor::start, "strong");
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
                const Points& arm, double axis_length, const Frame& frame) {
  picture.path(view.spots(arm), "arm");
  for (const JointShape& shape : shapes) draw_joint(picture, view, shape, axis_length);
  name_joints(picture, view, shapes, axis_length, frame);
}

void draw_flat_view(Picture& picture, View view, const Frame& frame, const char* title,
                    const std::array<const char*, 2>& axes, const std::vector<JointShape>& shapes,
                    const Points& arm, const Points& extent, double axis_length) {
  constexpr double kRoom = 14;
  view.fit(extent, frame.within(kRoom));
  const Eigen::Vector2d low = view.place({frame.left, frame.bottom()});
  const Eigen::Vector2d high = view.place({frame.right(), frame.top});
  Plot plot(picture, frame, {{low.x(), high.x()}, axes[0], false, 5},
            {{low.y(), high.y()}, axes[1], false, 5});
  draw_space(plot.inside(), view, shapes, arm, axis_length, frame);
  picture.words({frame.left, frame.top - 6}, title, Anchor::start, "strong");
}

}  // namespace

void add_axes_figure(Markup parent, const ReportFolder& folder) {
  const auto shapes = joint_shapes(folder);
  const Points arm = arm_at_home(folder, shapes);
  const Points extent = extent_of(shapes, arm);
  if (extent.empty()) return;
  const Ball ball = ball_around(extent);
  const double axis_length = 0.22 * ball.radius;
  const bool circles = std::any_of(shapes.begin(), shapes.end(),
                                   [](const auto& shape) { return !shape.circle.empty(); });
  auto figure = add_figure(
      parent, circles ? "Fitted circle for each joint motion." : "The joints' axes.",
      std::string(circles
                      ? "As figure 7 of the paper: each circle is drawn whole, the range that was "
                        "moved is thick. A dot is a centre, an arrow a normal, a thin line a "
                        "joint's axis."
                      : "A thin line is a joint's axis at home. No joint was swept by itself, so "
                        "there are no circles.") +
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
  whole.fit(extent, last.within(20));
  for (const JointShape& shape : shapes)
    if (shape.radius > 0 && 2 * shape.radius * whole.scale() < kTooSmall_px) small.push_back(shape);
  constexpr double kInset = 130;
  const double height = 46 + 2 * kHeight + 50 + 40 + (small.empty() ? 0 : kInset + 30);
  Picture picture(figure, kSecond + kWidth + 20, height,
                  circles
                      ? "fitted circles of all joints from above, front, side and in perspective"
                      : "axes of all joints from above, front, side and in perspective");
  draw_flat_view(picture, View::top(), {kLeft, 20, kWidth, kHeight}, "From above",
                 {"X, mm", "Y, mm"}, shapes, arm, extent, axis_length);
  draw_flat_view(picture, View::front(), {kSecond, 20, kWidth, kHeight}, "From the front",
                 {"X, mm", "Z, mm"}, shapes, arm, extent, axis_length);
  draw_flat_view(picture, View::side(), {kLeft, last.top, kWidth, kHeight}, "From the side",
                 {"Y, mm", "Z, mm"}, shapes, arm, extent, axis_length);
  picture.words({last.left, last.top - 6}, "In perspective", Anchor::start, "strong");
  draw_space(picture, whole, shapes, arm, axis_length, last);
  draw_triad(picture, whole, {last.left + 26, last.bottom() + 16});
  for (std::size_t i = 0; i < small.size() && i < 5; ++i) {
    const Frame inset{kLeft + static_cast<double>(i) * (kInset + 10), height - kInset - 4, kInset,
                      kInset};
    View view = View::oblique();
    view.fit(small[i].circle, inset.within(26));
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

}  // namespace sweepd
