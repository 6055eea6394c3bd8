#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "daemon/devices/device_layout.hpp"
#include "daemon/devices/device_text.hpp"
#include "rsi/telegram/decimal.hpp"

namespace sweepd {

/// Reads the lines of a device's file by its layout, one after the other.
///
/// Nothing, nan, null and the like are a missing value, and so is what the layout says. Decimals
/// stand behind a point or a comma, the same in the whole file. All functions throw CsvError, with
/// line, column and what to do.
class DeviceRows {
 public:
  /// A target that was measured in the current line.
  struct Seen {
    std::size_t target = 0;  ///< of the layout's
    std::string name;
    Eigen::Vector3d position_mm;
    std::optional<Eigen::Matrix3d> rotation;
    double step_mm = 0;  ///< the last decimal of the position
  };

  /// `text` and `layout` outlive the rows. The arm has at most `joints`.
  DeviceRows(const DeviceText& text, const DeviceLayout& layout, std::size_t joints);

  /// Goes to the next line. False at the end.
  bool next();
  [[nodiscard]] const std::vector<Seen>& seen() const { return seen_; }
  /// Since the first line; a count of lines where the layout knows no time.
  [[nodiscard]] double time_s() const { return time_s_; }
  [[nodiscard]] std::size_t joint() const { return joint_; }  ///< from 1; 0 where none is told
  [[nodiscard]] std::size_t rows() const { return rows_; }
  /// Among the lines so far, those that begin with # or //.
  [[nodiscard]] std::size_t comments() const { return comments_; }
  [[nodiscard]] std::size_t line() const { return line_; }  ///< from 0

  /// At the time of the current line.
  [[noreturn]] void fail_time(const std::string& problem) const;

 private:
  [[nodiscard]] std::string_view field(std::size_t column) const;
  [[nodiscard]] std::optional<rsi::Decimal> decimal(std::size_t column);
  [[nodiscard]] std::optional<rsi::Decimal> number(std::size_t column, std::string_view text);
  [[nodiscard]] std::optional<Seen> measured(const TargetColumns& target);
  [[nodiscard]] std::optional<Eigen::Matrix3d> rotation(const RotationColumns& columns);
  [[nodiscard]] std::string target_name(const TargetColumns& target) const;
  void pass_over(std::string_view line);
  void read_time();
  void read_joint();
  void check_end() const;
  void check_thousands();
  /// What a position shows of what its . or , means.
  void note_sign(std::size_t column, std::string_view text);
  [[noreturn]] void fail(std::size_t column, const std::string& problem) const;

  const DeviceText& text_;
  const DeviceLayout& layout_;
  std::size_t joints_;
  Fields header_;
  Fields fields_;
  std::size_t line_;
  std::size_t next_;
  std::size_t rows_ = 0;
  std::size_t comments_ = 0;
  char mark_ = 0;  // of decimals, once seen
  std::size_t mark_line_ = 0;
  /// A number whose sign may stand between thousands.
  struct Grouped {
    std::size_t line = 0;
    std::size_t column = 0;
    std::string text;
  };
  std::optional<Grouped> grouped_;  // the first
  bool is_decimal_ = false;         // a position shows that the sign is one of decimals
  bool is_whole_ = false;           // a position has no sign
  std::optional<double> first_s_;
  std::optional<std::int64_t> first_whole_;
  double time_s_ = 0;
  std::size_t joint_ = 0;
  std::vector<Seen> seen_;
};

/// The number of a joint that a name tells: "joint 3", "J3", "Axis_3", "A3"; 0 for others.
[[nodiscard]] std::size_t joint_in(std::string_view name);

}  // namespace sweepd
