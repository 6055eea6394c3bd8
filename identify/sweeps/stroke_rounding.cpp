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
  const auto count = static_cast<Index>(seen.samples.size());
  if (count == 0) return rounding;
  Eigen::MatrixXd since(6, count);  // the first sample
  since.col(0).setZero();
  for (Index i = 1; i < count; ++i) {
    const Sample& before = *seen.samples[static_cast<std::size_t>(i - 1)];
    const Sample& here = *seen.samples[static_cast<std::size_t>(i)];
    since.col(i).head<3>() = here.position_mm - seen.samples.front()->position_mm;
    // Angles go on beyond half a turn.
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = static_cast<Index>(3 + k);
      since(at, i) =
          since(at, i - 1) + std::remainder(here.abc_rad[k] - before.abc_rad[k], 2 * kPi);
    }
  }
  rounding.extent = since.rowwise().maxCoeff() - since.rowwise().minCoeff();
  rounding.samples = seen.weights.sum();
  if (!orientation) return rounding;
  const Eigen::MatrixXd left = curve.left(since.bottomRows<3>(), seen.weights);
  const double free = std::max(1.0, rounding.samples - static_cast<double>(curve.orders()));
  rounding.scatter.tail<3>() = (left.cwiseAbs2() * seen.weights).array() / free;
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
