#include "daemon/points/device_points.hpp"

#include <algorithm>
#include <map>

#include <spdlog/fmt/fmt.h>

#include "daemon/devices/device_rows.hpp"
#include "daemon/devices/device_text.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

/// Times of the points of each target come at least so densely, most of them, as a stream's do.
bool is_dense(const std::vector<Point>& points) {
  constexpr double kMostApart_s = 0.15;
  std::map<std::size_t, double> before;  // by target
  std::size_t near = 0, all = 0;
  for (const Point& point : points) {
    const auto [last, is_first] = before.try_emplace(point.target, point.sample.time_s);
    if (is_first) continue;
    const double step_s = point.sample.time_s - last->second;
    ++all;
    if (step_s > 0 && step_s <= kMostApart_s) ++near;
    last->second = point.sample.time_s;
  }
  return 2 * near > all;
}

/// Without times, points count.
void drop_times(PointsFile& file) {
  file.with_times = false;
  for (std::size_t k = 0; k < file.points.size(); ++k)
    file.points[k].sample.time_s = static_cast<double>(k);
  file.notes.emplace_back("left out: times, which are too far apart for a stream");
}

/// The time of the point before, of the same target.
struct LastTime {
  std::size_t joint = 0;
  double time_s = 0;
};

}  // namespace

PointsFile device_points(const DeviceFormat& format, const DeviceText& text, std::size_t joints,
                         TargetNames& targets, std::optional<double>& step_mm,
                         const OnBytesRead& on_progress) {
  const DeviceLayout layout = format.layout(text);
  PointsFile result;
  result.path = text.path();
  result.with_joints = layout.joint.has_value();
  result.with_times = layout.time.kind != TimeColumns::Kind::none;
  result.format = format.title;
  result.notes = layout.notes;
  DeviceRows rows(text, layout, joints);
  std::vector<std::optional<LastTime>> before;
  std::vector<std::optional<std::size_t>> known(layout.targets.size());  // places in `targets`
  std::size_t bytes = 0;
  while (rows.next()) {
    for (const DeviceRows::Seen& seen : rows.seen()) {
      auto& place = known[seen.target];
      if (!place || !layout.name.empty()) place = targets.place_of(seen.name);
      Point point;
      point.line = rows.line() + 1;
      point.joint = rows.joint();
      point.target = *place;
      point.sample.time_s = rows.time_s();
      point.sample.position_mm = seen.position_mm;
      point.sample.has_position = true;
      point.sample.has_orientation = seen.rotation.has_value();
      if (seen.rotation) point.sample.abc_rad = identify::abc_of(*seen.rotation);
      step_mm = std::min(step_mm.value_or(seen.step_mm), seen.step_mm);
      before.resize(targets.all().size());
      auto& last = before[point.target];
      if (last && last->joint == point.joint && point.sample.time_s < last->time_s)
        rows.fail_time(std::string(kTimeRunsBackwards));
      last = {point.joint, point.sample.time_s};
      result.points.push_back(point);
    }
    bytes += text.line(rows.line()).size() + 1;
    if (rows.rows() % kBetweenUpdates == 0 && on_progress) on_progress(bytes);
  }
  if (result.points.empty())
    text.fail(layout.header, fmt::format("expected measured positions below this line, found none "
                                         "in {}: export the file again, with data",
                                         rsi::counted(rows.rows(), "line")));
  for (std::size_t k = 0; k < known.size(); ++k)
    if (!known[k])
      result.notes.push_back("left out: " + as_found(layout.targets[k].name) +
                             " (it was never seen)");
  if (rows.comments() > 0)
    result.notes.push_back("left out: " + rsi::counted(rows.comments(), "line") +
                           " among the points, for the # or // in front");
  if (layout.frames && *layout.frames > rows.rows())
    result.notes.push_back(
        fmt::format("{} of the {} frames that it tells of", rows.rows(), *layout.frames));
  if (layout.is_list && result.with_times && !is_dense(result.points)) drop_times(result);
  return result;
}

}  // namespace sweepd
