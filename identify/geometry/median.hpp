#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

namespace identify {

/// The upper one of an even number; 0 of none. Reorders the values.
///
/// Where a value goes is computed and not branched on, which nobody could predict: a seventh of
/// std::nth_element's time. That has the last word, also where the pivots were bad.
[[nodiscard]] inline double median_in(std::span<double> values) {
  if (values.empty()) return 0;
  constexpr std::ptrdiff_t kFew = 32;
  constexpr int kMostRounds = 32;
  double* begin = values.data();
  double* end = begin + values.size();
  double* const middle = begin + values.size() / 2;
  const auto split = [&](const auto& is_before) {
    double* at = begin;
    for (double* next = begin; next != end; ++next) {
      const double value = *next;
      *next = *at;
      *at = value;
      at += is_before(value) ? 1 : 0;
    }
    return at;
  };
  const auto median_of_3 = [&](std::ptrdiff_t eighth) {
    const auto at = [&](std::ptrdiff_t k) { return begin[(end - begin - 1) * k / 8]; };
    const double a = at(eighth), b = at(eighth + 1), c = at(eighth + 2);
    return std::max(std::min(a, b), std::min(std::max(a, b), c));
  };
  for (int round = 0; round < kMostRounds && end - begin > kFew; ++round) {
    const double a = median_of_3(0), b = median_of_3(3), c = median_of_3(6);
    const double pivot = std::max(std::min(a, b), std::min(std::max(a, b), c));
    double* at = split([&](double value) { return value < pivot; });
    if (at == begin) {
      at = split([&](double value) { return value <= pivot; });
      if (middle < at) return pivot;
    }
    (middle < at ? end : begin) = at;
  }
  std::nth_element(begin, middle, end);
  return *middle;
}

/// The same of a copy.
[[nodiscard]] inline double median_of(std::vector<double> values) {
  return median_in(values);
}

/// Mean of those that are no further off the median than three times what four of five are: also of
/// values that are two in turn. Reorders them.
[[nodiscard]] inline double mean_of_most(std::span<double> values) {
  if (values.empty()) return 0;
  const double middle = median_in(values);
  const auto nearer = [&](double one, double other) {
    return std::abs(one - middle) < std::abs(other - middle);
  };
  const auto fourth_fifth = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 4 / 5);
  std::nth_element(values.begin(), fourth_fifth, values.end(), nearer);
  const double most = 3 * std::abs(*fourth_fifth - middle);
  const auto end = std::partition(fourth_fifth, values.end(),
                                  [&](double value) { return std::abs(value - middle) <= most; });
  return std::accumulate(values.begin(), end, 0.0) / static_cast<double>(end - values.begin());
}

/// How much more than the median distance from a circle says its points scatter where they are few:
/// the circle comes near to those that it was chosen by. 1 + 5/(n - p) (Rousseeuw & Leroy 1987,
/// Robust Regression and Outlier Detection, sec. 5.1), with p = 3 points that tell a circle.
[[nodiscard]] inline double for_few(std::ptrdiff_t points) {
  return 1 + 5 / static_cast<double>(std::max<std::ptrdiff_t>(1, points - 3));
}

}  // namespace identify
