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
                            angle(row.alpha_rad, specified.alpha_rad),
                            {}};
    if (has_beta(row)) difference.beta_rad = angle(row.beta_rad, specified.beta_rad);
    if (home_rad[i]) difference.theta_rad = angle(row.theta_rad, specified.theta_rad);
    differences.push_back(difference);
  }
  return differences;
}

std::string differing_numbers(const std::vector<DhEstimate>& table,
                              const std::vector<std::vector<DhEstimate>>& others) {
  std::string text;
  const auto compare = [&](std::size_t j, const DhNumberName& of) {
    constexpr double kChanged = 0.01;
    const double unit = of.length ? 1 : kDegree;
    const DhNumber& here = table[j].*of.number;
    if (here.knowledge != Knowledge::identified) return;
    std::vector<double> seen{here.value / unit};
    std::string values;
    for (const auto& other : others) {
      const DhNumber& there = other[j].*of.number;
      const double value = there.value / unit;
      if (there.knowledge != Knowledge::identified ||
          std::any_of(seen.begin(), seen.end(),
                      [&](double before) { return std::abs(value - before) < kChanged; }))
        continue;
      seen.push_back(value);
      values += (values.empty() ? "" : " or ") + fixed(value, 2);
    }
    if (values.empty()) return;
    text += (text.empty() ? "" : ", ") + std::string(of.name) + std::to_string(j + 1) +
            " would be " + values + " instead of " + fixed(seen.front(), 2) + " " +
            std::string(of.unit());
  };
  for (std::size_t j = 0; j < table.size(); ++j)
    for (const DhNumberName& of : kDhNumbers)
      if (of.number != &DhEstimate::beta_rad) compare(j, of);
  return text.empty() ? "the table would be the same" : "the other way, " + text;
}

}  // namespace identify
