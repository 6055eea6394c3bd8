#include "daemon/points/points_file.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <Eigen/Geometry>
#include <spdlog/fmt/fmt.h>

#include "daemon/devices/device_formats.hpp"
#include "daemon/points/csv_file.hpp"
#include "daemon/points/device_points.hpp"
#include "daemon/text/units.hpp"
#include "identify/sweeps/sample.hpp"
#include "rsi/file_bytes.hpp"

namespace sweepd {
namespace {

using Places = std::map<std::string, Place, std::less<>>;

/// What sweepd writes into samples.csv and sweeps.csv and does not ask back.
bool is_passed_over(std::string_view column) {
  return column == "ipoc" || column == "pose" ||
         column.find("_residual") != std::string_view::npos ||
         column.find("_current") != std::string_view::npos ||
         column.find("_error") != std::string_view::npos;
}

bool is_joint_angle(std::string_view name) {
  for (std::size_t j = 1; j <= identify::kMostJoints; ++j)
    if (name == "a" + std::to_string(j)) return true;
  return false;
}

bool is_known(const NameAndUnit& column) {
  const auto one_of = [](std::string_view name, std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (column.unit.empty())
    return one_of(column.name, {"joint", "target", "sweep", "qx", "qy", "qz", "qw"});
  if (column.unit == "s") return column.name == "t";
  if (column.unit == "mm" || column.unit == "m")
    return one_of(column.name, {"x", "y", "z"}) || is_joint_angle(column.name);
  return one_of(column.name, {"a", "b", "c"}) || is_joint_angle(column.name);
}

/// Whether the column of a joint, from 0, tells of a linear one: its degrees are mm. Throws where
/// it has a unit that such a joint has not.
bool is_linear(const CsvFile& file, std::size_t column, std::size_t joint, JointKind kind) {
  const auto [name, unit, size] = name_and_unit(file.columns()[column]);
  const bool is_length = unit == "mm" || unit == "m";
  if (kind == JointKind::linear && unit == "rad")
    file.fail_header(column, fmt::format("expected mm, as joint {} is linear, found radians: give "
                                         "its place in mm, and name the column {}_mm",
                                         joint + 1, name));
  if (kind == JointKind::turning && is_length)
    file.fail_header(
        column, fmt::format("expected an angle, as joint {0} turns, found {1}: name the column "
                            "{2}_deg or {2}_rad, or say in the robot's description that the joint "
                            "is linear (type = \"linear\")",
                            joint + 1, unit, name));
  return is_length || kind == JointKind::linear;
}

Places places_in(const CsvFile& file) {
  Places places;
  for (std::size_t k = 0; k < file.columns().size(); ++k) {
    const std::string& column = file.columns()[k];
    if (column.empty() || is_passed_over(column)) continue;
    const auto parts = name_and_unit(column);
    if (!is_known(parts))
      file.fail_header(
          k, std::string("expected a known column, found another: rename it, or ") +
                 (file.path().empty() ? "write - to skip it"
                                      : "name all columns with --columns, - for one to skip") +
                 "; known are " + std::string(kPointColumns));
    // The numbers of a linear joint are in the place of degrees.
    const bool is_place = parts.unit.starts_with('m') && is_joint_angle(parts.name);
    const double size = is_place ? radians(parts.size) : parts.size;
    if (!places.emplace(parts.name, Place{k, size}).second)
      file.fail_header(k, "expected each value once, found " + std::string(parts.name) +
                              " a second time: skip one of the two with --columns");
  }
  return places;
}

std::optional<Place> place(const Places& places, std::string_view name) {
  const auto found = places.find(name);
  return found == places.end() ? std::nullopt : std::optional(found->second);
}

/// All of these values; nothing where there is none of them.
template <std::size_t N>
std::optional<std::array<Place, N>> all_of(const CsvFile& file, const Places& places,
                                           const std::array<const char*, N>& names) {
  std::array<Place, N> found;
  std::string missing;
  std::size_t count = 0;
  for (std::size_t k = 0; k < N; ++k) {
    const auto one = place(places, names[k]);
    if (one) {
      found[k] = *one;
      ++count;
      continue;
    }
    missing += (missing.empty() ? "" : ", ") + std::string(names[k]);
  }
  if (count == 0) return std::nullopt;
  if (count < N)
    file.fail_header(fmt::format(
        "expected a column for each of {} values that belong together, found none for {}: add it",
        N, missing));
  return found;
}

}  // namespace

NameAndUnit name_and_unit(std::string_view column) {
  constexpr std::array<NameAndUnit, 5> kColumnUnits{
      {{{}, "s", 1}, {{}, "mm", 1}, {{}, "m", 1000}, {{}, "rad", 1}, {{}, "deg", radians(1)}}};
  const auto line = column.rfind('_');
  for (const auto& unit : kColumnUnits)
    if (line != std::string_view::npos && column.substr(line + 1) == unit.unit)
      return {column.substr(0, line), unit.unit, unit.size};
  return {column, {}, 1};
}

PointColumns point_columns(const CsvFile& file, const std::vector<JointKind>& kinds) {
  const auto places = places_in(file);
  PointColumns columns;
  columns.joint = place(places, "joint");
  columns.target = place(places, "target");
  columns.sweep = place(places, "sweep");
  columns.time = place(places, "t");
  const auto position = all_of<3>(file, places, {"x", "y", "z"});
  if (!position)
    file.fail_header(
        "expected columns with positions, x_mm, y_mm, z_mm, found none: name them "
        "in the header or with --columns");
  columns.position = *position;
  columns.abc = all_of<3>(file, places, {"a", "b", "c"});
  columns.quaternion = all_of<4>(file, places, {"qx", "qy", "qz", "qw"});
  if (columns.abc && columns.quaternion)
    file.fail_header(
        "expected one orientation, found a quaternion and A, B, C: skip one of the "
        "two with --columns");
  std::size_t last = 0;
  for (std::size_t j = 1; j <= identify::kMostJoints; ++j)
    if (places.contains("a" + std::to_string(j))) last = j;
  for (std::size_t j = 1; j <= last; ++j) {
    const auto angle = place(places, "a" + std::to_string(j));
    if (!angle)
      file.fail_header(fmt::format(
          "expected angles of all joints from a1 on, found a{} but no a{}: add it", last, j));
    const JointKind kind = j <= kinds.size() ? kinds[j - 1] : JointKind::unknown;
    columns.angles.push_back(*angle);
    columns.linear.push_back(is_linear(file, angle->column, j - 1, kind));
  }
  return columns;
}

namespace {

constexpr int kFullPrecision = 10;

/// The finest step that was seen.
void refine(std::optional<double>& step, int decimals, double unit) {
  const double seen = decimals >= kFullPrecision ? 0 : unit * std::pow(10.0, -decimals);
  step = std::min(step.value_or(seen), seen);
}

/// The values at `places`; nothing if one of them is missing.
template <std::size_t N>
std::optional<std::array<double, N>> values(const CsvFile& file, const std::array<Place, N>& places,
                                            std::optional<double>* step) {
  std::array<double, N> all{};
  bool complete = true;
  for (std::size_t k = 0; k < N; ++k) {
    const auto number = file.decimal(places[k].column);
    complete = complete && number;
    if (!number) continue;
    all[k] = number->value * places[k].unit;
    if (step != nullptr) refine(*step, number->decimals, places[k].unit);
  }
  return complete ? std::optional(all) : std::nullopt;
}

void read_orientation(const CsvFile& file, const PointColumns& columns, std::optional<double>* step,
                      identify::Sample& sample) {
  if (columns.abc) {
    const auto abc = values(file, *columns.abc, step);
    sample.has_orientation = abc.has_value();
    if (abc) sample.abc_rad = *abc;
  }
  if (!columns.quaternion) return;
  const auto q = values(file, *columns.quaternion, nullptr);
  if (!q) return;
  const Eigen::Quaterniond quaternion((*q)[3], (*q)[0], (*q)[1], (*q)[2]);
  if (quaternion.norm() < 1e-6)
    file.fail(columns.quaternion->front().column,
              "expected a quaternion, found zero in qx, qy, qz and qw: correct it, or leave the "
              "four empty if the orientation is not known");
  sample.abc_rad = identify::abc_of(quaternion.normalized().toRotationMatrix());
  sample.has_orientation = true;
}

/// The time of the point before, of the same target.
struct Before {
  std::size_t joint = 0;
  std::size_t sweep = 0;
  double time_s = 0;
};

const DeviceFormat& format_named(std::string_view name) {
  for (const DeviceFormat& format : device_formats())
    if (format.name == name) return format;
  throw std::invalid_argument(
      fmt::format("--format {}: no format has this name: see --format list", name));
}

}  // namespace

std::size_t TargetNames::place_of(std::string_view name) {
  if (const auto known = places_.find(name); known != places_.end()) return known->second;
  names_.emplace_back(name);
  return places_.emplace(name, names_.size() - 1).first->second;
}

PointsReader::PointsReader(std::vector<std::string> columns, std::size_t joints,
                           std::string_view format, std::vector<JointKind> kinds)
    : columns_(std::move(columns)),
      joints_(joints),
      kinds_(std::move(kinds)),
      is_own_(!columns_.empty() || format == kOwnFormat),
      forced_(format.empty() || format == kOwnFormat ? nullptr : &format_named(format)) {
  if (forced_ != nullptr && !columns_.empty())
    throw std::invalid_argument(fmt::format(
        "--columns: files of format {} name their own: leave out one of the two", format));
}

PointsFile PointsReader::read(const std::filesystem::path& path, const OnProgress& on_progress) {
  constexpr std::size_t kHead = 1 << 20;
  std::string bytes = rsi::file_bytes<CsvError>(path);
  const DeviceFormat* format = forced_;
  if (format == nullptr && !is_own_) {
    const bool is_wide = bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff");
    const DeviceText head(path, is_wide ? bytes : bytes.substr(0, kHead));
    format = recognised_format(head);
  }
  if (format == nullptr) return read_own(path, std::move(bytes), on_progress);
  return device_points(*format, DeviceText(path, std::move(bytes)), joints_, targets_,
                       position_step_mm_, on_progress);
}

PointsFile PointsReader::read_own(const std::filesystem::path& path, std::string content,
                                  const OnProgress& on_progress) {
  constexpr std::size_t kMostSweeps = 1'000'000'000;
  CsvFile file(path, std::move(content), columns_);
  auto columns = point_columns(file, kinds_);
  if (columns.angles.size() > joints_) columns.angles.resize(joints_);
  PointsFile result{
      path,
      columns.joint.has_value(),
      columns.time.has_value(),
      std::find(file.columns().begin(), file.columns().end(), "pose") != file.columns().end(),
      columns.angles.size(),
      {},
      {},
      {},
      columns.linear};
  // A, B, C count only where nothing else tells how finely angles are printed.
  std::optional<double>* const orientation_step =
      columns.angles.empty() ? &angle_step_rad_ : nullptr;

  std::vector<std::optional<Before>> before;
  std::set<std::size_t> untold;
  while (file.next()) {
    Point point;
    point.line = file.line();
    if (columns.joint) point.joint = file.whole_number(columns.joint->column, 1, joints_);
    if (columns.sweep) point.sweep = file.whole_number(columns.sweep->column, 0, kMostSweeps);
    point.target =
        targets_.place_of(columns.target ? file.text(columns.target->column) : std::string_view());
    if (columns.target && file.text(columns.target->column).empty())
      file.fail(columns.target->column, "expected a name or number, found nothing: fill it in");

    identify::Sample& sample = point.sample;
    sample.time_s = columns.time ? file.number(columns.time->column)
                                 : static_cast<double>(result.points.size());
    if (const auto xyz = values(file, columns.position, &position_step_mm_)) {
      sample.position_mm = {(*xyz)[0], (*xyz)[1], (*xyz)[2]};
      sample.has_position = true;
    }
    read_orientation(file, columns, orientation_step, sample);
    std::size_t found = 0;
    for (std::size_t j = 0; j < columns.angles.size(); ++j) {
      const auto angle = file.decimal(columns.angles[j].column);
      if (!angle && sample.has_position) untold.insert(j);
      if (!angle) continue;
      sample.angles_rad[j] = angle->value * columns.angles[j].unit;
      // Whole degrees in all lines are commanded ones, and exact.
      if (angle->decimals > 0) refine(angle_step_rad_, angle->decimals, columns.angles[j].unit);
      ++found;
    }
    if (found == columns.angles.size())
      sample.joints = static_cast<std::uint8_t>(found);
    else if (sample.has_position)
      ++result.without_angles;

    before.resize(targets_.all().size());
    auto& last = before[point.target];
    if (last && last->joint == point.joint && last->sweep == point.sweep &&
        sample.time_s < last->time_s)
      file.fail(columns.time->column, std::string(kTimeRunsBackwards));
    last = {point.joint, point.sweep, sample.time_s};

    result.points.push_back(point);
    if (result.points.size() % kBetweenUpdates == 0 && on_progress) on_progress(file.bytes_read());
  }
  if (result.points.empty())
    throw CsvError(path.string() + ": expected points, found no line but the header: give another");
  result.joints_untold.assign(untold.begin(), untold.end());
  return result;
}

identify::Resolution PointsReader::resolution() const {
  return {position_step_mm_.value_or(0), angle_step_rad_.value_or(0)};
}

}  // namespace sweepd
