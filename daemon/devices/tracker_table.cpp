#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/devices/device_rows.hpp"
#include "daemon/devices/device_text.hpp"
#include "daemon/devices/device_words.hpp"
#include "daemon/devices/maker_formats.hpp"
#include "daemon/devices/table_units.hpp"
#include "daemon/devices/wide_columns.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

constexpr std::size_t kMostLinesAbove = 60;

/// Which column is what, and where the data begin.
struct Table {
  char separator = ',';
  std::size_t header = 0;
  std::size_t begin = 0;
  std::size_t columns = 0;
  WideTarget places;
  std::vector<std::size_t> times;
  std::string unit;                               ///< of positions; empty where none is told
  std::map<std::size_t, std::string> time_units;  ///< by column, where they are told
  bool is_named = false;                          ///< a row names the columns
  bool is_own = false;                            ///< by sweepd's own names
  bool is_told = false;  ///< by units or a quaternion, that it is a measuring program's
};

std::string_view without_comment_mark(std::string_view line) {
  line = rsi::trimmed(line);
  while (!line.empty() && (line.front() == '/' || line.front() == '#' || line.front() == '%'))
    line.remove_prefix(1);
  return rsi::trimmed(line);
}

/// A number as a measured coordinate is printed.
bool is_coordinate(std::string_view field) {
  std::string text(field);
  std::replace(text.begin(), text.end(), ',', '.');
  const auto number = printed_number(text);
  return number && text.find_first_of(".eE") != std::string::npos;
}

std::size_t line_from(const DeviceText& text, std::size_t line) {
  while (line < text.lines() && text.is_passed_over(line)) ++line;
  return line;
}

/// As sweepd names columns of points. A device's program may write X_mm, but knows no joints.
bool is_own_name(std::string_view name) {
  constexpr std::array<std::string_view, 8> kOwn{"t_s",  "T_S", "x_mm", "y_mm",
                                                 "z_mm", "x_m", "y_m",  "z_m"};
  return std::ranges::find(kOwn, name) != kOwn.end() || names_joint(name);
}

/// The row that names the columns, if there is one.
std::optional<Table> named_table(const DeviceText& text) {
  for (std::size_t line = 0; line < std::min(kMostLinesAbove, text.lines()); ++line) {
    const auto row = without_comment_mark(text.line(line));
    if (row.empty()) continue;
    Table table;
    table.separator = separator_in(row);
    const auto names = fields_of(row, table.separator);
    for (std::size_t c = 0; c < names.size(); ++c) {
      const ColumnName name = column_name(names[c]);
      table.is_own = table.is_own || is_own_name(names[c]);
      if (name.value == "time") {
        table.times.push_back(c);
        if (!name.unit.empty()) table.time_units[c] = name.unit;
      } else if (!name.value.empty()) {
        const bool is_axis = name.value.size() == 1;
        if (is_axis && table.places.column(name.value))
          text.fail(line, fmt::format("expected {} once, found it a second time in column {}: "
                                      "export the file again with one position",
                                      name.value, c + 1));
        table.places.add(name.value, c);
        if (!is_axis || name.unit.empty()) continue;
        if (!table.unit.empty() && table.unit != name.unit)
          text.fail(line, "expected one unit for X, Y and Z, found " + as_found(table.unit) +
                              " and " + as_found(name.unit) + ": export the file again");
        table.unit = name.unit;
        table.is_told = length_unit_mm(name.unit) > 0;
      }
    }
    if (!table.places.all({"x", "y", "z"})) continue;
    table.is_told = table.is_told || table.places.quaternion();
    table.is_named = true;
    table.header = line;
    table.columns = names.size();
    table.begin = line_from(text, line + 1);
    if (text.is_passed_over(line) && table.begin < text.lines())  // the names stand in a comment
      table.separator = separator_in(text.line(table.begin));
    const auto below =
        unit_below(text, table.begin, table.separator, *table.places.all({"x", "y", "z"}));
    if (!below.empty()) {
      table.unit = below;
      table.is_told = true;
      table.begin = line_from(text, table.begin + 1);
    }
    return table;
  }
  return std::nullopt;
}

