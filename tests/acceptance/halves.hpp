#pragma once

#include <cstdint>
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

/// The axes of simulated arms all of whose joints but the first are elastic, up to `sag_arcsec`,
/// seen without noise but for a printed micrometre, over arcs of 140 degrees: what weight does to
/// locked joints while another turns. So many arms of each kind, built and standing at random.
[[nodiscard]] std::vector<HalvesApart> sagging_halves_apart(double sag_arcsec, std::uint32_t arms);

[[nodiscard]] double root_mean_square(const std::vector<double>& values);

}  // namespace acceptance
