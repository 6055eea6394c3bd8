#pragma once

#include <cstddef>
#include <vector>

namespace identify {

/// Number `index` of Halton's sequence in a base: evenly between 0 and 1 (Numer. Math. 2, 1960).
[[nodiscard]] inline double halton(std::size_t index, std::size_t base) {
  double share = 1, value = 0;
  for (; index > 0; index /= base) {
    share /= static_cast<double>(base);
    value += share * static_cast<double>(index % base);
  }
  return value;
}

/// Point `index` of the sequence in a cube of so many dimensions, twelve at most.
[[nodiscard]] inline std::vector<double> halton_point(std::size_t index, std::size_t dimensions) {
  constexpr std::size_t kPrimes[] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};
  std::vector<double> point(dimensions);
  for (std::size_t k = 0; k < dimensions; ++k) point[k] = halton(index, kPrimes[k]);
  return point;
}

}  // namespace identify
