#include "rsi/telegram/decimal.hpp"

#include <charconv>
#include <cmath>

#include "rsi/ascii.hpp"

namespace rsi {

std::optional<double> number(std::string_view text) noexcept {
  text = trimmed(text);
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0;
  const auto* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

int decimals(std::string_view text) noexcept {
  const auto point = text.find('.');
  if (point == std::string_view::npos) return 0;
  const auto end = text.find_first_not_of("0123456789", point + 1);
  return static_cast<int>((end == std::string_view::npos ? text.size() : end) - point - 1);
}

}  // namespace rsi
