#pragma once

#include <charconv>
#include <stdexcept>
#include <string>
#include <system_error>

#include "tests/rsi/lines.hpp"

namespace sweepd::test {

using rsi::test::joined;

/// `text` with `other` in the place of the first `part`.
inline std::string replaced(std::string text, const std::string& part, const std::string& other) {
  const auto at = text.find(part);
  if (at == std::string::npos) throw std::logic_error("no '" + part + "' to replace");
  return text.replace(at, part.size(), other);
}

/// The number that is all of `text`.
inline double number_in(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw std::logic_error("'" + text + "' is no number");
  return value;
}

}  // namespace sweepd::test
