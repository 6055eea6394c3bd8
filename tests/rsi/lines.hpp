#pragma once

#include <string>
#include <vector>

namespace rsi::test {

/// Each with an end of line.
inline std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const auto& line : lines) text += line + '\n';
  return text;
}

}  // namespace rsi::test
