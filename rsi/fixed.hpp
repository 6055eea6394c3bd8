#pragma once

#include <array>
#include <charconv>
#include <string>

namespace rsi {

/// A number with so many decimals, whatever the locale is: "4.00".
[[nodiscard]] inline std::string fixed(double value, int decimals) {
  std::array<char, 400> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                 std::chars_format::fixed, decimals);
  return {digits.data(), end.ptr};
}

}  // namespace rsi
