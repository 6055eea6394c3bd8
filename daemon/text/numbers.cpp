#include "daemon/text/numbers.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace sweepd {
namespace {

constexpr std::array kPowers{1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};

double power_of_ten(int exponent) {
  const auto index = static_cast<std::size_t>(exponent);
  return index < kPowers.size() ? kPowers[index] : std::pow(10.0, exponent);
}

}  // namespace

double rounded(double value, int decimals) {
  const double unit = power_of_ten(decimals);
  const double units = std::round(value * unit);
  const double result = std::isfinite(units) ? units / unit : value;
  return result == 0 ? 0 : result;
}

void append_fixed(std::string& text, double value, int decimals) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): written to before it is read
  std::array<char, 400> digits;  // the largest double has 309 digits before the point
  auto* const end = digits.data() + digits.size();
  const double units = std::round(value * power_of_ten(decimals));
  if (!(std::abs(units) < 1e15)) {
    text.append(digits.data(), std::to_chars(digits.data(), end, rounded(value, decimals),
                                             std::chars_format::fixed, decimals)
                                   .ptr);
    return;
  }
  // Up to 15 digits a double says no more than the whole number of units does.
  auto rest = static_cast<std::uint64_t>(std::abs(units));
  char* at = end;
  for (int i = 0; i < decimals; ++i, rest /= 10) *--at = static_cast<char>('0' + rest % 10);
  if (decimals > 0) *--at = '.';
  do *--at = static_cast<char>('0' + rest % 10);
  while ((rest /= 10) > 0);
  if (units < 0) *--at = '-';
  text.append(at, static_cast<std::size_t>(end - at));
}

std::string fixed(double value, int decimals) {
  std::string text;
  append_fixed(text, value, decimals);
  return text;
}

}  // namespace sweepd
