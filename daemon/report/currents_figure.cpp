#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/drawing/plot.hpp"
#include "daemon/report/figures.hpp"
#include "daemon/report/file_parts.hpp"
#include "daemon/text/numbers.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kPlotsAcross = 3;
constexpr double kPlotWidth = 245, kPlotHeight = 150, kLeftOfPlot = 46, kAbovePlot = 18,
                 kBelowPlot = 36;

struct Curves {
  std::vector<std::pair<double, double>> rising, falling;
};

std::map<int, Curves> curves_in(std::string_view csv) {
  std::map<int, Curves> all;
  Cells cells;
  for (static_cast<void>(take_line(csv)); !csv.empty();) {
    cells.split(take_line(csv));
    const double joint = value_in(cells[0]), angle = value_in(cells[1]);
    if (!(joint >= 1 && joint < 64) || !std::isfinite(angle)) continue;
    Curves& curves = all[static_cast<int>(joint)];
    // Not a number is a gap in the line.
    curves.rising.emplace_back(angle, value_in(cells[2]));
    curves.falling.emplace_back(angle, value_in(cells[3]));
  }
  return all;
}

void draw_currents(Picture& picture, int joint, const Curves& curves, const Frame& frame) {
  Range x = Range::nothing(), y = Range::nothing();
  for (const auto* line : {&curves.rising, &curves.falling})
    for (const auto& [angle, current] : *line) {
      if (!std::isfinite(current)) continue;
      x.include(angle);
      y.include(current);
    }
  if (x.empty()) return;
  Plot plot(picture, frame, {.range = x.widened(0.02), .title = "deg", .ticks = 4},
            {.range = y.widened(0.08), .title = "A", .ticks = 4});
  const auto index = static_cast<std::size_t>(joint - 1);
  plot.line(curves.rising, joint_line(index) + " whole");
  plot.line(curves.falling, joint_line(index) + " limit");
  picture.words({frame.left, frame.top - 5}, fmt::format("joint {}", joint), Anchor::start,
                "strong");
}

void add_friction(Markup figure, const Json& joints) {
  auto table = figure.add("table");
  auto head = table.add("thead").add("tr");
  for (const char* title : {"joint", "friction A", "scatter A", "places", "speed deg/s"})
    head.put("th", title, {{"class", "number"}});
  auto body = table.add("tbody");
  for (const Json& joint : joints) {
    auto row = body.add("tr");
    const auto put = [&](const char* key, int decimals) {
      const double value = number_of(joint, key);
      row.put("td", std::isfinite(value) ? fixed(value, decimals) : "-", {{"class", "number"}});
    };
    put("joint", 0);
    put("friction_a", 3);
    put("scatter_a", 3);
    put("places", 0);
    put("speed_deg_s", 1);
  }
}

}  // namespace

void add_currents(Markup parent, const ReportFolder& folder) {
  const auto curves = curves_in(folder.currents_csv);
  if (curves.empty()) return;
  auto figure = add_figure(
      parent, "Motor current over the angle",
      "of each joint while it alone moved at a steady speed: rising (whole line) and falling "
      "(dashed). Half the difference is friction, the mean is weight. Scatter is the standard "
      "deviation from place to place. Units are those of the controller: ampere by KUKA's RSI. "
      "Friction depends on speed, temperature and load: compare like with like.");
  const auto rows = static_cast<double>((curves.size() + kPlotsAcross - 1) / kPlotsAcross);
  const double each = kAbovePlot + kPlotHeight + kBelowPlot;
  Picture picture(figure, kPlotWidth * kPlotsAcross, each * rows, "Motor current of each joint");
  std::size_t k = 0;
  for (const auto& [joint, lines] : curves) {
    const double left = kPlotWidth * static_cast<double>(k % kPlotsAcross) + kLeftOfPlot;
    const double top = each * static_cast<double>(k / kPlotsAcross) + kAbovePlot;
    draw_currents(picture, joint, lines, {left, top, kPlotWidth - kLeftOfPlot - 8, kPlotHeight});
    ++k;
  }
  add_friction(figure, list_of(folder.result, "currents"));
}

}  // namespace sweepd
