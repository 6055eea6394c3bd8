#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/drawing/picture.hpp"
#include "daemon/report/file_parts.hpp"
#include "daemon/report/report_parts.hpp"
#include "daemon/text/numbers.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDifferences_px = 740, kNumberNames_px = 80, kNumberRow_px = 16, kAboveNumbers = 6,
                 kBelowNumbers = 30;
/// Differences farther off, in their uncertainty U, are drawn at the edge.
constexpr double kMostDrawn = 6;

struct ChangedNumber {
  std::string name, unit;
  double difference, expanded, smallest;
  int decimals;
  bool changed;
};

std::vector<ChangedNumber> numbers_of_change(const Json& change) {
  std::vector<ChangedNumber> all;
  for (const Json& json : list_of(change, "numbers")) {
    const std::string name = text_of(json, "name");
    const auto unit = name.rfind('_');
    if (unit == std::string::npos) continue;
    ChangedNumber number{name.substr(0, unit),
                         name.substr(unit + 1),
                         number_of(json, "difference"),
                         kCoverage * number_of(json, "sigma"),
                         number_of(json, "smallest_change"),
                         kMostOfChange,
                         flag_of(json, "changed")};
    if (std::isfinite(number.difference) && number.expanded > 0) all.push_back(number);
  }
  // As many for all of a unit as the best known one has.
  std::map<std::string, double> least;
  for (const ChangedNumber& number : all) {
    double& of_unit = least.try_emplace(number.unit, 1.0).first->second;
    of_unit = std::min(of_unit, number.expanded);
  }
  for (ChangedNumber& number : all)
    number.decimals = decimals_for(least.at(number.unit), kFewestOfChange, kMostOfChange);
  return all;
}

/// Each difference with its interval, in its own U: what leaves the band is larger than noise
/// is, as a rule.
void draw_differences(Markup figure, const std::vector<ChangedNumber>& numbers) {
  const double height = kAboveNumbers + kNumberRow_px * static_cast<double>(numbers.size());
  Picture picture(figure, kDifferences_px, height + kBelowNumbers,
                  "Differences in their uncertainties");
  const double middle = kNumberNames_px + (kDifferences_px - kNumberNames_px) / 2;
  const double each = (kDifferences_px - kNumberNames_px - 40) / (2 * kMostDrawn);
  picture.line({middle, kAboveNumbers}, {middle, height}, "zero");
  for (const double side : {-1.0, 1.0})
    picture.line({middle + side * each, kAboveNumbers}, {middle + side * each, height}, "limit");
  for (int tick = -5; tick <= 5; ++tick)
    picture.words({middle + each * tick, height + 12}, std::to_string(tick), Anchor::middle,
                  "small");
  picture.words({middle, height + 26},
                "B - A, in its expanded uncertainty U; farther ones at the edge", Anchor::middle);
  double y = kAboveNumbers + kNumberRow_px / 2;
  for (const ChangedNumber& number : numbers) {
    const auto at = [&](double value) {
      return middle + each * std::clamp(value / number.expanded, -kMostDrawn, kMostDrawn);
    };
    const std::string kind = number.changed ? joint_line(1) + " whole" : "hair";
    picture.words({kNumberNames_px, y + 3}, number.name, Anchor::end,
                  number.changed ? "strong" : "small");
    picture.line({at(number.difference - number.expanded), y},
                 {at(number.difference + number.expanded), y}, kind);
    picture.circle({at(number.difference), y}, number.changed ? 4 : 2.5,
                   number.changed ? joint_fill(1) : "");
    y += kNumberRow_px;
  }
}

std::string displacement_words(const Json& json) {
  return fmt::format("{:.4f} mm (95 %: {:.4f} to {:.4f})", number_of(json, "largest_mm"),
                     number_of(json, "low_mm"), number_of(json, "high_mm"));
}

std::string change_words(const Json& change, const std::vector<ChangedNumber>& numbers) {
  std::string text;
  for (const ChangedNumber& number : numbers)
    if (number.changed)
      text += fmt::format("{}{} by {:+.{}f} {}", text.empty() ? "" : ", ", number.name,
                          number.difference, number.decimals, number.unit);
  if (text_of(change, "verdict") != "changed")
    text = "No change is seen.";
  else
    text = text.empty() ? "Changed, though no number alone tells what." : "Changed: " + text + ".";
  text += fmt::format(
      " T² = {:.1f} of {:.0f} numbers; {} of pairs of unchanged robots differ at least as much.",
      number_of(change, "t_squared"), number_of(change, "degrees_of_freedom"),
      share_text(number_of(change, "p")));
  const Json& named = part_of(change, "displacement_by_changes");
  if (named.is_object())
    text += " The tool is moved by up to " + displacement_words(named) +
            " by the named changes; by all differences, noise included, by up to ";
  else
    text += " By all differences, noise included, the tool is moved by up to ";
  return text + displacement_words(part_of(change, "displacement")) + ", base and tool fitted.";
}

void add_change_table(Markup parent, const std::vector<ChangedNumber>& numbers) {
  auto table = parent.add("table");
  auto head = table.add("thead").add("tr");
  for (const char* title : {"number", "unit"}) head.put("th", title);
  for (const char* title : {"B - A", "U", "smallest seen"})
    head.put("th", title, {{"class", "number"}});
  head.put("th", "verdict");
  auto body = table.add("tbody");
  for (const ChangedNumber& number : numbers) {
    auto row = body.add("tr");
    row.put("td", number.name).put("td", number.unit);
    for (const double value : {number.difference, number.expanded, number.smallest})
      row.put("td", fixed(value, number.decimals), {{"class", "number"}});
    row.put("td", number.changed ? "changed" : "-");
  }
}

}  // namespace

void add_changes(Markup parent, std::span<const Comparison> comparisons) {
  for (const Comparison& one : comparisons) {
    const std::string title = "From " + one.first + " (A) to " + one.second + " (B)";
    if (!one.change.is_object()) {
      parent.put("h3", title);
      parent.put("p", "Not compared: " + one.why_not, {{"class", "note"}});
      continue;
    }
    const auto numbers = numbers_of_change(one.change);
    auto figure = add_figure(parent, title, change_words(one.change, numbers));
    draw_differences(figure, numbers);
    add_change_table(figure, numbers);
    for (const Json& note : list_of(one.change, "notes"))
      if (note.is_string()) figure.put("p", note.get<std::string>(), {{"class", "note"}});
    figure.put("p",
               "zero: theta minus the controller's angle at home. U: expanded uncertainty of B - A "
               "(k = 2). Smallest seen: a change of this number alone that would be named in 80 % "
               "of cases.",
               {{"class", "fine"}});
  }
}

}  // namespace sweepd
