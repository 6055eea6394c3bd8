#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace rsi {

/// How the byte length before an XML text is written (PROTCOLLENGTH On). KUKA's form is not known:
/// all that are likely are understood, and a reply has the form of the telegram that it answers.
enum class LengthPrefix : std::uint8_t {
  none,
  decimal,      ///< ASCII digits, no more than are needed
  binary16_be,  ///< two bytes, the high one first
  binary16_le,
  binary32_be,
  binary32_le,
};

[[nodiscard]] std::string_view text(LengthPrefix form) noexcept;

/// The bytes of a length.
struct LengthBytes {
  std::array<char, 10> bytes{};
  std::size_t size = 0;

  [[nodiscard]] std::string_view view() const noexcept { return {bytes.data(), size}; }
};

/// The length as it stands on the wire; nothing for `none`. Does not allocate.
[[nodiscard]] LengthBytes length_bytes(LengthPrefix form, std::uint32_t length) noexcept;

/// A length that was found: its form, and how many bytes it takes.
struct FoundLength {
  LengthPrefix form = LengthPrefix::none;
  std::size_t size = 0;
};

/// The length at the end of `before`, which is what stands before an XML text of `length` bytes. A
/// line end, CR LF or NUL behind the XML may be counted in: up to two bytes more. Digits may have
/// leading zeros. Where two forms fit, `likely` is taken. `none` if none fits.
[[nodiscard]] FoundLength find_length(std::string_view before, std::uint32_t length,
                                      LengthPrefix likely) noexcept;

}  // namespace rsi
