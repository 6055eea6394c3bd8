#include "identify/dh/dh_comparison.hpp"

#include <algorithm>
#include <cmath>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/warning.hpp"

namespace identify {

std::vector<DhDifference> compare_with_specified(
    const std::vector<DhEstimate>& dh, const std::vector<DhRow>& specified_rows,
    const std::vector<std::optional<double>>& home_rad) {
  std::vector<DhDifference> differences;
  for (std::size_t i = 0; i < specified_rows.size(); ++i) {
    const DhEstimate& row = dh[i];
    const DhRow& specified = specified_rows[i];
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
    if (home_rad[i]) difference.theta_rad = angle(row.theta_rad, specified.theta_rad);
    differences.push_back(difference);
  }
  return differences;
}

std::string differing_numbers(const std::vector<DhEstimate>& table,
                              const std::vector<DhEstimate>& other) {
  std::string text;
  const auto compare = [&](const char* name, std::size_t j, const DhNumber& here,
                           const DhNumber& there, double unit, const char* unit_name) {
    constexpr double kChanged = 0.01;
    if (here.knowledge != Knowledge::identified || there.knowledge != Knowledge::identified ||
        std::abs(there.value - here.value) / unit < kChanged)
      return;
    text += (text.empty() ? "" : ", ") + std::string(name) + std::to_string(j + 1) + " would be " +
            fixed(there.value / unit, 2) + " instead of " + fixed(here.value / unit, 2) + " " +
            unit_name;
  };
  for (std::size_t j = 0; j < std::min(table.size(), other.size()); ++j) {
    compare("b", j, table[j].b_mm, other[j].b_mm, 1, "mm");
    compare("theta", j, table[j].theta_rad, other[j].theta_rad, kDegree, "deg");
    compare("a", j, table[j].a_mm, other[j].a_mm, 1, "mm");
    compare("alpha", j, table[j].alpha_rad, other[j].alpha_rad, kDegree, "deg");
  }
  return text.empty() ? "the table would be the same" : "the other way, " + text;
}

}  // namespace identify
