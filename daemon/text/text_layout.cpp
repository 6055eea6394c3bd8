#include "daemon/text/text_layout.hpp"

#include <algorithm>

#include "daemon/text/numbers.hpp"

namespace sweepd {

std::string paragraph(const std::string& label, std::string_view text) {
  const auto width = [](std::string_view word) {
    return static_cast<std::size_t>(std::count_if(word.begin(), word.end(), [](char c) {
      return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
    }));
  };
  std::string out = label;
  std::size_t column = label.size();
  while (!text.empty()) {
    const auto word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    if (column > label.size() && column + 1 + width(word) > kColumns) {
      out += "\n" + std::string(label.size(), ' ');
      column = label.size();
    } else if (column > label.size()) {
      out += ' ';
      ++column;
    }
    out += word;
    column += width(word);
  }
  return out + "\n";
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const auto line = text.substr(0, text.find('\n'));
    lines.emplace_back(line);
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return lines;
}

std::string right(std::string text, std::size_t width) {
  if (text.size() < width) text.insert(0, width - text.size(), ' ');
  return text;
}
std::string left(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}
std::string number(double value, int decimals, std::size_t width) {
  return right(fixed(value, decimals), width);
}
std::string number(const std::optional<double>& value, int decimals, std::size_t width) {
  return value ? number(*value, decimals, width) : right("-", width);
}

}  // namespace sweepd
