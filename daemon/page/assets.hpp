#pragma once

#include <string_view>
#include <vector>

namespace sweepd {

/// A file of the live page, from daemon/page/assets/. The build puts them into the program.
struct Asset {
  std::string_view path;  ///< "/assets/page.js"
  std::string_view type;
  std::string_view text;
};

[[nodiscard]] const std::vector<Asset>& assets();

}  // namespace sweepd
