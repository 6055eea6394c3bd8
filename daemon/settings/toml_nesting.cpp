#include "daemon/settings/toml_nesting.hpp"

#include <algorithm>

namespace sweepd {
namespace {

/// The last character of the string that begins at `begin` with its quote. One that has no end
/// ends where a parser gives it up: with its line, or with the text.
std::size_t end_of_string(std::string_view text, std::size_t begin) {
  const char quote = text[begin];
  const auto quotes = [&](std::size_t at) {
    std::size_t count = 0;
    while (at + count < text.size() && text[at + count] == quote) ++count;
    return count;
  };
  const std::size_t opening = quotes(begin);
  if (opening == 2) return begin + 1;  // empty
  const bool long_one = opening >= 3;
  for (std::size_t at = begin + (long_one ? 3 : 1); at < text.size(); ++at) {
    if (text[at] == '\\' && quote == '"') {
      ++at;
    } else if (text[at] == '\n' && !long_one) {
      return at - 1;
    } else if (text[at] == quote) {
      if (!long_one) return at;
      // Up to two quotes may stand before the three that end it.
      const std::size_t count = std::min<std::size_t>(quotes(at), 5);
      at += count - 1;
      if (count >= 3) return at;
    }
  }
  return text.size() - 1;
}

}  // namespace

std::optional<TextPlace> too_deep(std::string_view text, std::size_t most) {
  std::size_t open = 0;
  std::size_t dots = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    switch (text[at]) {
      case '#':
        at = std::min(text.find('\n', at), text.size()) - 1;
        break;
      case '"':
      case '\'':
        at = end_of_string(text, at);
        break;
      case '[':
      case '{':
        ++open;
        dots = 0;
        break;
      case ']':
      case '}':
        open -= std::min<std::size_t>(open, 1);
        dots = 0;
        break;
      case '.':
        ++dots;
        break;
      case ',':
      case '=':
      case '\n':
        dots = 0;
        break;
      default:
        break;
    }
    if (open + dots <= most) continue;
    const auto before = text.substr(0, at);
    const auto line = std::count(before.begin(), before.end(), '\n');
    return TextPlace{static_cast<std::size_t>(line) + 1, at - (before.rfind('\n') + 1) + 1};
  }
  return std::nullopt;
}

}  // namespace sweepd
