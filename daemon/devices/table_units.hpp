#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/devices/device_text.hpp"

namespace sweepd {

// Units of length that stand not with the names of a table's columns, but in lines of their own.

/// From a line before `end`, with the word unit; empty where none tells.
[[nodiscard]] std::string unit_above(const DeviceText& text, std::size_t end);

/// Of these columns, from `line`; empty where it holds no units. Throws CsvError where they differ.
[[nodiscard]] std::string_view unit_below(const DeviceText& text, std::size_t line, char separator,
                                          const std::vector<std::size_t>& columns);

}  // namespace sweepd
