#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "rsi/words.hpp"

namespace rsi {

/// A number as it was printed.
struct Decimal {
  double value = 0;
  int decimals = 0;  ///< digits after the decimal point: "-90.0" has 1
};

/// A finite decimal number, with or without sign and exponent; nothing for anything else.
[[nodiscard]] std::optional<double> number(std::string_view text) noexcept;

/// Digits after the decimal point of a number as it was printed: "-90.0" has 1.
[[nodiscard]] int decimals(std::string_view text) noexcept;

/// Reads numbers like -123.4567, with two to eight digits; false for any other text. Eight digits
/// and the power of ten are exact doubles, and one division gives the nearest double, as number()
/// does.
[[nodiscard]] inline bool read_short(std::string_view text, Decimal& found) noexcept {
  static constexpr std::array kPowers{1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7};
  static constexpr std::array kSigns{1.0, -1.0};  // looked up: nobody could predict a branch
  constexpr std::uint64_t kHigh = 0x80 * kEachByte;
  const std::size_t sign = text.starts_with('-') ? 1 : 0;
  const std::size_t size = text.size() - sign;
  if (size < 3 || size > 9) return false;
  const char* const begin = text.data() + sign;
  const std::uint64_t word = size < 8 ? word_at(begin, size) : word_at(begin);
  const std::uint64_t next = size < 9 ? word >> 8 : word_at(begin + 1);
  const std::uint64_t off = word ^ '.' * kEachByte;
  const std::uint64_t point = (off - kEachByte) & ~off & kHigh;  // and perhaps some behind it
  const auto whole = static_cast<std::size_t>(std::countr_zero(point)) / 8;
  const std::uint64_t before = ((point & -point) >> 7) - 1;
  // What is left of '0', the last digit in the highest byte.
  std::uint64_t digits = (next ^ ((word ^ next) & before)) ^ '0' * kEachByte;
  digits <<= 8 * (9 - size);
  const std::uint64_t others = (digits | (digits + (0x7f - 9) * kEachByte)) & kHigh;
  if (point == 0 || whole == 0 || others != 0) return false;
  // Neighbours are joined, all pairs at a time.
  digits = digits * (1 + (10 << 8)) >> 8 & 0x00ff'00ff'00ff'00ff;
  digits = digits * (1 + (100 << 16)) >> 16 & 0x0000'ffff'0000'ffff;
  digits = digits * (1 + (std::uint64_t{10'000} << 32)) >> 32;
  const std::size_t fraction = size - 1 - whole;
  const double value = static_cast<double>(static_cast<std::int64_t>(digits)) / kPowers[fraction];
  found.value = kSigns[sign] * value;
  found.decimals = static_cast<int>(fraction);
  return true;
}

/// A finite decimal number, with or without sign and exponent; false for anything else.
[[nodiscard]] inline bool read(std::string_view text, Decimal& found) noexcept {
  if (read_short(text, found)) return true;
  const auto value = number(text);
  if (value) found = {*value, decimals(text)};
  return value.has_value();
}
[[nodiscard]] inline std::optional<Decimal> decimal(std::string_view text) noexcept {
  Decimal found;
  return read(text, found) ? std::optional(found) : std::nullopt;
}

}  // namespace rsi
