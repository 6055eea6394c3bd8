#pragma once

#include <algorithm>
#include <string>

#include "daemon/text/numbers.hpp"

namespace bench {

inline std::string right(const std::string& text, std::size_t width) {
  return std::string(width - std::min(width, text.size()), ' ') + text;
}

inline std::string left(const std::string& text, std::size_t width) {
  return text + std::string(width - std::min(width, text.size()), ' ');
}

inline std::string right(double value, int decimals, std::size_t width) {
  return right(sweepd::fixed(value, decimals), width);
}

}  // namespace bench
