#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace acceptance {

/// Differences between what two parts of the same arcs say.
struct Apart {
  std::vector<double> z;  ///< in their standard uncertainties
  std::vector<double> direction_deg, place_mm;
};

/// A campaign of the first halves of all arcs of an arm beside one of the second halves. What bends
/// an arc is not the same in both; each is an arm of its own to the estimator, and the truth need
/// not be known.
struct HalvesApart {
  std::string arm;
  Apart axes;   ///< two of each direction and two of each place, across the axis
  Apart table;  ///< the numbers that do not depend on where home is
};
/// Of all arms in the folders sweep-logs and sweep-logs-scene of `data`.
[[nodiscard]] std::vector<HalvesApart> halves_apart(const std::filesystem::path& data);

[[nodiscard]] double root_mean_square(const std::vector<double>& values);

}  // namespace acceptance
