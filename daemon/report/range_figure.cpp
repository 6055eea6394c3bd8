#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/drawing/view.hpp"
#include "daemon/report/figures.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/text_layout.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

using Eigen::Vector3d;

/// The eight corners of a box; bit k of a corner's number tells which end along axis k.
using Corners = std::array<Vector3d, 8>;

std::optional<Corners> corners_of(const Json& box) {
  if (!box.is_object()) return std::nullopt;
  const Vector3d centre = vector_of(part_of(box, "center"));
  const Vector3d lengths = vector_of(part_of(box, "lengths_mm"));
  Eigen::Matrix3d axes;
  const Json rows = part_of(box, "orientation");
  if (!rows.is_array() || rows.size() != 3) return std::nullopt;
  for (int k = 0; k < 3; ++k)
    axes.row(k) = vector_of(rows[static_cast<std::size_t>(k)]).transpose();
  if (!centre.allFinite() || !lengths.allFinite() || !axes.allFinite()) return std::nullopt;
  Corners corners;
  for (unsigned c = 0; c < 8; ++c) {
    const Vector3d half(c & 1U ? 0.5 : -0.5, c & 2U ? 0.5 : -0.5, c & 4U ? 0.5 : -0.5);
    corners[c] = centre + axes * lengths.cwiseProduct(half);
  }
  return corners;
}

void draw_box(Picture& picture, const View& view, const Corners& corners, std::string_view kind) {
  for (unsigned c = 0; c < 8; ++c)
    for (const unsigned bit : {1U, 2U, 4U})
      if (!(c & bit)) picture.line(view.spot(corners[c]), view.spot(corners[c | bit]), kind);
}

void draw_range(Picture& picture, const ReportFolder& folder, const Frame& frame) {
  picture.bar(frame, "hollow axis");
  const auto whole = corners_of(part_of(folder.result, "bounding_box"));
  std::vector<Vector3d> all;
  if (whole) all.assign(whole->begin(), whole->end());
  for (const Stroke& stroke : folder.strokes)
    for (const StrokePoint& point : stroke.points) all.push_back(point.position_mm);
  View view = View::oblique();
  constexpr double kRoom = 22;
  view.fit(all, frame.within(kRoom));
  if (whole) draw_box(picture, view, *whole, "axis");
  std::size_t index = 0;
  for (const Json& joint : list_of(folder.result, "joints")) {
    if (const auto box = corners_of(part_of(joint, "bounding_box")))
      draw_box(picture, view, *box, joint_line(index) + " hair whole");
    ++index;
  }
  for (std::size_t j = 0; j < index; ++j) {
    std::vector<Spot> spots;
    for (const Stroke& stroke : folder.strokes)
      if (stroke.joint == j)
        for (const StrokePoint& point : stroke.points)
          spots.push_back(view.spot(point.position_mm));
    picture.dots(spots, joint_dots(j));
    if (!spots.empty())
      picture.words(spots[spots.size() / 2] + Spot(6, -5), "A" + std::to_string(j + 1),
                    Anchor::start, "strong");
  }
}

/// Of the joints that turn, or of the linear ones; empty where none has swept.
std::string range_of(const ReportFolder& folder, bool linear) {
  double least = 0;
  double most = 0;
  const Json joints = list_of(folder.result, "joints");
  for (const Stroke& stroke : folder.strokes) {
    if (stroke.points.empty() || stroke.joint >= joints.size() ||
        is_linear(joints[stroke.joint]) != linear)
      continue;
    const double range = std::abs(stroke.points.back().angle - stroke.points.front().angle);
    if (!(range > 0)) continue;
    least = least == 0 ? range : std::min(least, range);
    most = std::max(most, range);
  }
  if (most == 0) return {};
  const std::string highest = fixed(most, 0);
  const std::string lowest = fixed(least, 0);
  return (lowest == highest ? "" : lowest + " to ") + highest + (linear ? " mm" : "°");
}

std::string title_of(const ReportFolder& folder) {
  if (folder.strokes.empty()) return folder.name + ": no sweeps";
  const std::string turns = range_of(folder, false);
  const std::string ways = range_of(folder, true);
  if (turns.empty() && ways.empty()) return folder.name;
  return folder.name + ": sweeps of " + turns + (turns.empty() || ways.empty() ? "" : ", ") + ways;
}

std::string cell(double value, int decimals) {
  return std::isfinite(value) ? fixed(value, decimals) : "–";
}

void add_boxes_table(Markup figure, std::span<const ReportFolder> folders) {
  auto table = figure.add("table");
  table.put("caption",
            "As table 4 of the paper: the smallest box that holds the points of all "
            "circles and lines. The "
            "columns of the orientation are the box's axes, the longest first.");
  auto head = table.add("thead").add("tr");
  head.put("th", "", {{"scope", "col"}});
  for (const ReportFolder& folder : folders) head.put("th", folder.name, {{"scope", "col"}});
  auto body = table.add("tbody");
  const auto row = [&](const char* title, const auto& text, const char* kind = "number") {
    auto line = body.add("tr");
    line.put("th", title, {{"scope", "row"}});
    for (const ReportFolder& folder : folders) {
      const Json box = part_of(folder.result, "bounding_box");
      line.put("td", box.is_object() ? text(box) : std::string("–"), {{"class", kind}});
    }
  };
  static constexpr std::array<const char*, 3> kLengths{"l₁, mm", "l₂, mm", "l₃, mm"};
  for (int k = 0; k < 3; ++k)
    row(kLengths[static_cast<std::size_t>(k)],
        [&](const Json& box) { return cell(vector_of(part_of(box, "lengths_mm"))(k), 3); });
  row("volume, m³", [](const Json& box) { return cell(number_of(box, "volume_m3"), 6); });
  for (std::size_t k = 0; k < 3; ++k)
    row(
        k == 1 ? "orientation" : "",
        [&](const Json& box) {
          const Json rows = part_of(box, "orientation");
          if (!rows.is_array() || rows.size() != 3) return std::string("–");
          const Vector3d line = vector_of(rows[k]);
          std::string text;
          for (const double component : line) text += right(cell(component, 3), 8);
          return text;
        },
        "number vector");
}

}  // namespace

void add_range_figure(Markup parent, std::span<const ReportFolder> folders) {
  const bool any = std::any_of(folders.begin(), folders.end(),
                               [](const auto& folder) { return !folder.strokes.empty(); });
  if (!any) return;
  auto figure = add_figure(
      parent, "Range of motion provided to each joint.",
      "As figure 8 of the paper: the measured points of each joint in their smallest box, and the "
      "smallest box that holds all of them. Each picture has a scale of its own.");
  constexpr double kPanelWidth = 346;
  constexpr double kHeight = 300;
  constexpr double kGap = 14;
  const std::size_t in_row = std::min<std::size_t>(folders.size(), 2);
  const auto rows = static_cast<double>((folders.size() + 1) / 2);
  Picture picture(figure, 2 * kPanelWidth + kGap + 2, rows * (kHeight + 30),
                  "points of all joints in their smallest boxes");
  for (std::size_t i = 0; i < folders.size(); ++i) {
    const double width = folders.size() == 1 ? 2 * kPanelWidth + kGap : kPanelWidth;
    const Frame frame{1 + static_cast<double>(i % in_row) * (kPanelWidth + kGap),
                      static_cast<double>(i / in_row) * (kHeight + 30) + 18, width, kHeight};
    picture.words({frame.left, frame.top - 5}, title_of(folders[i]), Anchor::start, "strong");
    draw_range(picture, folders[i], frame);
  }
  add_boxes_table(figure, folders);
}

}  // namespace sweepd
