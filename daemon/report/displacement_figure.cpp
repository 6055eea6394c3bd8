#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/drawing/plot.hpp"
#include "daemon/report/figures.hpp"
#include "daemon/report/file_parts.hpp"
#include "daemon/text/numbers.hpp"

namespace sweepd {
namespace {

using Eigen::Vector3d;

constexpr std::array<const char*, 3> kAxisNames = {"X", "Y", "Z"};
constexpr double kSlices_px = 740;
constexpr double kLeftOfSlice = 58, kAboveSlice = 20, kBelowSlice = 40, kLegend_px = 34;

struct Displaced {
  Vector3d at, by;
  double size = 0;
  double band = 0;
};

/// The points of a slice, named as in the file; of the grid: no name.
struct DrawnSlice {
  std::vector<Displaced> points;
  double step = 0;  ///< between neighbours

  DrawnSlice(std::string_view csv, std::string_view name) {
    Cells cells;
    for (static_cast<void>(take_line(csv)); !csv.empty();) {
      cells.split(take_line(csv));
      if (cells[0] != name) continue;
      const auto vector = [&](std::size_t from) {
        return Vector3d(value_in(cells[from]), value_in(cells[from + 1]),
                        value_in(cells[from + 2]));
      };
      const Displaced point{vector(1), vector(4), value_in(cells[7]), value_in(cells[8])};
      if (point.at.allFinite() && point.by.allFinite() && std::isfinite(point.size))
        points.push_back(point);
    }
    for (const Displaced& point : points) {
      const double apart = (point.at - points.front().at).cwiseAbs().maxCoeff();
      if (apart > 0 && (step == 0 || apart < step)) step = apart;
    }
  }
};

struct DrawnSlices {
  std::array<DrawnSlice, 3> across;

  explicit DrawnSlices(std::string_view csv)
      : across{DrawnSlice(csv, "x"), DrawnSlice(csv, "y"), DrawnSlice(csv, "z")} {}

