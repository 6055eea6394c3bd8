#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace sweepd {

/// A character of a text, both from 1.
struct TextPlace {
  std::size_t line = 1;
  std::size_t column = 1;
};

/// Where a TOML text first nests deeper than `most`: brackets within brackets, and the parts of a
/// dotted key. To be asked before the text is parsed: a parser goes as deep as the text, and its
/// stack ends somewhere. Whatever the text holds, a parser that stops at the first mistake meets no
/// more than `most` levels of brackets with `most` parts of a key each.
[[nodiscard]] std::optional<TextPlace> too_deep(std::string_view text, std::size_t most);

}  // namespace sweepd
