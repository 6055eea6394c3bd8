#include "daemon/points/point_columns.hpp"

#include <algorithm>
#include <map>

#include "daemon/text/units.hpp"
#include "identify/sweeps/sample.hpp"

namespace sweepd {
namespace {

using Places = std::map<std::string, Place, std::less<>>;

/// What sweepd writes into samples.csv and sweeps.csv and does not ask back.
bool is_passed_over(std::string_view column) {
  return column == "ipoc" || column.find("_residual") != std::string_view::npos ||
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
  if (column.unit == "mm" || column.unit == "m") return one_of(column.name, {"x", "y", "z"});
  return one_of(column.name, {"a", "b", "c"}) || is_joint_angle(column.name);
}

Places places_in(const CsvFile& file) {
  Places places;
  for (std::size_t k = 0; k < file.columns().size(); ++k) {
    const std::string& column = file.columns()[k];
    if (column.empty() || is_passed_over(column)) continue;
    const auto parts = name_and_unit(column);
    if (!is_known(parts))
      file.fail_header(k,
                       "expected a known column, found another: rename it, or name all columns "
                       "with --columns, - for one to skip; known are " +
                           std::string(kPointColumns));
    if (!places.emplace(parts.name, Place{k, parts.size}).second)
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
    file.fail_header("expected a column for each of " + std::to_string(N) +
                     " values that belong together, found none for " + missing + ": add it");
  return found;
}

}  // namespace

NameAndUnit name_and_unit(std::string_view column) {
  constexpr std::array<NameAndUnit, 5> kUnits{
      {{{}, "s", 1}, {{}, "mm", 1}, {{}, "m", 1000}, {{}, "rad", 1}, {{}, "deg", radians(1)}}};
  const auto line = column.rfind('_');
  for (const auto& unit : kUnits)
    if (line != std::string_view::npos && column.substr(line + 1) == unit.unit)
      return {column.substr(0, line), unit.unit, unit.size};
  return {column, {}, 1};
}

PointColumns point_columns(const CsvFile& file) {
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
      file.fail_header("expected angles of all joints from a1 on, found a" + std::to_string(last) +
                       " but no a" + std::to_string(j) + ": add it");
    columns.angles.push_back(*angle);
  }
  return columns;
}

}  // namespace sweepd
