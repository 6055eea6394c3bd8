#pragma once

// Catch2 as tests include it: version 2 (Debian 12), or version 3 (Debian 13), which has other
// headers and other names.
#if __has_include(<catch2/catch.hpp>)
#include <catch2/catch.hpp>
namespace Catch::Matchers {
inline auto ContainsSubstring(const std::string& part) {
  return Contains(part);
}
}  // namespace Catch::Matchers
#else
#include <catch2/catch_all.hpp>
using Catch::Approx;
#endif
