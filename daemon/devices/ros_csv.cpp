#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/devices/device_text.hpp"
#include "daemon/devices/device_words.hpp"
#include "daemon/devices/maker_formats.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

constexpr double kMetre_mm = 1000;
// Of a stamp, a frame and a pose. A transform has a second frame, the child's, behind the first.
constexpr std::size_t kColumnsOfRos2 = 10;

/// PlotJuggler parts the names of a message's fields by slashes.
std::vector<std::string> names_in(const DeviceText& text, char separator) {
  const auto fields = fields_of(text.line(0), separator);
  std::vector<std::string> names(fields.begin(), fields.end());
  for (std::string& name : names) std::replace(name.begin(), name.end(), '/', '.');
  return names;
}

using Names = std::vector<std::string>;

std::optional<std::size_t> column_ending(const Names& header,
                                         std::initializer_list<std::string_view> ends) {
  for (const auto end : ends)
    for (std::size_t c = 0; c < header.size(); ++c)
      if (header[c].ends_with(end)) return c;
  return std::nullopt;
}

std::optional<std::size_t> position_x(const Names& header) {
  return column_ending(header, {"position.x", "translation.x", "point.x"});
}

/// The columns of the other axes of what column `first` is the x of; nothing where one is missing.
std::optional<std::vector<std::size_t>> all_axes(const Names& header, std::size_t first,
                                                 std::string_view axes) {
  std::vector<std::size_t> columns;
  const auto stem = header[first].substr(0, header[first].size() - 1);
  for (const char axis : axes) {
    const auto found = std::find(header.begin(), header.end(), stem + axis);
    if (found == header.end()) return std::nullopt;
    columns.push_back(static_cast<std::size_t>(found - header.begin()));
  }
  return columns;
}

/// One of ROS 2: whole seconds, nanoseconds, a frame that is no number, and a pose. How many frames
/// there are: 2 of a transform; 0: the text is none of these.
std::size_t frames_of_ros2(const DeviceText& text) {
  const auto fields = fields_of(text.line(0), ',');
  const std::size_t frames = fields.size() == kColumnsOfRos2 + 1 ? 2 : 1;
  if (fields.size() != kColumnsOfRos2 + frames - 1 || !rsi::all_digits(fields[0]) ||
      !rsi::all_digits(fields[1]) || fields[1].size() > 9 || printed_number(fields[2]) ||
      printed_number(fields[1 + frames]))
    return 0;
  double square = 0;
  for (std::size_t c = 2 + frames; c < fields.size(); ++c) {
    const auto number = printed_number(fields[c]);
    if (!number && fields[c] != "nan") return 0;
    if (c > 4 + frames && number) square += number->value * number->value;
  }
  return std::abs(square - 1) < 0.01 || square == 0 ? frames : 0;
}

bool is_zero(std::string_view field) {
  return field.find_first_not_of("0.") == std::string_view::npos;
}

/// How much the whole stamps of a column grow from line to line; 0 where nothing tells.
double step_of_stamps(const DeviceText& text, const DeviceLayout& layout, std::size_t column,
                      double first) {
  std::size_t steps = 0;
  for (std::size_t line = layout.begin + 1; line < text.lines(); ++line)
    if (!text.is_passed_over(line)) ++steps;
  for (std::size_t line = text.lines(); steps > 0 && --line > layout.begin; --steps) {
    if (text.is_passed_over(line)) continue;
    const auto fields = fields_of(text.line(line), layout.separator);
    const auto last = column < fields.size() ? printed_number(fields[column]) : std::nullopt;
    if (last) return (last->value - first) / static_cast<double>(steps);
  }
  return 0;
}

constexpr std::array<double, 4> kUnits_s{1, 1e-3, 1e-6, 1e-9};

/// Of a stream with at most 2000 lines a second, and at least two. These are three powers of ten,
/// as the units are apart, so at most one fits.
std::optional<double> unit_by_rate_s(double step) {
  constexpr double kNearest_s = 0.0005;
  constexpr double kFarthest_s = 0.5;
  for (const double unit_s : kUnits_s)
    if (step * unit_s >= kNearest_s && step * unit_s < kFarthest_s) return unit_s;
  return std::nullopt;
}

/// Of stamps that lie in the years from 2001 to 2064.
std::optional<double> unit_since_1970_s(double first) {
  for (const double unit_s : kUnits_s)
    if (first * unit_s >= 1e9 && first * unit_s < 3e9) return unit_s;
  return std::nullopt;
}

