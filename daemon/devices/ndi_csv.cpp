#include <algorithm>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/devices/device_text.hpp"
#include "daemon/devices/device_words.hpp"
#include "daemon/devices/maker_formats.hpp"
#include "daemon/devices/wide_columns.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

constexpr std::string_view kTools = "Tools";
constexpr std::string_view kFrames = "Number of frames";
constexpr double kPolaris_Hz = 60;

bool is_toolbox(const DeviceText& text) {
  return text.line(0).starts_with(kTools) && text.line(0).find("Port") != std::string_view::npos;
}

/// As the names of the columns tell it, or else the first number.
double unit_of_times_s(const DeviceText& text, char separator, const Fields& header,
                       const std::vector<std::size_t>& times) {
  const std::string unit = column_name(header[times.front()]).unit;
  for (const std::size_t c : times)
    if (const auto other = column_name(header[c]).unit;
        other != unit || (!unit.empty() && time_unit_s(unit) == 0))
      text.fail(0, fmt::format("expected one unit of time, s or ms, in column {}, found {}: export "
                               "the file again",
                               c + 1, as_found(header[c])));
  if (!unit.empty()) return time_unit_s(unit);
  const auto first = fields_of(text.line(1), separator);
  const auto since = times.front() < first.size() ? printed_number(first[times.front()])
                                                  : std::optional<rsi::Decimal>();
  return since ? time_unit_of_count_s(since->value) : 1;
}

DeviceLayout toolbox_layout(const DeviceText& text) {
  DeviceLayout layout;
  layout.separator = text.line(0)[kTools.size()];
  const auto header = fields_of(text.line(0), layout.separator);
  layout.begin = 1;
  layout.end = text.lines();
  layout.columns = header.size();
  layout.lines_may_be_short = true;  // a tool without its markers

  struct Sensor {
    std::string name;
    WideTarget columns;
    std::optional<std::size_t> state;
  };
  std::vector<Sensor> sensors;  // each tool, then its markers
  std::vector<std::size_t> tools;
  std::vector<std::size_t> frames, times;
  for (std::size_t c = 0; c < header.size(); ++c) {
    const std::string word = lower(header[c]);
    if (word.starts_with("port")) {
      tools.push_back(sensors.size());
      const auto colon = header[c].find(':');
      const auto name =
          colon == std::string_view::npos ? header[c] : rsi::trimmed(header[c].substr(colon + 1));
      sensors.push_back({std::string(name.empty() ? header[c] : name), {}, {}});
    } else if (word == "frame" || word == "frame#") {
      frames.push_back(c);
    } else if (word.starts_with("time")) {
      times.push_back(c);
    } else if (word == "state" && !tools.empty()) {
      if (sensors.back().state)
        sensors.push_back({sensors[tools.back()].name + " marker " +
                               std::to_string(sensors.size() - tools.back()),
                           {},
                           {}});
      sensors.back().state = c;
    } else if (!tools.empty()) {
      if (word == "tx" || word == "ty" || word == "tz")
        sensors.back().columns.add(word.substr(1), c);
      else if (word == "q0")
        sensors.back().columns.add("rw", c);
      else if (word == "qx" || word == "qy" || word == "qz")
        sensors.back().columns.add("r" + word.substr(1), c);
    }
  }
  if (frames.empty() && times.empty())
    text.fail(0,
              "expected columns Frame of each tool, found none: the file is cut, export it again");
  layout.time = {
      TimeColumns::Kind::number, times.empty() ? frames : times,
      times.empty() ? 1 / kPolaris_Hz : unit_of_times_s(text, layout.separator, header, times)};
  if (times.empty()) layout.notes.emplace_back("60 frames a second assumed: the file has no times");

  constexpr std::size_t kEnough = 3;  // markers, to tell a tool's pose
  WideTargets targets(text, 0);
  for (std::size_t t = 0; t < tools.size(); ++t) {
    const std::size_t end = t + 1 < tools.size() ? tools[t + 1] : sensors.size();
    const auto& tool = sensors[tools[t]];
    const bool by_markers = end - tools[t] > kEnough;
    if (by_markers)
      targets.leave_out(tool.name, "its pose is made of its markers");
    else
      targets.add(tool.name, tool.columns, tool.columns.quaternion(), tool.state);
    for (std::size_t k = tools[t] + 1; k < end; ++k)
      if (by_markers)
        targets.add(sensors[k].name, sensors[k].columns, std::nullopt, sensors[k].state);
      else
        targets.leave_out(sensors[k].name, "the pose of its tool is made of it");
  }
  std::move(targets).into(layout);
  return layout;
}