  /// Of all slices, so that one shade means one size.
  [[nodiscard]] double largest() const {
    double most = 1e-9;
    for (const DrawnSlice& slice : across)
      for (const Displaced& point : slice.points) most = std::max(most, point.size);
    return most;
  }
};

/// A round number no less than a sixth of the largest: what one shade stands for.
double shade_mm(double largest) {
  const double least = largest / kDepths;
  const double power = std::pow(10, std::floor(std::log10(least)));
  for (const double factor : {1.0, 1.5, 2.0, 3.0, 5.0})
    if (factor * power >= least) return factor * power;
  return 10 * power;
}

/// Cells shaded by how large the displacement is, with its direction within the plane; a dot where
/// it is no larger than its 95 % band.
void draw_slice(Picture& picture, const DrawnSlice& slice, std::size_t across, double width,
                double left, double shade) {
  const Eigen::Index u = across == 0 ? 1 : 0, v = across == 2 ? 1 : 2;
  Range over_u = Range::nothing(), over_v = Range::nothing();
  for (const Displaced& point : slice.points) {
    over_u.include(point.at(u));
    over_v.include(point.at(v));
  }
  const auto wider = [&](Range range) {
    return Range{range.low - slice.step / 2, range.high + slice.step / 2};
  };
  over_u = wider(over_u);
  over_v = wider(over_v);
  const double scale = width / std::max(over_u.size(), over_v.size());
  const Frame frame{left, kAboveSlice, scale * over_u.size(), scale * over_v.size()};
  const std::string u_title = std::string(kAxisNames.at(static_cast<std::size_t>(u))) + " mm",
                    v_title = std::string(kAxisNames.at(static_cast<std::size_t>(v))) + " mm";
  Plot plot(picture, frame, {.range = over_u, .title = u_title, .ticks = 4},
            {.range = over_v, .title = v_title, .ticks = 4});
  const double side = scale * slice.step;
  for (const Displaced& point : slice.points) {
    const Spot middle = plot.spot(point.at(u), point.at(v));
    plot.inside().bar({middle.x() - side / 2, middle.y() - side / 2, side, side},
                      depth_fill(static_cast<std::size_t>(point.size / shade)));
  }
  for (const Displaced& point : slice.points) {
    const Spot middle = plot.spot(point.at(u), point.at(v));
    if (point.size <= point.band) {
      plot.inside().circle(middle, 1.2, "");
      continue;
    }
    const Spot along = Spot(point.by(u), -point.by(v)) / (kDepths * shade) * 0.9 * side;
    plot.inside().line(middle, middle + along, "axis");
  }
  picture.words({frame.left, kAboveSlice - 6},
                fmt::format("{} = {:.0f} mm", kAxisNames.at(across),
                            slice.points.front().at(static_cast<Eigen::Index>(across))),
                Anchor::start, "strong");
}

void draw_legend(Picture& picture, double left, double top, double shade) {
  double x = left;
  const int decimals = std::max(0, 1 - static_cast<int>(std::floor(std::log10(shade))));
  for (std::size_t depth = 0; depth < kDepths; ++depth) {
    picture.bar({x, top, 16, 12}, depth_fill(depth));
    const auto from = static_cast<double>(depth);
    const std::string text = fixed(from * shade, decimals);
    picture.words({x + 19, top + 10}, text, Anchor::start, "small");
    x += 24 + 6 * static_cast<double>(text.size());
  }
  picture.words({x, top + 10}, "mm and more", Anchor::start, "small");
}

double height_of(const DrawnSlice& slice, std::size_t across, double width) {
  Range over_u = Range::nothing(), over_v = Range::nothing();
  for (const Displaced& point : slice.points) {
    over_u.include(point.at(across == 0 ? 1 : 0));
    over_v.include(point.at(across == 2 ? 1 : 2));
  }
  const double u = over_u.size() + slice.step, v = over_v.size() + slice.step;
  return width / std::max(u, v) * v;
}

}  // namespace

void add_displacement(Markup parent, const ReportFolder& folder) {
  const DrawnSlices slices(folder.displacement_csv);
  const DrawnSlice grid(folder.displacement_csv, "");
  std::vector<std::size_t> drawn;
  for (std::size_t across = 0; across < 3; ++across)
    if (!slices.across.at(across).points.empty()) drawn.push_back(across);
  if (drawn.empty() || grid.points.empty()) return;
  const Displaced* most = &grid.points.front();
  const auto look = [&most](const DrawnSlice& points) {
    for (const Displaced& point : points.points)
      if (point.size > most->size) most = &point;
  };
  look(grid);
  for (const DrawnSlice& slice : slices.across) look(slice);
  double squares = 0;
  for (const Displaced& point : grid.points) squares += point.size * point.size;
  auto figure = add_figure(
      parent, "From the specification to the arm that was identified",
      fmt::format(
          "how far the first target stands off, base and tool fitted: {:.3f} mm root mean "
          "square at {} points of the workspace. The largest of these and of the slices is "
          "{:.3f} ± {:.3f} mm (95 %) at X {:.0f}, Y {:.0f}, Z {:.0f} mm of the robot's base. The "
          "slices go "
          "through the target at home. "
          "A line in each cell shows the direction of the displacement. It is as long as the cell "
          "where the displacement is that of the darkest shade. A dot stands where the "
          "displacement is no larger than its 95 % band. displacement.csv has all of it.",
          std::sqrt(squares / static_cast<double>(grid.points.size())), grid.points.size(),
          most->size, most->band, most->at.x(), most->at.y(), most->at.z()));
  const double each = kSlices_px / 3;
  const double width = each - kLeftOfSlice - 6;
  double height = 0;
  for (const std::size_t across : drawn)
    height = std::max(height, height_of(slices.across.at(across), across, width));
  Picture picture(figure, kSlices_px, kAboveSlice + height + kBelowSlice + kLegend_px,
                  "Displacement over three planes of the workspace");
  const double shade = shade_mm(slices.largest());
  for (std::size_t k = 0; k < drawn.size(); ++k)
    draw_slice(picture, slices.across.at(drawn[k]), drawn[k], width,
               each * static_cast<double>(k) + kLeftOfSlice, shade);
  draw_legend(picture, kLeftOfSlice, kAboveSlice + height + kBelowSlice, shade);
}

std::string displacement_svg(std::string_view displacement_csv, std::size_t across) {
  const DrawnSlices slices(displacement_csv);
  const DrawnSlice& slice = slices.across.at(across);
  if (slice.points.empty()) return {};
  constexpr double kAlone = 420;
  const double height = height_of(slice, across, kAlone);
  pugi::xml_document document;
  Picture picture(Markup(document.root()), kLeftOfSlice + kAlone + 20,
                  kAboveSlice + height + kBelowSlice + kLegend_px,
                  "Displacement from the specification to the identified arm");
  const double shade = shade_mm(slices.largest());
  draw_slice(picture, slice, across, kAlone, kLeftOfSlice, shade);
  draw_legend(picture, kLeftOfSlice, kAboveSlice + height + kBelowSlice, shade);
  auto svg = document.first_child();
  svg.prepend_child("style").text() =
      (":root{color-scheme:light dark;color:#1a1a1a;background:#fff}"
       "@media (prefers-color-scheme:dark){:root{color:#e6e6e6;background:#16181b}}" +
       drawing_style())
          .c_str();
  std::ostringstream text;
  svg.print(text, "", pugi::format_raw);
  return text.str() + '\n';
}

}  // namespace sweepd
