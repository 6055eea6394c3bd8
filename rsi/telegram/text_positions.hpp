#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace rsi {

/// Where in a text an offset lies, for messages. Finds it in logarithmic time, so that a file of
/// nothing but mistakes takes no longer than another. Offsets beyond the text mean its end.
class TextPositions {
 public:
  explicit TextPositions(std::string_view text);

  [[nodiscard]] int line(std::ptrdiff_t offset) const;  ///< from 1
  /// "line:column". Of an XML element whose name begins at `offset`: where its < stands, from 1.
  [[nodiscard]] std::string position(std::ptrdiff_t offset) const;

 private:
  [[nodiscard]] std::size_t clamped(std::ptrdiff_t offset) const;

  std::size_t size_;
  std::vector<std::size_t> lines_{0};  // where they begin
};

}  // namespace rsi
