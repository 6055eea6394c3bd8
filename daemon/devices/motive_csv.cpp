#include <algorithm>
#include <map>
#include <utility>

#include "daemon/devices/device_text.hpp"
#include "daemon/devices/maker_formats.hpp"
#include "daemon/devices/wide_columns.hpp"
#include "daemon/text/units.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

constexpr std::string_view kFirst = "Format Version";

std::string_view metadata(const Fields& pairs, std::string_view key) {
  for (std::size_t k = 0; k + 1 < pairs.size(); ++k)
    if (pairs[k] == key) return pairs[k + 1];
  return {};
}

/// Rows above the one of the axes, by what they tell.
struct Heads {
  std::size_t axes = 0;
  Fields type;
  Fields name;
  Fields id;
  Fields component;
  Fields axis;
};

Heads heads_in(const DeviceText& text, char separator) {
  constexpr std::size_t kMost = 16;
  std::vector<Fields> rows;
  for (std::size_t line = 1; line < std::min(kMost, text.lines()); ++line) {
    const auto fields = fields_of(text.line(line), separator);
    if (fields.front() == "Frame") {
      if (rows.size() < 3) break;
      Heads heads{line, rows[0], rows[1], {}, rows.back(), fields};
      if (rows.size() > 3) heads.id = rows[2];
      return heads;
    }
    if (!text.is_passed_over(line)) rows.push_back(fields);
  }
  text.fail(
      "expected rows of type, name, ID and axis, and one that begins with Frame, found none: the "
      "file is cut, or was exported without a header: export it again with Header Information");
}

std::string_view at(const Fields& fields, std::size_t column) {
  return column < fields.size() ? fields[column] : std::string_view();
}

/// Consecutive columns of one thing.
struct Thing {
  std::string type;
  std::string name;
  WideTarget columns;
};

std::vector<Thing> things_in(const DeviceText& text, const Heads& heads) {
  std::vector<Thing> things;
  std::string_view id;
  for (std::size_t c = 0; c < heads.axis.size(); ++c) {
    const auto component = at(heads.component, c);
    if (component != "Position" && component != "Rotation") continue;
    const auto type = at(heads.type, c);
    const auto name = at(heads.name, c);
    if (things.empty() || things.back().type != type || things.back().name != name ||
        id != at(heads.id, c)) {
      things.push_back({std::string(type), std::string(name), {}});
      id = at(heads.id, c);
    }
    const auto axis = heads.axis[c];
    auto& columns = things.back().columns;
    if (axis != "X" && axis != "Y" && axis != "Z" && axis != "W")
      text.fail(heads.axes, "expected an axis X, Y, Z or W in column " + std::to_string(c + 1) +
                                ", found " + as_found(axis) + ": export the file again");
    columns.add(component == "Position" ? lower(axis) : "r" + lower(axis), c);
  }
  return things;
}

std::optional<RotationColumns> rotation_of(const WideTarget& columns, std::string_view type) {
  if (auto quaternion = columns.quaternion()) return quaternion;
  return columns.euler(type, radians(1));
}

}  // namespace

bool is_motive_csv(const DeviceText& text) {
  return text.line(0).starts_with(kFirst) && text.line(0).size() > kFirst.size();
}

DeviceLayout motive_layout(const DeviceText& text) {
  if (!is_motive_csv(text))
    text.fail(0, "expected Format Version, as Motive writes it, found " + as_found(text.line(0)) +
                     ": leave out --format, or export the file from Motive");
  DeviceLayout layout;
  layout.separator = text.line(0)[kFirst.size()];
  const auto pairs = fields_of(text.line(0), layout.separator);
  const auto unit = metadata(pairs, "Length Units");
  layout.unit_mm = length_unit_mm(unit);
  if (layout.unit_mm == 0)
    text.fail(0, "expected Length Units, in millimeters or another unit of length, found " +
                     as_found(unit) + ": export the file again");
  if (const auto space = metadata(pairs, "Coordinate Space"); !space.empty() && space != "Global")
    text.fail(0, "expected Coordinate Space Global, found " + as_found(space) +
                     ": export the file again in global coordinates");
  const Heads heads = heads_in(text, layout.separator);
  layout.header = heads.axes;
  layout.begin = heads.axes + 1;
  layout.end = text.lines();
  layout.columns = heads.axis.size();
  layout.time = {TimeColumns::Kind::number, {1}, 1};
  if (const auto frames = printed_number(metadata(pairs, "Total Exported Frames"));
      frames && frames->value > 0 && frames->value < 1e9)
    layout.frames = static_cast<std::size_t>(frames->value);
  if (!at(heads.axis, 1).starts_with("Time"))
    text.fail(heads.axes, "expected a column Time in seconds behind Frame, found " +
                              as_found(at(heads.axis, 1)) + ": export the file again");

  auto things = things_in(text, heads);
  std::map<std::string, std::size_t, std::less<>> markers_of;
  bool any_label = false;
  const auto body_of = [](std::string_view marker) {
    return marker.substr(0, std::min(marker.rfind(':'), marker.size()));
  };
  const auto is_labelled = [](const Thing& thing) {
    return !thing.name.starts_with("Unlabeled") && !thing.name.empty();
  };
  for (const Thing& thing : things) {
    if (thing.type == "Marker") ++markers_of[std::string(body_of(thing.name))];
    any_label =
        any_label || ((thing.type == "Marker" || thing.type == "Rigid Body") && is_labelled(thing));
  }
  constexpr std::size_t kEnough = 3;  // markers, to tell a body's pose
  const auto has_markers = [&](std::string_view body) {
    const auto found = markers_of.find(body);
    return found != markers_of.end() && found->second >= kEnough;
  };
  std::map<std::string, bool, std::less<>> bodies;
  for (const Thing& thing : things)
    if (thing.type == "Rigid Body") bodies[thing.name] = !has_markers(thing.name);
  WideTargets targets(text, heads.axes);
  for (const Thing& thing : things) {
    const auto body = bodies.find(body_of(thing.name));
    if (thing.type == "Rigid Body") {
      if (has_markers(thing.name))
        targets.leave_out(thing.name, "its pose is made of its markers");
      else
        targets.add(thing.name, thing.columns,
                    rotation_of(thing.columns, metadata(pairs, "Rotation Type")));
    } else if (thing.type == "Marker" && body != bodies.end() && body->second) {
      targets.leave_out(thing.name, "the pose of its body is made of it");
    } else if (thing.type == "Marker" && (is_labelled(thing) || !any_label)) {
      targets.add(thing.name, thing.columns, std::nullopt);
    } else if (thing.type == "Marker") {
      targets.leave_out("markers without a label", "");
    } else {
      targets.leave_out(thing.type.empty() ? "columns without a type" : "each " + thing.type, "");
    }
  }
  std::move(targets).into(layout);
  return layout;
}

}  // namespace sweepd
