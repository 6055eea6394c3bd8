#include <algorithm>
#include <array>
#include <utility>

#include "daemon/devices/device_text.hpp"
#include "daemon/devices/maker_formats.hpp"
#include "daemon/devices/wide_columns.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

constexpr std::string_view kFrame = "Frame";
constexpr std::size_t kLongestFrame = 40;  ///< with its sub frame
constexpr std::array<std::string_view, 3> kSections{"Trajectories", "Objects", "Segments"};
constexpr std::array<std::string_view, 10> kOthers{
    "Devices", "Events",   "Joints",       "Model Outputs", "Bones",
    "Markers", "Subjects", "Force Plates", "Gaze Vectors",  "Unlabeled Markers"};

/// The word that a line consists of, but for empty fields.
std::string_view only_word(const DeviceText& text, std::size_t line) {
  auto word = rsi::trimmed(text.line(line));
  word = word.substr(0, word.find_first_of(",;\t"));
  return rsi::trimmed(text.line(line)).find_first_not_of(",;\t ", word.size()) ==
                 std::string_view::npos
             ? word
             : std::string_view();
}

template <std::size_t N>
bool is_one_of(std::string_view word, const std::array<std::string_view, N>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_axes_row(std::string_view line) {
  return line.starts_with(kFrame) && line.size() > kFrame.size() &&
         (line.substr(kFrame.size() + 1).starts_with("Sub"));
}

/// The line with a section's name; the number of lines where there is none of this name.
std::size_t section(const DeviceText& text, std::string_view name) {
  std::size_t line = 0;
  while (line < text.lines() && only_word(text, line) != name) ++line;
  return line;
}

/// Names stand above the first column of each target.
std::vector<std::pair<std::string, WideTarget>> targets_in(const Fields& names,
                                                           const Fields& axes) {
  std::vector<std::pair<std::string, WideTarget>> targets;
  for (std::size_t c = 2; c < axes.size(); ++c) {
    if (c < names.size() && !names[c].empty()) targets.emplace_back(names[c], WideTarget());
    if (targets.empty()) continue;
    std::string axis = lower(axes[c]);
    if (axis.starts_with('t')) axis.erase(0, 1);
    targets.back().second.add(axis, c);
  }
  return targets;
}

}  // namespace

bool is_vicon_csv(const DeviceText& text) {
  if (const auto first = only_word(text, 0);
      !is_one_of(first, kSections) && !is_one_of(first, kOthers))
    return false;
  constexpr std::size_t kMost = 8;
  for (std::size_t line = 1; line < std::min(kMost, text.lines()); ++line)
    if (is_axes_row(text.line(line))) return true;
  // A file that is cut is this kind too.
  const auto rate = printed_number(only_word(text, 1));
  return rate && rate->value > 0;
}

DeviceLayout vicon_layout(const DeviceText& text) {
  std::size_t begin = text.lines();
  for (const auto name : kSections)
    begin = std::min(begin, begin < text.lines() ? begin : section(text, name));
  if (begin == text.lines())
    text.fail(
        "expected a section Trajectories, Objects or Segments, found none: export markers or "
        "objects too");
  DeviceLayout layout;
  std::size_t axes = begin + 1;
  while (axes < text.lines() && axes < begin + 6 && !is_axes_row(text.line(axes))) ++axes;
  if (!is_axes_row(text.line(axes)) || axes < begin + 2)
    text.fail(begin,
              "expected a rate, names and a row that begins with Frame, Sub Frame behind the name "
              "of the section, found none: the file is cut, or was changed: export it again");
  layout.header = axes;
  layout.separator = text.line(axes)[kFrame.size()];
  const auto rate = printed_number(only_word(text, begin + 1));
  if (!rate || !(rate->value > 0))
    text.fail(begin + 1, "expected the rate in Hz, found " + as_found(text.line(begin + 1)) +
                             ": export the file again");
  layout.time = {TimeColumns::Kind::number, {0}, 1 / rate->value};
  layout.begin = axes + 2;
  layout.end = layout.begin;
  while (layout.end < text.lines() &&
         text.line(layout.end).find_first_not_of(",;\t ") != std::string_view::npos)
    ++layout.end;
  for (std::size_t line = layout.begin; line < layout.end; ++line) {
    const auto fields = fields_of(text.line(line).substr(0, kLongestFrame), layout.separator);
    if (fields.size() > 2 && !fields[1].empty() && fields[1] != "0")
      text.fail(line, "expected Sub Frame 0, found " + as_found(fields[1]) +
                          ": the file does not tell when that was: export one position a frame");
  }
  layout.lines_may_be_short = true;
  layout.zero_is_missing = true;

  auto header = fields_of(text.line(axes), layout.separator);
  while (header.back().empty()) header.pop_back();
  layout.columns = header.size();
  const auto units = fields_of(text.line(axes + 1), layout.separator);
  const auto targets = targets_in(fields_of(text.line(axes - 1), layout.separator), header);
  const bool any_name = std::any_of(targets.begin(), targets.end(), [](const auto& target) {
    return !target.first.starts_with('*');
  });
  WideTargets chosen(text, axes - 1);
  for (const auto& [name, columns] : targets) {
    if (name.starts_with('*') && any_name) {
      chosen.leave_out("markers without a name", "");
      continue;
    }
    const auto x = columns.column("x");
    if (!x) {
      chosen.leave_out(name, "it has no position");
      continue;
    }
    const auto unit = *x < units.size() ? units[*x] : std::string_view();
    if (length_unit_mm(unit) == 0 ||
        (layout.unit_mm != 1 && layout.unit_mm != length_unit_mm(unit)))
      text.fail(axes + 1, "expected one unit of length, mm, in column " + std::to_string(*x + 1) +
                              ", found " + as_found(unit) + ": export the file again");
    layout.unit_mm = length_unit_mm(unit);
    const auto rotation = columns.quaternion();
    if (!rotation && columns.column("rx"))
      chosen.leave_out("RX, RY, RZ", "Euler angles or helical, the file does not tell");
    chosen.add(name, columns, rotation);
  }
  std::move(chosen).into(layout);
  for (const auto name : kSections)
    if (const auto other = section(text, name); other > begin && other < text.lines())
      layout.notes.push_back("left out: the section " + std::string(name));
  return layout;
}

}  // namespace sweepd
