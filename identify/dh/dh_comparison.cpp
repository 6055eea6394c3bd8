#include "identify/dh/dh_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

std::vector<OtherNumber> other_numbers(const std::vector<DhEstimate>& table,
                                       const std::vector<std::vector<DhEstimate>>& others) {
  std::vector<OtherNumber> all;
  for (std::size_t j = 0; j < table.size(); ++j)
    for (std::size_t k = 0; k < kDhNumbers.size(); ++k) {
      const DhNumberName& name = kDhNumbers[k];
      const DhNumber& here = table[j].*name.number;
      if (here.knowledge != Knowledge::identified) continue;
      OtherNumber one{j, k, {}};
      for (const auto& other : others) {
        const DhNumber& there = other[j].*name.number;
        if (there.knowledge != Knowledge::identified || there.value == here.value) continue;
        const double difference = there.value - here.value;
        one.differences.push_back(name.length ? difference : wrapped(difference));
      }
      if (!one.differences.empty()) all.push_back(std::move(one));
    }
  return all;
}

std::string differing_numbers(const std::vector<DhEstimate>& table,
                              const std::vector<OtherNumber>& others) {
  constexpr double kShown = 0.01;
  std::string text;
  for (const OtherNumber& other : others) {
    const DhNumberName& name = kDhNumbers[other.number];
    if (name.number == &DhEstimate::beta_rad) continue;
    const auto shown = [&](double value) { return name.length ? value : wrapped(value) / kDegree; };
    const double here = (table[other.row].*name.number).value;
    std::vector<double> seen{shown(here)};
    std::string values;
    for (const double difference : other.differences) {
      const double value = shown(here + difference);
      if (std::any_of(seen.begin(), seen.end(),
                      [&](double before) { return std::abs(value - before) < kShown; }))
        continue;
      seen.push_back(value);
      values += (values.empty() ? "" : " or ") + fixed(value, 2);
    }
    if (values.empty()) continue;
    text += (text.empty() ? "" : ", ") + std::string(name.name) + std::to_string(other.row + 1) +
            " would be " + values + " instead of " + fixed(seen.front(), 2) + " " +
            std::string(name.unit());
  }
  return text.empty() ? "the table would be the same" : "the other way, " + text;
}

}  // namespace identify
