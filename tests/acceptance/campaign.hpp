#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace acceptance {

inline constexpr std::uint64_t kSeeds = 10;

/// A KR 5 arc that runs a plan, with the simulator's default noise.
struct SimulatedCampaign {
  std::string plan;  ///< a file of config/plans
  /// In place of the built-in one.
  std::optional<std::filesystem::path> ethernet_config = {};
  /// Whether the replay is told the plan.
  bool plan_is_known = false;
};

/// Simulates into a capture, replays that, and returns what stands in result.json.
[[nodiscard]] nlohmann::json replayed(const SimulatedCampaign& campaign, std::uint64_t seed);
/// The same for the seeds 1 to kSeeds.
[[nodiscard]] std::vector<nlohmann::json> replayed(const SimulatedCampaign& campaign);

/// How far identified numbers may be from the specified ones.
struct Bounds {
  double b_mm;
  double a_mm;
  double alpha_deg;
};
/// Those of the paper's Table 3, its largest deviations in b and a; alpha as this project wants it.
inline constexpr Bounds kBounds90{0.042, 0.009, 0.001};
inline constexpr Bounds kBounds30{0.081, 0.096, 0.01};

/// A parameter of the DH table over the results of several seeds.
struct Deviation {
  std::string name;    ///< as in result.json: "b_mm"
  std::size_t joint;   ///< from 1
  double worst = 0;    ///< the largest |identified - specified|
  double sigma = 0;    ///< the standard uncertainty that was predicted in that result
  double squares = 0;  ///< the sum of the squares of error / standard uncertainty
};

/// One for each number that was identified; those by convention are left out.
[[nodiscard]] std::vector<Deviation> deviations(const std::vector<nlohmann::json>& results);

/// Root mean square of error / standard uncertainty over all numbers and seeds.
[[nodiscard]] double chi(const std::vector<Deviation>& deviations);

/// CHECKs completeness, that b, a and alpha are within bounds, and that exactly those numbers are
/// by convention which no sweep can tell.
void check_within(const std::vector<nlohmann::json>& results, const Bounds& bounds);

/// CHECKs that every move of the plan was found once, with its direction and its range, and that
/// the positioning moves were told from the sweeps.
void check_strokes(const nlohmann::json& result, const std::string& plan);

}  // namespace acceptance
