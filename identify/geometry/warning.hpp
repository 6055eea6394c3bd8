#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

namespace identify {

/// Something that the user should know; `code` is for programs and stays.
struct Warning {
  std::string code;
  std::optional<std::size_t> joint;  ///< counted from 0
  std::string message;
};

/// The number with so many decimals, whatever the locale; minus nought is nought.
inline std::string fixed(double value, int decimals) {
  std::array<char, 400> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value,
                                          std::chars_format::fixed, decimals);
  const std::string number(text.data(), error == std::errc() ? end : text.data());
  if (number.empty()) return "?";
  return number.find_first_not_of("-0.") == std::string::npos && number.front() == '-'
             ? number.substr(1)
             : number;
}

/// As people count: "joint 1" is the first.
inline std::string joint_name(std::size_t joint) {
  return "joint " + std::to_string(joint + 1);
}

/// As in "joints 1, 4".
inline std::string joints_named(const std::vector<std::size_t>& joints) {
  std::string text = joints.size() == 1 ? "joint " : "joints ";
  for (std::size_t k = 0; k < joints.size(); ++k)
    text += (k == 0 ? "" : ", ") + std::to_string(joints[k] + 1);
  return text;
}

/// With two digits that tell something.
inline std::string brief(double value) {
  const double size = std::abs(value);
  if (!(size > 1e-9)) return "0";
  return fixed(value, std::clamp(1 - static_cast<int>(std::floor(std::log10(size))), 0, 9));
}

}  // namespace identify
