#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace rsi {

/// The digits of the last <IPOC>…</IPOC> in a telegram: the one rule, by which telegrams are both
/// answered and read. Whatever else is wrong with it, a telegram that carries an IPOC can be
/// answered. Upper or lower case, with or without attributes, blanks around the digits, 1 to 20
/// digits of an unsigned 64-bit number; empty if there is none. What stands in comments, CDATA or
/// values of attributes is none. The view is part of
/// `datagram`. Neither allocates nor fails, and its work grows with the size alone; made for the
/// reply thread.
[[nodiscard]] std::string_view find_ipoc(std::string_view datagram) noexcept;

/// One that fell back by so much, in the IPOC's milliseconds, was not overtaken on the way: RSI
/// began anew.
inline constexpr std::uint64_t kNoLatecomer = 1000;

/// Whether `later` came behind `before` because it was overtaken on the way. By their difference,
/// so that 0 follows the greatest number.
[[nodiscard]] constexpr bool was_overtaken(std::uint64_t before, std::uint64_t later) noexcept {
  return before - later - 1 < kNoLatecomer - 1;
}

/// The number that `digits` stand for; nothing if it is no unsigned 64-bit number.
[[nodiscard]] std::optional<std::uint64_t> ipoc_number(std::string_view digits) noexcept;
/// The same of what an <IPOC> holds, which has 20 digits at most.
[[nodiscard]] std::optional<std::uint64_t> usable_ipoc(std::string_view digits) noexcept;

}  // namespace rsi
