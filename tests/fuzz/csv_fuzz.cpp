// Files of measured points and of axes ("a" at the beginning of the input), with their own header
// or with columns named from outside ("n" for points, "o" for axes). Only a CsvError comes out, in
// one line; what is read is finite.
#include <cmath>

#include "daemon/points/axes_file.hpp"
#include "daemon/points/csv_file.hpp"
#include "daemon/points/points_file.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;
using Names = std::vector<std::string>;

namespace {

constexpr std::size_t kJoints = 6;

void check_sample(const identify::Sample& sample) {
  expect(std::isfinite(sample.time_s), "a time is finite");
  if (sample.has_position)
    for (const double x : sample.position_mm) expect(std::isfinite(x), "a position is finite");
  if (sample.has_orientation)
    for (const double angle : sample.abc_rad) expect(std::isfinite(angle), "A, B, C are finite");
  expect(sample.joints <= kJoints, "no more angles than joints");
  for (std::size_t j = 0; j < sample.joints; ++j)
    expect(std::isfinite(sample.angles_rad[j]), "an angle is finite");
}

void check_points(const std::filesystem::path& path, const Names& columns) {
  sweepd::PointsReader reader(columns, kJoints);
  const auto file = reader.read(path, {});
  expect(!file.points.empty(), "there are points");
  for (const auto& point : file.points) {
    check_sample(point.sample);
    expect(point.joint <= kJoints, "a joint is one of the arm");
    expect(point.target < reader.targets().size(), "a target has a name");
  }
  const identify::Resolution steps = reader.resolution();
  expect(std::isfinite(steps.position_mm) && steps.position_mm >= 0, "the resolution is a length");
  expect(std::isfinite(steps.angle_rad) && steps.angle_rad >= 0, "the resolution is an angle");
}

void check_axes(const std::filesystem::path& path, const Names& columns) {
  const auto axes = sweepd::read_axes(path, columns, kJoints);
  expect(!axes.empty() && axes.size() <= kJoints, "there are axes");
  for (const auto& axis : axes) {
    expect(std::abs(axis.direction.norm() - 1) < 1e-12, "a direction has length 1");
    expect(axis.point_mm.allFinite() && axis.covariance.allFinite(), "an axis is finite");
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::File file;
  const auto input = fuzz::text(data, size);
  const char kind = input.empty() ? ' ' : input.front();
  const bool has_kind = kind == 'a' || kind == 'n' || kind == 'o';
  file.write(has_kind ? input.substr(1) : input);
  try {
    if (kind == 'a')
      check_axes(file.path(), {});
    else if (kind == 'o')
      check_axes(file.path(), {"joint", "x_mm", "y_mm", "z_mm", "dx", "dy", "dz", "-"});
    else if (kind == 'n')
      check_points(file.path(), {"t_s", "x_m", "y_m", "z_m", "-", "a1_deg"});
    else
      check_points(file.path(), {});
  } catch (const sweepd::CsvError& error) {
    expect(std::string_view(error.what()).starts_with(file.path().native()), "the file is named");
    expect(fuzz::is_one_line(error.what()), "an error is one line");
  }
  return 0;
}
