#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/dh/dh_extraction.hpp"
#include "identify/geometry/angle.hpp"

namespace identify {

/// A built robot is never so far off what its maker specifies. Lengths, in mm or as a share of the
/// arm's (the sum of all its lengths), whichever is more; twists; and thetas, which mastering
/// shifts. Castings and machining miss by a millimetre and some hundredths of a degree, mastering
/// by a degree.
inline constexpr double kMostOff_mm = 8;
inline constexpr double kMostOffShare = 0.004;
inline constexpr double kMostTwist_rad = 1 * kDegree;
inline constexpr double kMostOff_rad = 5 * kDegree;

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

/// A number of a table that others have otherwise.
struct OtherNumber {
  std::size_t row = 0;
  std::size_t number = 0;           ///< of kDhNumbers
  std::vector<double> differences;  ///< of the others from the table's; mm or rad, wrapped
};

/// The numbers that are identified in the table and, otherwise, in others of the same joints.
[[nodiscard]] std::vector<OtherNumber> other_numbers(
    const std::vector<DhEstimate>& table, const std::vector<std::vector<DhEstimate>>& others);

/// In words: "the other way, b4 would be 620.00 or 310.00 instead of -620.00 mm, …".
[[nodiscard]] std::string differing_numbers(const std::vector<DhEstimate>& table,
                                            const std::vector<OtherNumber>& others);

}  // namespace identify