/// SpatialAnalyzer's order: names, x, y, z, more.
std::optional<Table> ordered_table(const DeviceText& text) {
  Table table;
  table.begin = table.header = line_from(text, 0);
  const auto line = text.line(table.begin);
  table.separator = separator_in(line);
  const auto fields = fields_of(line, table.separator);
  std::size_t x = 0;
  constexpr std::size_t kMostNames = 3;
  while (x + 2 < fields.size() && !(is_coordinate(fields[x]) && is_coordinate(fields[x + 1]) &&
                                    is_coordinate(fields[x + 2])))
    ++x;
  if (x + 2 >= fields.size() || x > kMostNames) return std::nullopt;
  for (std::size_t k = 0; k < 3; ++k) table.places.add(std::string(1, "xyz"[k]), x + k);
  static constexpr std::array<std::string_view, kMostNames> kNames{"name", "group", "collection"};
  for (std::size_t k = 0; k < x; ++k) table.places.add(std::string(kNames[k]), x - 1 - k);
  for (std::size_t c = x + 3; c < fields.size() && table.times.empty(); ++c)
    for (std::size_t count = 1; count <= 3 && c + count <= fields.size(); ++count) {
      std::string date;
      for (std::size_t k = c; k < c + count; ++k) date += std::string(fields[k]) + ' ';
      if (!seconds_of_date(date)) continue;
      table.times.resize(count);
      for (std::size_t k = 0; k < count; ++k) table.times[k] = c + k;
    }
  table.columns = fields.size();
  return table;
}

std::optional<Table> table_in(const DeviceText& text) {
  auto table = named_table(text);
  return table ? table : ordered_table(text);
}

bool any_word(const DeviceText& text, std::initializer_list<std::string_view> words) {
  for (std::size_t line = 0; line < std::min(kMostLinesAbove, text.lines()); ++line)
    for (const auto word : words)
      if (contains(text.line(line), word)) return true;
  return false;
}

/// A table, not by sweepd's own names. Where the names are wrong, its maker's words still tell it,
/// and reading it tells what is wrong.
struct Look {
  bool is_table = false;
  std::optional<Table> table;
};

Look look_at(const DeviceText& text) {
  try {
    auto table = table_in(text);
    if (!table || table->is_own) return {};
    return {true, std::move(table)};
  } catch (const CsvError&) {
    return {true, std::nullopt};
  }
}

/// Every field stands behind a comma and two blanks, as SpatialAnalyzer writes them.
bool has_wide_commas(std::string_view line) {
  std::size_t commas = 0;
  for (auto at = line.find(','); at != std::string_view::npos; at = line.find(',', at + 1)) {
    ++commas;
    if (line.substr(at + 1, 2) != "  " || line.substr(at + 3).starts_with(' ')) return false;
  }
  return commas >= 3;
}

TimeColumns time_of(const DeviceText& text, const Table& table, DeviceLayout& layout) {
  if (table.times.empty()) return {};
  const auto first = fields_of(text.line(table.begin), table.separator);
  const auto text_at = [&](const std::vector<std::size_t>& columns) {
    std::string joined;
    for (const std::size_t c : columns)
      if (c < first.size()) joined += std::string(first[c]) + ' ';
    return joined;
  };
  // A date and a time of day may be apart, in any order, or stand beside other times.
  std::vector<std::vector<std::size_t>> ways{table.times,
                                             {table.times.rbegin(), table.times.rend()}};
  for (const std::size_t c : table.times) ways.push_back({c});
  for (const auto& columns : ways)
    if (seconds_of_date(text_at(columns))) return {TimeColumns::Kind::date, columns};
  std::string why = as_found(text_at({table.times.front()})) + " is no date, time of day or number";
  for (const std::size_t c : table.times) {
    std::string number = text_at({c});
    std::replace(number.begin(), number.end(), ',', '.');
    const auto since = printed_number(rsi::trimmed(number));
    if (!since) continue;
    const auto unit = table.time_units.find(c);
    const double unit_s = unit == table.time_units.end() ? time_unit_of_count_s(since->value)
                                                         : time_unit_s(unit->second);
    if (unit_s > 0) return {TimeColumns::Kind::number, {c}, unit_s};
    why = as_found(unit->second) + " is no known unit of time: s, ms, us, ns are";
  }
  layout.notes.push_back("left out: times, as " + why);
  return {};
}

