#include "daemon/devices/table_units.hpp"

#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

/// Whether the word "in" is the unit: behind a sign, as in "Units: in deg", or last of what is
/// said. Else it is none, as in "pressure in hPa".
bool is_inch(std::string_view before, std::string_view behind) {
  before = rsi::trimmed(before);
  behind = rsi::trimmed(behind);
  const bool follows_sign =
      !before.empty() && !rsi::is_letter(before.back()) && !rsi::is_digit(before.back());
  return follows_sign || behind.empty() || !rsi::is_letter(behind.front());
}

}  // namespace

std::string unit_above(const DeviceText& text, std::size_t end) {
  for (std::size_t line = 0; line < end; ++line) {
    const std::string words = lower(text.line(line)) + ' ';
    const auto said = words.find("unit");
    if (said == std::string::npos) continue;
    std::string found;
    std::string word;
    for (std::size_t at = said + 4; at < words.size(); ++at) {
      // Letters of other alphabets are some too: the m of a micrometre is no metre.
      if (rsi::is_letter(words[at]) || static_cast<unsigned char>(words[at]) >= 0x80) {
        word += words[at];
        continue;
      }
      // "in" may be no unit.
      if (length_unit_mm(word) > 0 && (found.empty() || found == "in") &&
          (word != "in" ||
           is_inch(std::string_view(words).substr(0, at - 2), std::string_view(words).substr(at))))
        found = word;
      word.clear();
    }
    if (!found.empty()) return found;
  }
  return {};
}

std::string_view unit_below(const DeviceText& text, std::size_t line, char separator,
                            const std::vector<std::size_t>& columns) {
  const auto units = fields_of(text.line(line), separator);
  const auto of = [&](std::size_t column) {
    auto unit = column < units.size() ? units[column] : std::string_view();
    while (!unit.empty() && (unit.front() == '(' || unit.front() == '[')) unit.remove_prefix(1);
    while (!unit.empty() && (unit.back() == ')' || unit.back() == ']')) unit.remove_suffix(1);
    return unit;
  };
  const auto first = of(columns.front());
  if (length_unit_mm(first) == 0) return {};
  for (const std::size_t column : columns)
    if (length_unit_mm(of(column)) != length_unit_mm(first))
      text.fail(line, "expected one unit for X, Y and Z, found " + as_found(first) + " and " +
                          as_found(of(column)) + ": export the file again");
  return first;
}

}  // namespace sweepd
