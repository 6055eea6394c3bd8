#include "daemon/points/device_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>

#include "daemon/devices/device_text.hpp"
#include "daemon/points/csv_file.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/text/units.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

/// More names than any device has targets: what comes then is no name.
constexpr std::size_t kMostTargets = 64;

void split(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  if (separator == ' ') line = rsi::trimmed(line);
  while (true) {
    const auto end = line.find(separator);
    fields.push_back(rsi::trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
    if (separator == ' ') line = rsi::trimmed(line);
  }
}

}  // namespace

DeviceLines::DeviceLines(std::string_view columns) {
  const auto names = column_names(columns);
  count_ = names.size();
  if (names.empty())
    throw std::invalid_argument(
        "columns: expected names of columns with commas between, found nothing: name them");
  const CsvFile file("", "0\n", names);
  columns_ = point_columns(file);
  if (columns_.joint || columns_.sweep || !columns_.angles.empty())
    throw std::invalid_argument(
        "columns: expected times, targets and positions of a device, found a column for joints, "
        "sweeps or joint angles: skip it with -, as the controller tells them");
  if (!columns_.target) static_cast<void>(targets_.place_of(""));
}

DeviceLines::DeviceLines(const ColumnList& columns) try
    : DeviceLines(std::string_view(columns.text)) {
} catch (const std::invalid_argument& problem) {
  if (columns.place.empty()) throw;
  throw ConfigError(columns.place + problem.what());
}

DeviceLines::Line DeviceLines::read(std::string_view line, Point& point) {
  while (line.ends_with('\r') || line.ends_with('\n')) line.remove_suffix(1);
  if (const auto all = rsi::trimmed(line); all.empty() || all.front() == '#') return Line::empty;
  if (!split_fields(line)) return Line::other_fields;
  if (may_have_thousands()) return Line::thousands;
  identify::Sample sample;
  sample.time_s = point.sample.time_s;
  if (columns_.time) {
    const auto time = number(*columns_.time, nullptr);
    if (!time) return Line::no_number;
    sample.time_s = *time;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (fields_[columns_.position[k].column].empty()) return Line::not_seen;
    const auto value = number(columns_.position[k], &step_mm_);
    if (!value) return Line::no_number;
    sample.position_mm(static_cast<Eigen::Index>(k)) = *value;
  }
  sample.has_position = true;
  point.target = 0;
  if (columns_.target) {
    const auto name = fields_[columns_.target->column];
    if (name.empty()) return Line::no_number;
    if (!targets_.has(name) && targets_.all().size() == kMostTargets) return Line::no_number;
    point.target = targets_.place_of(name);
  }
  point.sample = sample;
  return Line::point;
}

/// Into as many fields as there are columns. A comma separates only where nothing else does: it may
/// be one of decimals.
bool DeviceLines::split_fields(std::string_view line) {
  const auto has_blank = [this](const Place& place) {
    return fields_[place.column].find(' ') != std::string_view::npos;
  };
  for (const char separator : {';', '\t', ',', ' '}) {
    split(line, separator, fields_);
    if (fields_.size() != count_) continue;
    if (separator == ',' &&
        std::all_of(columns_.position.begin(), columns_.position.end(), has_blank))
      continue;  // "1,5 2,5 3,5 4" in four columns
    is_comma_decimal_ = separator != ',';
    return true;
  }
  return false;
}

/// As in files: numbers of one line, and of one device, are written alike.
bool DeviceLines::may_have_thousands() {
  if (!is_comma_decimal_) return false;
  std::size_t thousands = 0;
  std::size_t others = 0;
  const auto look_at = [&](const Place& place) {
    const auto text = fields_[place.column];
    if (text.empty()) return;
    if (text.find(',') == std::string_view::npos)
      ++others;
    else if (may_be_thousands(text))
      ++thousands;
    else
      shown_decimal_ = true;
  };
  if (columns_.time) look_at(*columns_.time);
  for (const Place& place : columns_.position) look_at(place);
  return thousands > 0 && others > 0 && !shown_decimal_;
}

std::optional<double> DeviceLines::number(const Place& place, std::optional<double>* step) {
  std::string_view text = fields_[place.column];
  std::array<char, 32> with_point{};
  const auto comma = is_comma_decimal_ ? text.find(',') : std::string_view::npos;
  if (comma != std::string_view::npos && text.size() <= with_point.size()) {
    std::copy(text.begin(), text.end(), with_point.begin());
    with_point[comma] = '.';
    text = {with_point.data(), text.size()};
  }
  const auto value = printed_number(text);
  if (!value || std::abs(value->value) > kLargestMeasured) return std::nullopt;
  if (step != nullptr) {
    const double last = value->decimals >= 10 ? 0 : place.unit * std::pow(10.0, -value->decimals);
    *step = std::min(step->value_or(last), last);
  }
  return value->value * place.unit;
}

std::string_view text(DeviceLines::Line line) noexcept {
  switch (line) {
    case DeviceLines::Line::point:
      return "a point";
    case DeviceLines::Line::empty:
      return "empty, or a comment";
    case DeviceLines::Line::other_fields:
      return "more or fewer fields than columns";
    case DeviceLines::Line::no_number:
      return "something else where a number or a name is expected";
    case DeviceLines::Line::thousands:
      return "a comma that may be one of decimals or of thousands (send decimal points)";
    case DeviceLines::Line::not_seen:
      return "a target that was not seen";
  }
  return "";
}

std::string_view next_line(std::string_view& bytes) {
  const auto end = std::min(bytes.find('\n'), bytes.size());
  const auto line = bytes.substr(0, end);
  bytes.remove_prefix(std::min(end + 1, bytes.size()));
  return line;
}

}  // namespace sweepd
