#pragma once

#include <chrono>
#include <stdexcept>
#include <string>

#include "daemon/text/utc.hpp"

namespace sweepd {

/// Throws std::invalid_argument with the option's name.
[[nodiscard]] inline std::chrono::nanoseconds date_option(const std::string& name,
                                                          const std::string& text) {
  if (const auto time = parse_utc(text)) return *time;
  throw std::invalid_argument(name + ": " + text +
                              " is no date: write it as 2026-03-01 or 2026-03-01T14:30, in UTC");
}

}  // namespace sweepd
