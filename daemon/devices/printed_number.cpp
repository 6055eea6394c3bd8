#include "daemon/devices/printed_number.hpp"

#include <algorithm>
#include <charconv>

#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

/// Digits after the point, were the number written without an exponent.
int decimals_of(std::string_view text, int decimals) {
  // A zero may be written with any exponent; no number that is taken has more digits than these.
  constexpr int kLeastExponent = -400;
  constexpr int kMostExponent = 12;
  const auto e = text.find_first_of("eE");
  if (e == std::string_view::npos) return decimals;
  const auto digits = text.substr(e + 1 + (text.substr(e + 1).starts_with('+') ? 1 : 0));
  int exponent = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
  return decimals - std::clamp(exponent, kLeastExponent, kMostExponent);
}

}  // namespace

std::optional<rsi::Decimal> printed_number(std::string_view text) {
  auto number = rsi::decimal(text);
  if (number) number->decimals = decimals_of(text, number->decimals);
  return number;
}

std::string as_found(std::string_view text) {
  return text.empty() ? "nothing" : '"' + rsi::in_short(text) + '"';
}

}  // namespace sweepd
