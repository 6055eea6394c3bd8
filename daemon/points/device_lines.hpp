#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/points/points_file.hpp"
#include "daemon/settings/settings.hpp"

namespace sweepd {

/// Reads lines of text as a device sends them while it measures: numbers with commas, semicolons,
/// tabs or blanks between, by the columns of a file of points. Where no commas stand between,
/// numbers may have decimal commas: a line is refused whose commas may all stand between thousands
/// while other numbers have none, until one has shown that they are decimal. Takes any bytes. One
/// thread.
class DeviceLines {
 public:
  /// `columns`: as for `identify --columns`. Throws std::invalid_argument where they are wrong, or
  /// name joints, sweeps or joint angles, which the controller tells.
  explicit DeviceLines(std::string_view columns);
  /// The same, but throws ConfigError where the columns are those of a file.
  explicit DeviceLines(const ColumnList& columns);

  enum class Line {
    point,
    empty,         ///< or a comment, which begins with #
    other_fields,  ///< more or fewer than there are columns
    no_number,     ///< where the columns have one
    thousands,     ///< a number like 1,234, in which nothing tells whether it is 1.234 or 1234
    not_seen,      ///< the target was not: there is no position
  };
  /// `point` is set where the line is one. Without a time column, its time is left as it was.
  [[nodiscard]] Line read(std::string_view line, Point& point);

  [[nodiscard]] bool with_times() const { return columns_.time.has_value(); }
  [[nodiscard]] const std::vector<std::string>& targets() const { return targets_.all(); }
  /// One unit of the last decimal of the positions so far.
  [[nodiscard]] double step_mm() const { return step_mm_.value_or(0); }

 private:
  [[nodiscard]] bool split_fields(std::string_view line);
  [[nodiscard]] bool may_have_thousands();
  [[nodiscard]] std::optional<double> number(const Place& place, std::optional<double>* step);

  std::size_t count_ = 0;  // of columns
  PointColumns columns_;
  std::vector<std::string_view> fields_;
  bool is_comma_decimal_ = false;  // in the current line, where a number has one
  bool shown_decimal_ = false;     // by a comma that cannot stand between thousands
  TargetNames targets_;
  std::optional<double> step_mm_;
};

/// In words, for people: "a point", "a line with more or fewer fields than columns", ...
[[nodiscard]] std::string_view text(DeviceLines::Line line) noexcept;

/// Takes the next line off `bytes`, without its end.
[[nodiscard]] std::string_view next_line(std::string_view& bytes);

}  // namespace sweepd