/// Stamps with decimals are seconds. ROS' own programs print nanoseconds, others what they like.
double unit_of_stamp_s(const DeviceText& text, const DeviceLayout& layout, std::size_t column,
                       std::string_view first) {
  constexpr double kNanosecond_s = 1e-9;
  constexpr double kFarApart_s = 100;  // between two lines, even of poses one by one
  const auto number = printed_number(first);
  if (!number) return kNanosecond_s;
  if (first.find('.') != std::string_view::npos) return time_unit_of_count_s(number->value);
  const double step = step_of_stamps(text, layout, column, number->value);
  const auto by_rate_s = unit_by_rate_s(step);
  const auto since_1970_s = unit_since_1970_s(number->value);
  if (step <= 0 || since_1970_s == kNanosecond_s) return since_1970_s.value_or(kNanosecond_s);
  const bool is_date = since_1970_s && step * *since_1970_s < kFarApart_s;
  if (by_rate_s && *by_rate_s < 1 && (!is_date || by_rate_s == since_1970_s)) return *by_rate_s;
  if (!by_rate_s && !is_date) return kNanosecond_s;
  text.fail(
      layout.begin,
      fmt::format("column {}: expected stamps that tell their unit, found {}, and {:.3g} more "
                  "from line to line: give nanoseconds, or seconds with decimals",
                  column + 1, as_found(first), step));
}

TimeColumns time_in(const DeviceText& text, const DeviceLayout& layout, const Names& header) {
  auto first = fields_of(text.line(layout.begin), layout.separator);
  first.resize(header.size());
  const auto seconds = column_ending(header, {"stamp.secs", "stamp.sec"});
  const auto parts = column_ending(header, {"stamp.nsecs", "stamp.nanosec"});
  if (seconds && parts && !is_zero(first[*seconds]))
    return {TimeColumns::Kind::nanoseconds, {*seconds, *parts}};
  const auto stamp = column_ending(header, {"header.stamp"});
  if (stamp && !is_zero(first[*stamp]))
    return {
        TimeColumns::Kind::number, {*stamp}, unit_of_stamp_s(text, layout, *stamp, first[*stamp])};
  const auto received = column_ending(header, {"%time", "#time"});
  if (received)
    return {TimeColumns::Kind::number,
            {*received},
            unit_of_stamp_s(text, layout, *received, first[*received])};
  const auto plain = column_ending(header, {"Time", "time"});  // of converters, in seconds
  if (plain) return {TimeColumns::Kind::number, {*plain}, 1};
  text.fail(layout.header,
            "expected a column header.stamp or %time, found neither: record the topic again");
}

}  // namespace

bool is_ros_csv(const DeviceText& text) {
  const auto header = names_in(text, separator_in(text.line(0)));
  const bool is_named = std::any_of(header.begin(), header.end(), [](std::string_view name) {
    return name.find("header.") != std::string_view::npos || name == "%time" || name == "__time";
  });
  return (is_named && position_x(header)) || frames_of_ros2(text) > 0;
}

DeviceLayout ros_layout(const DeviceText& text) {
  DeviceLayout layout;
  layout.unit_mm = kMetre_mm;
  layout.end = text.lines();
  TargetColumns target;
  if (const std::size_t frames = frames_of_ros2(text); frames > 0) {
    const std::size_t x = 2 + frames;
    layout.has_names = false;
    layout.columns = kColumnsOfRos2 + frames - 1;
    layout.time = {TimeColumns::Kind::nanoseconds, {0, 1}};
    target.position = {x, x + 1, x + 2};
    target.rotation =
        RotationColumns{RotationColumns::Kind::quaternion, {x + 3, x + 4, x + 5, x + 6}};
    if (frames > 1) layout.name.push_back(3);
    layout.targets.push_back(target);
    return layout;
  }
  layout.separator = separator_in(text.line(0));
  const auto header = names_in(text, layout.separator);
  layout.begin = 1;
  layout.columns = header.size();
  const auto x = position_x(header);
  const auto position = x ? all_axes(header, *x, "xyz") : std::nullopt;
  if (!position)
    text.fail(0,
              "expected columns position.x, position.y, position.z of a pose, found not all of "
              "them: record a topic of PoseStamped with rostopic echo -p");
  std::copy(position->begin(), position->end(), target.position.begin());
  if (const auto turn = column_ending(header, {"orientation.x", "rotation.x"}))
    if (auto columns = all_axes(header, *turn, "xyzw"))
      target.rotation = RotationColumns{RotationColumns::Kind::quaternion, std::move(*columns)};
  layout.targets.push_back(target);
  if (const auto child = column_ending(header, {"child_frame_id"})) layout.name.push_back(*child);
  layout.time = time_in(text, layout, header);
  return layout;
}

}  // namespace sweepd
