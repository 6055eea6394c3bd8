#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/devices/device_layout.hpp"
#include "daemon/devices/device_text.hpp"

namespace sweepd {

// Files with the columns of many targets side by side.

/// Which column of one target is which value.
class WideTarget {
 public:
  /// "x", "y", "z" of the position; "rx", "ry", "rz", "rw" of the rotation; others are kept too.
  /// The first of each name counts.
  void add(std::string value, std::size_t column) {
    columns_.try_emplace(std::move(value), column);
  }

  [[nodiscard]] std::optional<std::size_t> column(std::string_view value) const;
  /// Nothing where one of them is missing.
  [[nodiscard]] std::optional<std::vector<std::size_t>> all(
      std::initializer_list<std::string_view> values) const;
  [[nodiscard]] std::optional<RotationColumns> quaternion() const;
  /// `order` names the axes: "XYZ"; nothing for any other text.
  [[nodiscard]] std::optional<RotationColumns> euler(std::string_view order, double unit_rad) const;

 private:
  std::map<std::string, std::size_t, std::less<>> columns_;
};

/// The targets of a file, and what was left out.
class WideTargets {
 public:
  /// Names stand in line `header`, for messages.
  WideTargets(const DeviceText& text, std::size_t header) : text_(text), header_(header) {}

  /// Throws CsvError where the name is there already, or an axis of the position is missing.
  void add(const std::string& name, const WideTarget& columns,
           std::optional<RotationColumns> rotation,
           std::optional<std::size_t> state = std::nullopt);
  /// Says so once for each `what`.
  void leave_out(const std::string& what, const std::string& why);

  /// Throws CsvError where there is no target.
  void into(DeviceLayout& layout) &&;

 private:
  const DeviceText& text_;
  std::size_t header_;
  std::vector<TargetColumns> targets_;
  std::map<std::string, std::vector<std::string>> left_out_;  // by reason
};

}  // namespace sweepd
