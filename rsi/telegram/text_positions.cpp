#include "rsi/telegram/text_positions.hpp"

#include <algorithm>

namespace rsi {

TextPositions::TextPositions(std::string_view text) : size_(text.size()) {
  for (auto at = text.find('\n'); at != text.npos; at = text.find('\n', at + 1))
    lines_.push_back(at + 1);
}

int TextPositions::line(std::ptrdiff_t offset) const {
  return static_cast<int>(std::upper_bound(lines_.begin(), lines_.end(), clamped(offset)) -
                          lines_.begin());
}

std::string TextPositions::position(std::ptrdiff_t offset) const {
  const int line = this->line(offset);
  const auto column = clamped(offset) - lines_[static_cast<std::size_t>(line - 1)];
  return std::to_string(line) + ":" + std::to_string(std::max<std::size_t>(column, 1));
}

std::size_t TextPositions::clamped(std::ptrdiff_t offset) const {
  return offset < 0 ? 0 : std::min(static_cast<std::size_t>(offset), size_);
}

}  // namespace rsi
