#include "daemon/numbers.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace sweepd {

double rounded(double value, int decimals) {
  const double unit = std::pow(10.0, decimals);
  const double result = std::round(value * unit) / unit;
  return result == 0 ? 0 : result;
}

std::string fixed(double value, int decimals) {
  std::array<char, 400> text;  // the largest double has 309 digits before the point
  const auto end = std::to_chars(text.data(), text.data() + text.size(), rounded(value, decimals),
                                 std::chars_format::fixed, decimals)
                       .ptr;
  return {text.data(), end};
}

}  // namespace sweepd
