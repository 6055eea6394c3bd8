#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

#include "daemon/drawing/view.hpp"
#include "daemon/report/figures.hpp"
#include "daemon/report/joint_shapes.hpp"
#include "daemon/text/numbers.hpp"
#include "identify/geometry/symmetric_eigen.hpp"

namespace sweepd {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

/// The frame of the decomposition of the points of a joint, eq. (3).
struct Decomposition {
  Vector3d mean = JointShape::kNowhere;
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
  view.fit(all, frame.within(26));
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

/// Of the target that `found` is of.
Points points_of(const ReportFolder& folder, std::size_t joint) {
  Points points;
  for (const Stroke& stroke : folder.strokes)
    if (stroke.joint == joint && stroke.target == folder.sums[joint].target)
      for (const StrokePoint& point : stroke.points) points.push_back(point.position_mm);
  return points;
}

void draw_decomposition_panel(Picture& picture, std::size_t joint, const Points& points,
                              const Decomposition& found, const Frame& frame) {
  picture.words({frame.left, frame.top - 5}, "Joint " + std::to_string(joint + 1), Anchor::start,
                "strong");
  picture.bar(frame, "hollow axis");
  // The longest axis is drawn as long as the points reach, the others in proportion.
  Points places;
  double reach = 0;
  for (const Vector3d& point : points) {
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
  view.fit(all, Frame{frame.left, frame.top, frame.width, frame.height - 38}.within(22));
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

void add_circle_figures(Markup parent, const ReportFolder& folder) {
  std::vector<JointShape> drawn;
  for (auto& shape : joint_shapes(folder))
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
      "arrow is an axis that is too short to be seen: V₃ is the normal of the plane. Where there "
      "are several targets, it is the first.");
  Picture spread_picture(spread, kPanelsWidth, panels_height(drawn.size()),
                         "points and singular values of each joint");
  for (std::size_t i = 0; i < drawn.size(); ++i)
    if (const std::size_t joint = drawn[i].index; joint < folder.sums.size())
      draw_decomposition_panel(spread_picture, joint, points_of(folder, joint),
                               decompose(folder.sums[joint]), panel(i));
}

}  // namespace sweepd
