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

/// The number that `digits` stand for; nothing if it is no unsigned 64-bit number.
[[nodiscard]] std::optional<std::uint64_t> ipoc_number(std::string_view digits) noexcept;

}  // namespace rsi
