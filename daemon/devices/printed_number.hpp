#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "rsi/telegram/decimal.hpp"

namespace sweepd {

/// A finite number as a file prints it. `decimals` are those of the value: 1.25e-3 has 5.
[[nodiscard]] std::optional<rsi::Decimal> printed_number(std::string_view text);

/// A field for a message: in quotes and cut, or "nothing".
[[nodiscard]] std::string as_found(std::string_view text);

}  // namespace sweepd
