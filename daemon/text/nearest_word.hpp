#pragma once

#include <string_view>
#include <vector>

namespace sweepd {

/// The word that was probably meant; empty if none is near. One with a forgotten unit (`_ms`) is.
[[nodiscard]] std::string_view nearest_word(std::string_view wrong,
                                            const std::vector<std::string_view>& words);

}  // namespace sweepd
