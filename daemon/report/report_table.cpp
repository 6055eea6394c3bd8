#include "daemon/report/report_table.hpp"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "daemon/drawing/picture.hpp"
#include "daemon/text/numbers.hpp"
#include "identify/dh/dh_extraction.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMostMmDecimals = 6;  // those of the files
constexpr int kMostDegDecimals = 7;
constexpr int kUsualDecimals = 3;

std::optional<double> known(const Json& row, const std::string& key) {
  const double value = number_of(row, key);
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

const Json& row_of(const Json& result, const char* table, std::size_t index) {
  static const Json kNone;
  const Json& rows = list_of(result, table);
  return index < rows.size() ? rows.at(index) : kNone;
}

bool is_set(const Json& row, const std::string& key) {
  const Json& names = list_of(row, "by_convention");
  return std::find(names.begin(), names.end(), key) != names.end();
}

int most_decimals(const DhLine& line) {
  return line.unit == "mm" ? kMostMmDecimals : kMostDegDecimals;
}

constexpr double kIntervalWidth = 120;
constexpr double kIntervalHeight = 14;

/// The difference with its expanded uncertainty, beside zero; each row at its own scale.
void add_interval(Markup cell, const DhLine& line) {
  if (!line.difference || !line.sigma) return;
  const double u = kCoverage * *line.sigma;
  const double reach = std::max(std::abs(*line.difference) + u, 1e-12);
  const bool beyond = std::abs(*line.difference) > u;
  const double middle = kIntervalWidth / 2;
  const double y = kIntervalHeight / 2;
  const auto at = [&](double value) { return middle + value / reach * (middle - 5); };
  Picture picture(cell, kIntervalWidth, kIntervalHeight,
                  beyond ? "the interval does not hold zero" : "the interval holds zero");
  picture.line({0, y}, {kIntervalWidth, y}, "grid");
  picture.line({middle, 1}, {middle, kIntervalHeight - 1}, "zero");
  const double low = at(*line.difference - u);
  const double high = at(*line.difference + u);
  picture.bar({low, y - 3, std::max(high - low, 0.5), 6}, beyond ? "plain" : "hollow");
  picture.circle({at(*line.difference), y}, 2, beyond ? "hollow" : "");
}

}  // namespace

std::vector<DhLine> dh_lines(const ReportFolder& folder) {
  std::vector<DhLine> lines;
  const Json& table = list_of(folder.result, "dh");
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Json& row = table.at(i);
    const Json& specified = row_of(folder.result, "specified", i);
    const Json& difference = row_of(folder.result, "difference", i);
    for (const auto& of : identify::kDhNumbers) {
      const std::string key = fmt::format("{}_{}", of.name, of.unit());
      if (!row.is_object() || !row.contains(key)) continue;
      DhLine line{i + 1, std::string(of.symbol), std::string(of.unit()), known(row, key), {}, {},
                  {}};
      line.sigma = known(row, fmt::format("{}_sigma_{}", of.name, of.unit()));
      line.difference = known(difference, key);
      line.specified = known(specified, key);
      if (!line.specified && line.difference) line.specified = 0;  // a described table has no beta
      line.by_convention = is_set(row, key);
      line.relation = text_of(row, "relation");
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

Departures departures(const std::vector<DhLine>& lines) {
  Departures found;
  double largest = 1;
  for (const DhLine& line : lines) {
    if (!line.difference || !line.sigma || line.by_convention) continue;
    ++found.numbers;
    const double u = kCoverage * *line.sigma;
    if (std::abs(*line.difference) <= u) continue;
    ++found.beyond;
    const double size = u > 0 ? std::abs(*line.difference) / u : HUGE_VAL;
    if (size <= largest) continue;
    largest = size;
    found.largest = line;
  }
  return found;
}

std::string told(double value, const DhLine& line) {
  int decimals = kUsualDecimals;
  if (line.sigma) decimals = decimals_for(kCoverage * *line.sigma, 0, most_decimals(line));
  return fixed(value, decimals);
}

void add_dh_table(Markup parent, const std::vector<DhLine>& lines) {
  const bool compared =
      std::any_of(lines.begin(), lines.end(), [](const auto& line) { return line.specified; });
  auto table = parent.add("table", {{"class", "dh"}});
  table.put(
      "caption",
      "Denavit-Hartenberg parameters. U = 2 u is the expanded uncertainty (k = 2, about 95 %). "
      "Row i leads from frame i to frame i + 1 by Tz(b) Rz(θ) Tx(a) Rx(α), and Ry(β) where "
      "axes are parallel. θ is the angle at home.");
  auto head = table.add("thead").add("tr");
  const auto column = [&](const char* title, const char* kind) {
    head.put("th", title, {{"scope", "col"}, {"class", kind}});
  };
  for (const char* const title : {"joint", "", "unit"}) column(title, "");
  column("identified", "number");
  column("U", "number");
  if (compared) {
    column("specified", "number");
    column("difference", "number");
    column("difference ± U against 0", "");
  }
  auto body = table.add("tbody");
  std::size_t joint = 0;
  for (const DhLine& line : lines) {
    const bool first = line.joint != joint;
    joint = line.joint;
    auto row = body.add("tr", {{"class", first ? "first" : "next"}});
    row.put("th", first ? std::to_string(line.joint) : "", {{"scope", "row"}});
    row.put("td", line.symbol, {{"class", "symbol"}});
    row.put("td", line.unit);
    const auto cell = [&](const std::optional<double>& value) {
      row.put("td", value ? told(*value, line) : "–", {{"class", "number"}});
    };
    cell(line.identified);
    if (line.by_convention)
      row.put("td", "set", {{"class", "number"}});
    else
      cell(line.sigma ? std::optional(kCoverage * *line.sigma) : std::nullopt);
    if (!compared) continue;
    cell(line.specified);
    cell(line.difference);
    add_interval(row.add("td", {{"class", "interval"}}), line);
  }
  std::string notes;
  if (std::any_of(lines.begin(), lines.end(), [](const auto& line) { return line.by_convention; }))
    notes += "“set”: the data do not determine this number. It is set by convention. ";
  if (std::any_of(lines.begin(), lines.end(),
                  [](const auto& line) { return !line.by_convention && !line.identified; }))
    notes += "“–”: the data do not determine this number. ";
  if (std::any_of(lines.begin(), lines.end(), [](const auto& line) {
        return line.symbol == std::string_view("θ") && line.identified && line.specified &&
               !line.by_convention && !line.difference;
      }))
    notes +=
        "“–” beside θ: not compared, since the controller's angles at home are not known: give "
        "--plan, or angles. ";
  if (compared)
    notes +=
        "Each interval has a scale of its own. A filled bar means that the difference is larger "
        "than U.";
  if (!notes.empty()) parent.put("p", notes, {{"class", "note"}});
}

}  // namespace sweepd