/// What stands behind "KEY:" in the lines before `end`.
std::string_view told(const DeviceText& text, std::size_t end, std::string_view key) {
  for (std::size_t line = 0; line < end; ++line) {
    auto rest = text.line(line);
    if (!rest.starts_with(key)) continue;
    rest.remove_prefix(key.size());
    while (!rest.empty() && (rest.find_first_of(":,;\t ") == 0)) rest.remove_prefix(1);
    return rsi::trimmed(rest.substr(0, rest.find_first_of(",;\t")));
  }
  return {};
}

DeviceLayout first_principles_layout(const DeviceText& text) {
  constexpr std::size_t kMost = 20;
  constexpr std::string_view kFrame = "Frame";
  std::size_t header = 0;
  while (header < std::min(kMost, text.lines()) &&
         !(text.line(header).starts_with(kFrame) && text.line(header).size() > kFrame.size()))
    ++header;
  if (header == std::min(kMost, text.lines()))
    text.fail(
        "expected a row that begins with Frame and names the columns, found none: the file "
        "is cut, export it again");
  DeviceLayout layout;
  layout.header = header;
  layout.begin = header + 1;
  layout.end = text.lines();
  layout.separator = text.line(header)[kFrame.size()];
  const auto unit = told(text, header, "Units");
  layout.unit_mm = length_unit_mm(unit);
  if (layout.unit_mm == 0)
    text.fail("expected Units: mm, or another unit of length, above the columns, found " +
              as_found(unit) + ": export the file again");
  const auto rate = printed_number(told(text, header, "Frequency"));
  if (!rate || !(rate->value > 0))
    text.fail("expected Frequency in Hz above the columns, found " +
              as_found(told(text, header, "Frequency")) + ": export the file again");
  layout.time = {TimeColumns::Kind::number, {0}, 1 / rate->value};
  if (const auto frames = printed_number(told(text, header, kFrames));
      frames && frames->value > 0 && frames->value < 1e9)
    layout.frames = static_cast<std::size_t>(frames->value);

  auto names = fields_of(text.line(header), layout.separator);
  while (names.back().empty()) names.pop_back();
  layout.columns = names.size();
  std::vector<std::pair<std::string, WideTarget>> markers;
  for (std::size_t c = 1; c < names.size(); ++c) {
    const auto blank = names[c].rfind(' ');
    if (blank == std::string_view::npos) continue;
    const std::string name(rsi::trimmed(names[c].substr(0, blank)));
    std::string axis = lower(names[c].substr(blank + 1));
    if (axis == "q0") axis = "rw";
    if (axis.size() == 2 && axis.front() == 'q') axis.front() = 'r';
    if (markers.empty() || markers.back().first != name || markers.back().second.column(axis))
      markers.emplace_back(name, WideTarget());
    markers.back().second.add(axis, c);
  }
  WideTargets targets(text, header);
  for (const auto& [name, columns] : markers) targets.add(name, columns, columns.quaternion());
  std::move(targets).into(layout);
  return layout;
}

}  // namespace

bool is_ndi_csv(const DeviceText& text) {
  return is_toolbox(text) || text.line(0).starts_with(kFrames);
}

DeviceLayout ndi_layout(const DeviceText& text) {
  if (!is_ndi_csv(text))
    text.fail(0,
              "expected Tools and Port, or Number of frames, as NDI's programs write them, found " +
                  as_found(text.line(0)) + ": leave out --format, or export the file again");
  DeviceLayout layout = is_toolbox(text) ? toolbox_layout(text) : first_principles_layout(text);
  layout.minus_huge_is_missing = true;
  return layout;
}

}  // namespace sweepd
