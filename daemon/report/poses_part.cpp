#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/drawing/picture.hpp"
#include "daemon/report/report_parts.hpp"
#include "daemon/text/numbers.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

struct Level {
  std::string free;
  double mean_mm, rms_mm, max_mm;
};

Level level_of(const Json& json, std::string free) {
  return {std::move(free), number_of(json, "mean_mm"), number_of(json, "rms_mm"),
          number_of(json, "max_mm")};
}

std::vector<Level> levels_of(const Json& poses) {
  std::vector<Level> levels;
  for (const Json& level : list_of(poses, "levels"))
    levels.push_back(level_of(level, text_of(level, "free")));
  levels.push_back(level_of(part_of(poses, "left"), "all that the result tells"));
  std::erase_if(levels, [](const Level& level) { return !std::isfinite(level.mean_mm); });
  return levels;
}

/// A bar a level for the mean, with a line to the largest.
void draw_levels(Markup figure, const std::vector<Level>& levels) {
  constexpr double kWidth = 740;
  constexpr double kNames = 190;
  constexpr double kRow = 22;
  double most = 1e-9;
  for (const Level& level : levels) most = std::max(most, level.max_mm);
  Picture picture(figure, kWidth, kRow * static_cast<double>(levels.size()) + 8,
                  "What each level of correction leaves of the poses");
  const double scale = (kWidth - kNames - 180) / most;
  double y = 4;
  for (const Level& level : levels) {
    const double middle = y + kRow / 2;
    picture.words({kNames - 8, middle + 4}, level.free, Anchor::end, "small");
    picture.bar({kNames, y + 4, std::max(0.5, scale * level.mean_mm), kRow - 8}, joint_fill(0));
    picture.line({kNames + scale * level.mean_mm, middle}, {kNames + scale * level.max_mm, middle},
                 "axis");
    picture.words({kNames + scale * level.max_mm + 6, middle + 4},
                  fmt::format("mean {:.3f}, largest {:.3f} mm", level.mean_mm, level.max_mm),
                  Anchor::start, "small");
    y += kRow;
  }
}

void add_row(Markup body, const std::vector<std::string>& cells, std::size_t words) {
  auto row = body.add("tr");
  for (std::size_t k = 0; k < cells.size(); ++k)
    if (k < words)
      row.put("td", cells[k]);
    else
      row.put("td", cells[k], {{"class", "number"}});
}

Markup add_table(Markup parent, const std::vector<std::string>& heads, std::size_t words) {
  auto table = parent.add("table");
  auto row = table.add("thead").add("tr");
  for (std::size_t k = 0; k < heads.size(); ++k)
    if (k < words)
      row.put("th", heads[k]);
    else
      row.put("th", heads[k], {{"class", "number"}});
  return table.add("tbody");
}

void add_effects(Markup parent, const Json& effects) {
  if (effects.empty()) return;
  parent.put("h3", "What joints do beside what their angles say");
  auto body = add_table(parent, {"joint", "what", "size", "1 sigma", "by chance"}, 2);
  for (const Json& effect : effects) {
    const std::string kind = text_of(effect, "kind");
    const std::string joint = fmt::format("{}", number_of(effect, "joint"));
    const std::string chance = fmt::format("{:.1e}", number_of(effect, "chance"));
    if (kind == "compliance") {
      add_row(
          body,
          {joint, "gives way by its load", fixed(number_of(effect, "urad_per_nm"), 3) + " µrad/Nm",
           fixed(number_of(effect, "sigma_urad_per_nm"), 3), chance},
          2);
      continue;
    }
    const std::string what = kind == "weight" ? fmt::format("gives way by the weight of link {}",
                                                            number_of(effect, "link_of_joint"))
                             : kind == "once_a_turn" ? "once a turn"
                                                     : "twice a turn";
    const double size =
        std::hypot(number_of(effect, "cos_arcsec"), number_of(effect, "sin_arcsec"));
    const double sigma =
        std::max(number_of(effect, "cos_sigma_arcsec"), number_of(effect, "sin_sigma_arcsec"));
    add_row(body, {joint, what, fixed(size, 1) + " arcsec", fixed(sigma, 1), chance}, 2);
  }
}

}  // namespace

void add_poses(Markup parent, const ReportFolder& folder) {
  const Json& poses = part_of(folder.result, "poses");
  const auto levels = levels_of(poses);
  if (levels.empty()) return;
  const Json& noise = part_of(poses, "noise");
  auto figure = add_figure(
      parent, "What each level of correction leaves",
      fmt::format("of {} static poses: the mean distance between seen and fitted (bar), and the "
                  "largest (line). One pose is uncertain by {:.4f} mm in each coordinate and by "
                  "{:.2f} arcsec in each joint (1 sigma).",
                  number_of(poses, "count"), number_of(noise, "position_mm"),
                  number_of(noise, "joint_arcsec")));
  draw_levels(figure, levels);
  auto body = add_table(figure, {"what is let go", "mean mm", "rms mm", "max mm"}, 1);
  for (const Level& level : levels)
    add_row(body,
            {level.free, fixed(level.mean_mm, 4), fixed(level.rms_mm, 4), fixed(level.max_mm, 4)},
            1);
  add_effects(parent, list_of(poses, "effects"));
}

}  // namespace sweepd
