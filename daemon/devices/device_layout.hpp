#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace sweepd {

// What the lines of a device's file mean: all that tells one format from another. DeviceRows reads
// any file by it. Lines and columns count from 0.

/// A measured orientation, from the body's axes to the device's.
struct RotationColumns {
  enum class Kind {
    quaternion,  ///< four columns: x, y, z, w
    matrix,      ///< nine columns, a row of the matrix after the other
    euler,       ///< three columns, turned about the body's own axes in the order of `order`
  };
  Kind kind = Kind::quaternion;
  std::vector<std::size_t> columns;
  double unit_rad = 1;         ///< what one of the angles' unit is
  std::array<int, 3> order{};  ///< 0: x, 1: y, 2: z
};

/// One target in each line.
struct TargetColumns {
  std::string name;
  std::array<std::size_t, 3> position{};
  std::optional<RotationColumns> rotation = {};
  std::optional<std::size_t> state = {};  ///< where it is not OK, nothing was measured
};

struct TimeColumns {
  enum class Kind {
    none,
    lines,        ///< they come every `unit_s`
    number,       ///< of `unit_s`; the first of the columns that is filled in
    nanoseconds,  ///< two columns, whole seconds and nanoseconds
    date,         ///< date and time, or a time of day; over all the columns
  };
  Kind kind = Kind::none;
  std::vector<std::size_t> columns;
  double unit_s = 1;
};

struct DeviceLayout {
  char separator = ',';
  std::size_t header = 0;           ///< the line that tells the columns
  bool has_names = true;            ///< the header names the columns, for messages
  std::size_t begin = 0;            ///< the first line of data
  std::size_t end = 0;              ///< the line after the last one
  std::size_t columns = 0;          ///< of each line; more are empty
  bool lines_may_be_short = false;  ///< what is missing at a line's end is empty
  double unit_mm = 1;               ///< of positions
  TimeColumns time;
  std::vector<TargetColumns> targets;
  std::vector<std::size_t> name;       ///< these columns name the target of a line
  std::optional<std::size_t> joint;    ///< a text with the number of the joint that moves
  bool zero_is_missing = false;        ///< a position of 0, 0, 0 was not measured
  bool minus_huge_is_missing = false;  ///< a number below -1e20 was not measured
  bool is_list = false;                ///< points one by one: times count only where they are dense
  std::optional<std::size_t> frames;   ///< so many are told
  std::vector<std::string> notes;      ///< what was assumed or left out, for people
};

}  // namespace sweepd
