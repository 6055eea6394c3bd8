#include "daemon/points/axes_file.hpp"

#include <array>
#include <map>
#include <optional>

#include <spdlog/fmt/fmt.h>

#include "daemon/points/csv_file.hpp"
#include "daemon/points/points_file.hpp"

namespace sweepd {
namespace {

struct AxisColumns {
  std::size_t joint = 0;
  std::array<Place, 3> point;
  std::array<std::size_t, 3> direction{};
  std::optional<Place> direction_sigma;
  std::optional<Place> point_sigma;
};

AxisColumns axis_columns(const CsvFile& file) {
  std::map<std::string, Place, std::less<>> places;
  for (std::size_t k = 0; k < file.columns().size(); ++k) {
    const std::string& column = file.columns()[k];
    if (column.empty()) continue;
    const auto [name, unit, size] = name_and_unit(column);
    const bool length = unit == "mm" || unit == "m";
    const bool angle = unit == "deg" || unit == "rad";
    const bool known = length  ? name == "x" || name == "y" || name == "z" || name == "point_sigma"
                       : angle ? name == "direction_sigma"
                               : name == "joint" || name == "dx" || name == "dy" || name == "dz";
    if (!known)
      file.fail_header(k,
                       "expected a known column, found another: rename it, or name all columns "
                       "with --columns, - for one to skip; known are " +
                           std::string(kAxisColumns));
    if (!places.emplace(name, Place{k, size}).second)
      file.fail_header(k, "expected each value once, found " + std::string(name) +
                              " a second time: skip one of the two with --columns");
  }
  const auto needed = [&](const char* name) {
    const auto found = places.find(name);
    if (found == places.end())
      file.fail_header("expected a column " + std::string(name) +
                       ", found none: add it; known are " + std::string(kAxisColumns));
    return found->second;
  };
  const auto optional = [&](const char* name) {
    const auto found = places.find(name);
    return found == places.end() ? std::nullopt : std::optional(found->second);
  };
  return {needed("joint").column,
          {needed("x"), needed("y"), needed("z")},
          {needed("dx").column, needed("dy").column, needed("dz").column},
          optional("direction_sigma"),
          optional("point_sigma")};
}

double sigma(const CsvFile& file, const std::optional<Place>& place) {
  const auto number = place ? file.decimal(place->column) : std::nullopt;
  if (!number) return 0;
  if (number->value < 0)
    file.fail(place->column,
              "expected a standard uncertainty, found a negative number: correct it");
  return number->value * place->unit;
}

identify::Axis read_axis(const CsvFile& file, const AxisColumns& columns) {
  identify::Axis axis;
  Eigen::Vector3d direction;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    axis.point_mm(i) = file.number(columns.point[k].column) * columns.point[k].unit;
    direction(i) = file.number(columns.direction[k]);
  }
  const double largest = direction.cwiseAbs().maxCoeff();
  if (largest == 0)
    file.fail(columns.direction[0],
              "expected a direction, found zero in dx, dy and dz: give a vector along the axis");
  axis.direction = (direction / largest).normalized();
  const double tilt = sigma(file, columns.direction_sigma);
  const double shift = sigma(file, columns.point_sigma);
  const Eigen::Matrix3d across =
      Eigen::Matrix3d::Identity() - axis.direction * axis.direction.transpose();
  axis.covariance.topLeftCorner<3, 3>() = tilt * tilt * across;
  axis.covariance.bottomRightCorner<3, 3>() = shift * shift * across;
  return axis;
}

}  // namespace

std::vector<identify::Axis> read_axes(const std::filesystem::path& path,
                                      const std::vector<std::string>& columns, std::size_t joints) {
  CsvFile file(path, columns);
  const AxisColumns places = axis_columns(file);
  struct Line {
    identify::Axis axis;
    std::size_t number = 0;
  };
  std::map<std::size_t, Line> lines;  // by joint
  while (file.next()) {
    const std::size_t joint = file.whole_number(places.joint, 1, joints);
    const auto [line, is_new] = lines.try_emplace(joint);
    if (!is_new)
      file.fail(places.joint,
                fmt::format("expected each joint once, found joint {} in line {} too: leave one "
                            "of the two out",
                            joint, line->second.number));
    line->second = {read_axis(file, places), file.line()};
  }
  if (lines.empty())
    throw CsvError(path.string() + ": expected axes, found no line but the header: give another");
  std::vector<identify::Axis> axes;
  for (const auto& [joint, line] : lines) {
    if (joint != axes.size() + 1)
      throw CsvError(fmt::format(
          "{}: line {}: expected the axes of all joints up to joint {}, found none of joint {}: "
          "add its line, or count the joints from 1",
          path.string(), line.number, joint, axes.size() + 1));
    axes.push_back(line.axis);
  }
  return axes;
}

}  // namespace sweepd
