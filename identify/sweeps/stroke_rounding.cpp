#include "identify/sweeps/stroke_rounding.hpp"

#include <algorithm>
#include <cmath>

#include "identify/geometry/angle.hpp"
#include "identify/sweeps/stroke_curve.hpp"
#include "identify/sweeps/stroke_samples.hpp"

namespace identify {

using Eigen::Index;

StrokeRounding::Shifts StrokeRounding::shifts(double step_mm, double step_rad) const {
  // Squares of evenly spread errors, whose mean is known, scatter by 2 / sqrt(5) of it each.
  constexpr double kOfSquares = 0.894;
  constexpr double kChance = 3;  // standard deviations
  // Of a saw tooth as long as the stroke, with any phase: the variance of its first Chebyshev
  // coefficient, in that of the tooth.
  constexpr double kGrowth = 0.6;
  const double chance = kChance * kOfSquares / std::sqrt(std::max(1.0, samples));
  Shifts variances;
  for (Index k = 0; k < extent.size(); ++k) {
    const double step = k < 3 ? step_mm : step_rad;
    if (!(step > 0)) continue;
    const double whole = step * step / 12;
    // Where it turns back, a coordinate that passes n steps stays within one for 1 / sqrt(n) of the
    // samples. Noise of variance s^2 leaves of the saw tooth's first wave exp(-2 (pi s / step)^2).
    const double noise = std::max(0.0, scatter(k) - whole) / (step * step);
    const double turning = std::exp(-2 * kPi * kPi * noise) / (1 + extent(k) / step);
    double unseen = k < 3 ? 0 : 1 - scatter(k) / whole;
    if (unseen < chance) unseen = 0;
    variances.level(k) = whole * std::max(turning, unseen);
    variances.growth(k) =
        whole * std::max(turning * (1 - turning) / 3, kGrowth * (unseen - turning));
  }
  return variances;
}

StrokeRounding rounding_of(const StrokeSamples& seen, bool orientation, const StrokeCurve& curve) {
  StrokeRounding rounding;
  const Index count = seen.positions_mm.cols();
  if (count == 0) return rounding;
  SampleRows angles(3, count);  // since the first sample, on beyond half a turn
  angles.col(0).setZero();
  for (Index i = 1; i < count; ++i) {
    const auto& before = seen.samples[static_cast<std::size_t>(i - 1)]->abc_rad;
    const auto& here = seen.samples[static_cast<std::size_t>(i)]->abc_rad;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = static_cast<Index>(k);
      angles(at, i) = angles(at, i - 1) + short_way(here[k] - before[k]);
    }
  }
  const auto extent = [](const SampleRows& rows) -> Eigen::Array3d {
    return rows.rowwise().maxCoeff() - rows.rowwise().minCoeff();
  };
  rounding.extent << extent(seen.positions_mm), extent(angles);
  rounding.samples = seen.weights.sum();
  if (!orientation) return rounding;
  const double free = std::max(1.0, rounding.samples - static_cast<double>(curve.orders()));
  rounding.scatter.tail<3>() =
      (curve.left(angles).square().rowwise() * seen.weights.transpose()).rowwise().sum() / free;
  return rounding;
}

double unseen_zero(double mean, double variance) {
  const double part = mean - std::floor(mean);
  // It stood at the edge between two steps and wobbled little, whatever share of them is which.
  constexpr double kAlike = 1.05;
  if (variance > 0 && variance <= kAlike * part * (1 - part))
    return std::min(kEvenlySpread, std::abs(part - 0.5));
  // The mean of rounded numbers is off by what is left of the saw tooth's first wave.
  return kEvenlySpread * std::exp(-2 * kPi * kPi * variance);
}

}  // namespace identify
