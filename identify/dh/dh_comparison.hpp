#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/dh/dh_extraction.hpp"

namespace identify {

/// Identified minus specified; angles wrapped to half a turn. Nothing where the number was not
/// identified: what convention sets cannot differ. Nothing for theta where the joint's home angle
/// is unknown, since the specified theta at that home is unknown then.
struct DhDifference {
  std::optional<double> b_mm;
  std::optional<double> theta_rad;
  std::optional<double> a_mm;
  std::optional<double> alpha_rad;
  std::optional<double> beta_rad;  ///< only of rows that have it
};

/// One row a joint; empty without a specified table. `specified` holds at `home_rad`.
[[nodiscard]] std::vector<DhDifference> compare_with_specified(
    const std::vector<DhEstimate>& dh, const std::vector<DhRow>& specified,
    const std::vector<std::optional<double>>& home_rad);

/// Which identified numbers are others in any of these tables, in words: "b4 would be 620.00 or
/// 310.00 instead of -620.00 mm, …".
[[nodiscard]] std::string differing_numbers(const std::vector<DhEstimate>& table,
                                            const std::vector<std::vector<DhEstimate>>& others);

}  // namespace identify
