#include "identify/dh_comparison.hpp"

namespace identify {

std::vector<DhDifference> compare_with_specified(const Identification& found) {
  std::vector<DhDifference> differences;
  for (std::size_t i = 0; i < found.specified.size(); ++i) {
    const DhEstimate& row = found.dh[i];
    const DhRow& specified = found.specified[i];
    const auto length = [](const DhNumber& number, double expected) -> std::optional<double> {
      if (number.knowledge != Knowledge::identified) return std::nullopt;
      return number.value - expected;
    };
    const auto angle = [&](const DhNumber& number, double expected) {
      auto difference = length(number, expected);
      if (difference) difference = wrapped(*difference);
      return difference;
    };
    DhDifference difference{length(row.b_mm, specified.b_mm),
                            {},
                            length(row.a_mm, specified.a_mm),
                            angle(row.alpha_rad, specified.alpha_rad)};
    if (found.home_rad[i]) difference.theta_rad = angle(row.theta_rad, specified.theta_rad);
    differences.push_back(difference);
  }
  return differences;
}

}  // namespace identify
