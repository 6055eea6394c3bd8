#pragma once

#include <algorithm>
#include <charconv>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "rsi/telegram/decimal.hpp"

namespace sweepd {

// Parts of JSON, and cells of CSV, that another program may have written or shortened: what is
// missing, or is something else, is nothing, and never an error.

/// Not a number.
inline constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// What `json` has under `key`, or null.
[[nodiscard]] const nlohmann::ordered_json& part_of(const nlohmann::ordered_json& json,
                                                    const std::string& key);
/// The array under `key`, or an empty one.
[[nodiscard]] const nlohmann::ordered_json& list_of(const nlohmann::ordered_json& json,
                                                    const std::string& key);
/// The number under `key`, or NaN.
[[nodiscard]] double number_of(const nlohmann::ordered_json& json, const std::string& key);
/// The string under `key`, or an empty one.
[[nodiscard]] std::string text_of(const nlohmann::ordered_json& json, const std::string& key);
/// Whether `true` stands under `key`.
[[nodiscard]] bool flag_of(const nlohmann::ordered_json& json, const std::string& key);
/// Whether a joint of result.json moves along a line.
[[nodiscard]] bool is_linear(const nlohmann::ordered_json& joint);
/// An array of three numbers, or three NaN.
[[nodiscard]] Eigen::Vector3d vector_of(const nlohmann::ordered_json& json);

/// Takes the first line off `text`.
[[nodiscard]] inline std::string_view take_line(std::string_view& text) {
  const auto end = std::min(text.find('\n'), text.size());
  const auto line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

/// Not a number where there is none.
[[nodiscard]] inline double value_in(std::string_view cell) {
  if (rsi::Decimal number; rsi::read_short(cell, number)) return number.value;
  double value = kNothing;
  std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return value;
}

/// Cells of a line, in place; those that are not there are empty.
class Cells {
 public:
  void split(std::string_view line) {
    cells_.clear();
    for (std::size_t begin = 0; begin <= line.size();) {
      const auto end = std::min(line.find(',', begin), line.size());
      cells_.push_back(line.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  [[nodiscard]] std::string_view operator[](std::size_t at) const {
    return at < cells_.size() ? cells_[at] : std::string_view();
  }
  /// Beyond every line where there is none.
  [[nodiscard]] std::size_t find(std::string_view name) const {
    const auto place = std::find(cells_.begin(), cells_.end(), name);
    return place == cells_.end() ? std::string_view::npos
                                 : static_cast<std::size_t>(place - cells_.begin());
  }

 private:
  std::vector<std::string_view> cells_;
};

}  // namespace sweepd
