#pragma once

#include <cmath>
#include <optional>

namespace simulation {

/// The unit of the last decimal; zero where all are printed.
[[nodiscard]] inline double print_step(std::optional<int> decimals) {
  return decimals ? std::pow(10.0, -*decimals) : 0;
}

[[nodiscard]] inline double printed(double value, std::optional<int> decimals) {
  const double step = print_step(decimals);
  return step > 0 ? step * std::round(value / step) : value;
}

}  // namespace simulation
