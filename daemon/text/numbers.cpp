#include "daemon/text/numbers.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace sweepd {
namespace {

constexpr std::array kPowers{1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};

/// Up to here a double says no more than its whole number of units does.
constexpr double kMostUnits = 1e15;
constexpr std::size_t kLongestNumber = 400;  // the largest double has 309 digits before the point

double power_of_ten(int exponent) {
  const auto index = static_cast<std::size_t>(exponent);
  return index < kPowers.size() ? kPowers[index] : std::pow(10.0, exponent);
}

constexpr auto kPairs = [] {
  std::array<char, 200> pairs{};
  for (std::size_t k = 0; k < pairs.size(); ++k)
    pairs[k] = static_cast<char>('0' + (k % 2 == 0 ? k / 20 : k / 2 % 10));
  return pairs;
}();

/// So many units of the last decimal, below kMostUnits.
void append_units(std::string& text, double units, int decimals) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): written to before it is read
  std::array<char, kLongestNumber> digits;
  char* const end = digits.data() + digits.size();
  char* at = end;
  auto rest = static_cast<std::uint64_t>(std::abs(units));
  const auto write_digit = [&] {
    *--at = static_cast<char>('0' + rest % 10);
    rest /= 10;
  };
  const auto write_pair = [&] {
    std::memcpy(at -= 2, &kPairs[2 * (rest % 100)], 2);
    rest /= 100;
  };
  if (decimals % 2 == 1) write_digit();
  for (int pairs = decimals / 2; pairs > 0; --pairs) write_pair();
  if (decimals > 0) *--at = '.';
  while (rest >= 100) write_pair();
  write_digit();
  if (rest > 0) write_digit();
  if (units < 0) *--at = '-';
  text.append(at, static_cast<std::size_t>(end - at));
}

}  // namespace

double rounded(double value, int decimals) {
  const double unit = power_of_ten(decimals);
  const double units = std::round(value * unit);
  const double result = std::isfinite(units) ? units / unit : value;
  return result == 0 ? 0 : result;
}

void append_fixed(std::string& text, double value, int decimals) {
  const double units = std::round(value * power_of_ten(decimals));
  if (std::abs(units) < kMostUnits) return append_units(text, units, decimals);
  std::array<char, kLongestNumber> digits{};
  text.append(digits.data(),
              std::to_chars(digits.data(), digits.data() + digits.size(), rounded(value, decimals),
                            std::chars_format::fixed, decimals)
                  .ptr);
}

void append_measured(std::string& text, double value, int decimals) {
  const double units = std::round(value * power_of_ten(decimals));
  if (std::abs(units) < kMostUnits) {
    auto rest = static_cast<std::int64_t>(units);
    for (; decimals > 0 && rest % 10 == 0; --decimals) rest /= 10;
    return append_units(text, static_cast<double>(rest), decimals);
  }
  std::array<char, kLongestNumber> digits{};
  text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(),
                                           rounded(value, decimals), std::chars_format::fixed)
                                 .ptr);
}

int decimals_for(double uncertainty, int fewest, int most) {
  if (!(uncertainty > 0)) return most;
  return static_cast<int>(
      std::clamp(1 - std::floor(std::log10(uncertainty)), double(fewest), double(most)));
}

std::string chance_text(double chance) {
  return chance < kLeastChance ? "<" + fixed(kLeastChance, 4) : fixed(chance, 4);
}

std::string share_text(double chance) {
  const auto percent = [](double share, int decimals) {
    return fixed(100 * share, decimals) + " %";
  };
  if (chance < kLeastChance) return "less than " + percent(kLeastChance, 2);
  return percent(chance, chance < 0.001 ? 2 : chance < 0.1 ? 1 : 0);
}

std::string fixed(double value, int decimals) {
  std::string text;
  append_fixed(text, value, decimals);
  return text;
}

}  // namespace sweepd
