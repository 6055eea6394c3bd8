#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/points/csv_file.hpp"
#include "daemon/points/joint_kinds.hpp"
#include "identify/sweeps/sample.hpp"

namespace sweepd {

struct DeviceFormat;

/// Where in a line a value stands, and what one of its units is in mm, radians or seconds.
struct Place {
  std::size_t column = 0;
  double unit = 1;
};

/// What the columns of a file of measured points mean.
struct PointColumns {
  std::optional<Place> joint;
  std::optional<Place> target;
  std::optional<Place> sweep;
  std::optional<Place> time;
  std::array<Place, 3> position;
  std::optional<std::array<Place, 3>> abc;
  std::optional<std::array<Place, 4>> quaternion;  ///< x, y, z, w
  std::vector<Place> angles;                       ///< of joint 1 and on; mm count as degrees
  std::vector<bool> linear;  ///< of these: is in mm, as its column or what is known of it says
};

/// Reads the names of the columns. Throws as CsvFile::fail_header does: at a name that is not
/// known, that comes twice, or that is missing; at an angle's unit that its joint cannot have.
[[nodiscard]] PointColumns point_columns(const CsvFile& file,
                                         const std::vector<JointKind>& kinds = {});

/// A name without its unit ("x" of "x_m"), and what that is in mm, radians or seconds; 1 where the
/// name has none.
struct NameAndUnit {
  std::string_view name;
  std::string_view unit;
  double size = 1;
};
[[nodiscard]] NameAndUnit name_and_unit(std::string_view column);

/// The names that point_columns() knows, for a manual.
inline constexpr std::string_view kPointColumns =
    "joint, target, pose, t_s, x_mm, y_mm, z_mm (or x_m ...), qx, qy, qz, qw (quaternion of the "
    "tool) or "
    "a_deg, b_deg, c_deg (KUKA's A, B, C), a1_deg to a12_deg (or a1_rad ..., of a linear joint "
    "a1_mm ...)";

/// A line of a file of measured points.
struct Point {
  identify::Sample sample;  ///< in mm and radians
  std::size_t joint = 0;    ///< from 1, that moves; 0: the file does not say
  std::size_t sweep = 0;    ///< tells sweeps of one joint apart
  std::size_t target = 0;   ///< which of PointsReader::targets() was measured
  std::size_t line = 0;     ///< of the file
};

struct PointsFile {
  std::filesystem::path path;
  bool with_joints = false;
  bool with_times = false;  ///< without, time counts the points
  bool with_poses = false;  ///< a column says that each line is a static pose
  std::size_t angles = 0;   ///< so many joint angles a point
  std::vector<Point> points;
  std::string format;  ///< a device's, for people: "OptiTrack Motive CSV"; empty for sweepd's own
  std::vector<std::string> notes = {};          ///< what was assumed or left out in a device's file
  std::vector<bool> linear = {};                ///< as in PointColumns
  std::size_t without_angles = 0;               ///< points with a position, but not all angles
  std::vector<std::size_t> joints_untold = {};  ///< whose fields are empty there, from 0

  /// Of a joint counted from 0.
  [[nodiscard]] bool is_linear(std::size_t joint) const {
    return joint < linear.size() && linear[joint];
  }
};

/// Names of targets in order of appearance, however many.
class TargetNames {
 public:
  /// The place of this name, at the end if it is new.
  [[nodiscard]] std::size_t place_of(std::string_view name);
  [[nodiscard]] bool has(std::string_view name) const { return places_.contains(name); }
  [[nodiscard]] const std::vector<std::string>& all() const { return names_; }

 private:
  std::vector<std::string> names_;
  std::map<std::string, std::size_t, std::less<>> places_;
};

inline constexpr std::string_view kTimeRunsBackwards =
    "expected a time no earlier than the line before, found an earlier one: give dates where "
    "midnight lies between and UTC where clocks were set back, else sort the lines, or give each "
    "recording as a file of its own";

/// Is told how much of a file was read.
using OnBytesRead = std::function<void(std::size_t bytes_read)>;
/// After so many points.
inline constexpr std::size_t kBetweenUpdates = 4096;

/// Reads files of measured points: CSV (see kPointColumns for what they hold), and what programs of
/// measuring devices write (device_formats()). Target points are told apart across all files of one
/// reader.
///
/// An empty field is a missing value: the point then has no position, no orientation or no angles.
/// Time must not run backwards within a sweep, or within a file that names none.
class PointsReader {
 public:
  using OnProgress = OnBytesRead;

  /// `columns` take the place of the files' headers unless empty; `joints` is how many the robot
  /// has, at most: angles beyond are passed over. `format` names the one that all files have;
  /// empty: each file's content tells, unless there are `columns`. `kinds` is what is known of the
  /// joints, one each, or less. Throws std::invalid_argument where no format has this name, or
  /// where it is a device's and there are `columns`.
  PointsReader(std::vector<std::string> columns, std::size_t joints, std::string_view format = {},
               std::vector<JointKind> kinds = {});

  /// Throws CsvError, and std::invalid_argument where `columns` are wrong.
  [[nodiscard]] PointsFile read(const std::filesystem::path& path, const OnProgress& on_progress);

  /// The last decimal of positions and of joint angles (or A, B, C) in all files so far. Ten
  /// decimals or more are full precision, as are joint angles without any: zero.
  [[nodiscard]] identify::Resolution resolution() const;
  /// Their names in order of appearance; one without a name where no file tells.
  [[nodiscard]] const std::vector<std::string>& targets() const { return targets_.all(); }

 private:
  [[nodiscard]] PointsFile read_own(const std::filesystem::path& path, std::string content,
                                    const OnProgress& on_progress);

  std::vector<std::string> columns_;
  std::size_t joints_;
  std::vector<JointKind> kinds_;
  bool is_own_;                 // all files
  const DeviceFormat* forced_;  // for all files
  TargetNames targets_;
  std::optional<double> position_step_mm_;
  std::optional<double> angle_step_rad_;
};

}  // namespace sweepd