/// The different texts of a column, and how many lines there are.
std::pair<std::set<std::string_view>, std::size_t> texts_of(const DeviceText& text,
                                                            const Table& table,
                                                            std::size_t column) {
  std::set<std::string_view> texts;
  std::size_t lines = 0;
  for (std::size_t line = table.begin; line < text.lines(); ++line) {
    if (text.is_passed_over(line)) continue;
    const auto fields = fields_of(text.line(line), table.separator);
    if (column < fields.size()) texts.insert(fields[column]);
    ++lines;
  }
  return {std::move(texts), lines};
}

/// Which columns name a line's target, and which its joint.
void name_lines(const DeviceText& text, const Table& table, DeviceLayout& layout) {
  constexpr std::size_t kOften = 4;
  const auto collection = table.places.column("collection");
  const auto group = table.places.column("group");
  const auto name = table.places.column("name");
  if (collection) layout.name.push_back(*collection);
  if (group) {
    const auto groups = texts_of(text, table, *group).first;
    if (std::all_of(groups.begin(), groups.end(), [](auto one) { return joint_in(one) > 0; }))
      layout.joint = group;
    else
      layout.name.push_back(*group);
  }
  if (const auto target = table.places.column("target")) {
    layout.name.push_back(*target);
  } else if (name && !group) {
    const auto [names, lines] = texts_of(text, table, *name);
    if (names.size() * kOften <= lines) layout.name.push_back(*name);
  }
}

}  // namespace

bool is_spatial_analyzer_text(const DeviceText& text) {
  const auto [is_table, table] = look_at(text);
  if (!is_table) return false;
  if (any_word(text, {"spatialanalyzer", "spatial analyzer", "new river kinematics"}) ||
      text.line(0).starts_with("//"))
    return true;
  if (!table) return false;
  if (table->is_named) return table->places.column("group") || table->places.column("collection");
  const auto first = text.line(table->begin);
  const auto fields = fields_of(first, table->separator);
  return has_wide_commas(first) || (table->places.column("name") && !printed_number(fields[0]));
}

bool is_polyworks_text(const DeviceText& text) {
  return any_word(text, {"polyworks", "innovmetric"}) && look_at(text).is_table;
}

bool is_leica_csv(const DeviceText& text) {
  const auto [is_table, table] = look_at(text);
  if (!is_table) return false;
  if (any_word(text, {"leica", "t-mac", "tmac", "at960", "at930", "at901", "at40", "ats600",
                      "tracker pilot", "hexagon"}))
    return true;
  if (!table || !table->is_named || !table->places.quaternion()) return false;
  const auto row = without_comment_mark(text.line(table->header));
  const auto names = fields_of(row, separator_in(row));
  return std::any_of(names.begin(), names.end(),
                     [](std::string_view name) { return rsi::equal_ignoring_case(name, "q0"); });
}

bool is_faro_csv(const DeviceText& text) {
  return any_word(text, {"faro", "cam2"}) && look_at(text).is_table;
}

bool is_tracker_table(const DeviceText& text) {
  const auto table = look_at(text).table;
  return table && table->is_named && table->is_told;
}

DeviceLayout tracker_layout(const DeviceText& text) {
  const auto table = table_in(text);
  if (!table)
    text.fail(
        "expected a row with the names X, Y and Z, or lines with names and coordinates, found "
        "none: export the file again with a header, or name the columns with --columns");
  if (table->begin >= text.lines())
    text.fail(table->header,
              "expected points below the names of the columns, found none: the file is cut, or "
              "holds no points: export it again");
  DeviceLayout layout;
  layout.separator = table->separator;
  layout.header = table->header;
  layout.has_names = table->is_named;
  layout.begin = table->begin;
  layout.end = text.lines();
  layout.columns = table->columns;
  layout.is_list = true;
  const auto unit = table->unit.empty() ? unit_above(text, table->begin) : table->unit;
  if (unit.empty())
    layout.notes.emplace_back("millimetres assumed: the file names no unit");
  else
    layout.unit_mm = length_unit_mm(unit);
  if (layout.unit_mm == 0)
    text.fail(table->header, "expected a unit of length with X, Y and Z, found " + as_found(unit) +
                                 ": export the file again in mm");
  layout.time = time_of(text, *table, layout);
  const auto xyz = *table->places.all({"x", "y", "z"});
  layout.targets.push_back(
      {{}, {xyz[0], xyz[1], xyz[2]}, table->places.quaternion(), std::nullopt});
  name_lines(text, *table, layout);
  return layout;
}

}  // namespace sweepd
