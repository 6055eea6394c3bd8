#include "rsi/telegram/length_prefix.hpp"

#include <charconv>

namespace rsi {
namespace {

constexpr std::array kForms{LengthPrefix::decimal, LengthPrefix::binary32_be,
                            LengthPrefix::binary32_le, LengthPrefix::binary16_be,
                            LengthPrefix::binary16_le};

constexpr bool is_digit(char c) noexcept {
  return c >= '0' && c <= '9';
}

LengthBytes binary(std::uint32_t length, std::size_t size, bool high_first) noexcept {
  LengthBytes bytes;
  bytes.size = size;
  for (std::size_t i = 0; i < size; ++i)
    bytes.bytes[high_first ? size - 1 - i : i] = static_cast<char>(length >> 8 * i & 0xff);
  return bytes;
}

/// How many bytes of this form at the end of `before` say `length`; 0 if they do not.
std::size_t match(std::string_view before, LengthPrefix form, std::uint32_t length) noexcept {
  const auto bytes = length_bytes(form, length);
  if (!before.ends_with(bytes.view())) return 0;
  if (form != LengthPrefix::decimal) return bytes.size;
  auto rest = before.substr(0, before.size() - bytes.size);
  while (rest.ends_with('0')) rest.remove_suffix(1);
  return rest.empty() || !is_digit(rest.back()) ? before.size() - rest.size() : 0;
}

std::size_t match_any(std::string_view before, LengthPrefix form, std::uint32_t length) noexcept {
  if (form == LengthPrefix::none) return 0;
  constexpr std::uint32_t kMostBehind = 2;
  for (std::uint32_t behind = 0; behind <= kMostBehind; ++behind)
    if (const auto size = match(before, form, length + behind); size > 0) return size;
  return 0;
}

}  // namespace

std::string_view text(LengthPrefix form) noexcept {
  switch (form) {
    case LengthPrefix::none:
      return "none";
    case LengthPrefix::decimal:
      return "decimal digits";
    case LengthPrefix::binary16_be:
      return "two bytes, high byte first";
    case LengthPrefix::binary16_le:
      return "two bytes, low byte first";
    case LengthPrefix::binary32_be:
      return "four bytes, high byte first";
    case LengthPrefix::binary32_le:
      return "four bytes, low byte first";
  }
  return "";
}

LengthBytes length_bytes(LengthPrefix form, std::uint32_t length) noexcept {
  LengthBytes bytes;
  switch (form) {
    case LengthPrefix::none:
      break;
    case LengthPrefix::decimal: {
      char* const begin = bytes.bytes.data();
      const auto end = std::to_chars(begin, begin + bytes.bytes.size(), length).ptr;
      bytes.size = static_cast<std::size_t>(end - begin);
      break;
    }
    case LengthPrefix::binary16_be:
      return binary(length, 2, true);
    case LengthPrefix::binary16_le:
      return binary(length, 2, false);
    case LengthPrefix::binary32_be:
      return binary(length, 4, true);
    case LengthPrefix::binary32_le:
      return binary(length, 4, false);
  }
  return bytes;
}

FoundLength find_length(std::string_view before, std::uint32_t length,
                        LengthPrefix likely) noexcept {
  if (before.empty()) return {};
  if (const auto size = match_any(before, likely, length); size > 0) return {likely, size};
  for (const auto form : kForms)
    if (const auto size = match_any(before, form, length); size > 0) return {form, size};
  return {};
}

}  // namespace rsi
