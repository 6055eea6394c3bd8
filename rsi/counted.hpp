#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rsi {

/// A count before its noun: "1 telegram", "12 telegrams". `many`: where more than an s makes it,
/// as in "12 replies".
[[nodiscard]] inline std::string counted(std::uint64_t count, std::string_view one,
                                         std::string_view many = {}) {
  std::string text = std::to_string(count) + ' ';
  if (count == 1) return text.append(one);
  return many.empty() ? text.append(one).append("s") : text.append(many);
}

}  // namespace rsi
