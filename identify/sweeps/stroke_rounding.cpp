#include "identify/sweeps/stroke_rounding.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <vector>

#include "identify/geometry/angle.hpp"
#include "identify/sweeps/stroke_curve.hpp"
#include "identify/sweeps/stroke_moments.hpp"
#include "identify/sweeps/stroke_samples.hpp"

namespace identify {

using Eigen::Index;

namespace {

constexpr double kWhole = 1.0 / 12;  // variance of what is spread evenly over a step

/// Variance of what rounding shifts a number by over a whole stroke, in squares of steps, as all
/// here: `scatter` about its smooth curve, `uneven` from sample to sample.
double shift_of(double scatter, double uneven, double agreement, double samples) {
  // Squares of evenly spread errors, whose mean is known, scatter by 2 / sqrt(5) of it each.
  constexpr double kOfSquares = 0.894;
  constexpr double kChance = 3;  // standard deviations
  const double unseen = 1 - scatter / kWhole;
  const double chance = kChance * kOfSquares / std::sqrt(std::max(1.0, samples));
  // At one place within the step, two printed values in turn have the variance p (1 - p), and tell
  // by p where that is. Noise of more than half a step averages out.
  constexpr double kTwoValues = 0.25;
  const double alike = uneven < kTwoValues ? std::min(kWhole, kTwoValues - uneven)
                                           : kWhole * std::exp(-4 * kPi * kPi * (uneven - kWhole));
  return std::max(agreement * alike, unseen < chance ? 0 : kWhole * unseen);
}

/// How far places agree that were seen with this standard deviation, all in steps: see
/// StrokeRounding::agreement.
double agreement_of(const Eigen::ArrayXd& places, const Eigen::ArrayXd& weights, double sigma) {
  // What rounding adds is a saw tooth of the place within a step, sum_m sin(2 pi m x) / (pi m) but
  // for signs. The mean over the samples leaves each wave as far as their places agree.
  constexpr int kWaves = 4;
  const Eigen::ArrayXcd wave =
      (std::complex<double>(0, 2 * kPi) * (places - places(0)).cast<std::complex<double>>()).exp();
  Eigen::ArrayXcd waves = wave;
  double squares = 0, all = 0;
  for (int m = 1; m <= kWaves; ++m, waves *= wave) {
    // Noise of the places hides how far they agree.
    const double hidden = std::exp(-2 * std::pow(kPi * m * sigma, 2));
    const double agree = std::abs((waves * weights).sum()) / weights.sum();
    squares += std::pow(std::min(1.0, agree / hidden) / m, 2);
    all += 1.0 / (m * m);
  }
  return squares / all;
}

}  // namespace

double StrokeRounding::told_shift(double step_rad) const {
  if (!(step_rad > 0) || !told) return 0;
  const double squared = step_rad * step_rad;
  return squared *
         shift_of(told->scatter / squared, told->uneven / squared, told->agreement, samples);
}

StrokeRounding::Shifts StrokeRounding::shifts(double step_mm, double step_rad) const {
  // Of a saw tooth as long as the stroke, with any phase: the variance of its first Chebyshev
  // coefficient, in that of the tooth.
  constexpr double kGrowth = 0.6;
  Shifts variances;
  for (Index k = 0; k < extent.size(); ++k) {
    const double step = k < 3 ? step_mm : step_rad;
    if (!(step > 0)) continue;
    const double whole = kWhole * step * step;
    // Where it turns back, a coordinate that passes n steps stays within one for 1 / sqrt(n) of the
    // samples. Noise of variance s^2 leaves of the saw tooth's first wave exp(-2 (pi s / step)^2).
    const double noise = std::max(0.0, scatter(k) - whole) / (step * step);
    const double turning = std::exp(-2 * kPi * kPi * noise) / (1 + extent(k) / step);
    const double unseen = k < 3 ? 0
                                : shift_of(scatter(k) / (step * step), uneven(k) / (step * step),
                                           agreement(k), samples) /
                                      kWhole;
    variances.level(k) = whole * std::max(turning, unseen);
    variances.growth(k) =
        whole * std::max(turning * (1 - turning) / 3, kGrowth * (unseen - turning));
  }
  return variances;
}

double unevenness(const Eigen::ArrayXd& numbers) {
  // Of an even motion second differences are those of the noise, whose variance they have six
  // times. A tenth of them, as on ramps, does not count: less than 0.9 of normal ones' squares have
  // 0.623 of their mean.
  constexpr double kCounts = 0.9, kOfNormal = 0.623;
  std::vector<double> squares;
  for (Index i = 2; i < numbers.size(); ++i)
    squares.push_back(std::pow(numbers(i) - 2 * numbers(i - 1) + numbers(i - 2), 2));
  if (squares.empty()) return 0;
  const auto end =
      squares.begin() + static_cast<std::ptrdiff_t>(kCounts * static_cast<double>(squares.size()));
  std::nth_element(squares.begin(), end, squares.end());
  const auto count = static_cast<double>(std::max<std::ptrdiff_t>(1, end - squares.begin()));
  return std::accumulate(squares.begin(), end, 0.0) / count / (6 * kOfNormal);
}

StrokeRounding rounding_of(const StrokeSamples& seen, const StrokeContent& content,
                           const StrokeCurve& curve, double turn_sigma_rad) {
  StrokeRounding rounding;
  const Index count = seen.positions_mm.cols();
  if (count == 0) return rounding;
  const auto extent = [](const SampleRows& rows) -> Eigen::Array3d {
    return rows.rowwise().maxCoeff() - rows.rowwise().minCoeff();
  };
  rounding.extent.head<3>() = extent(seen.positions_mm);
  rounding.samples = seen.weights.sum();
  if (!content.orientation) return rounding;
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
  rounding.extent.tail<3>() = extent(angles);
  const double free = std::max(1.0, rounding.samples - static_cast<double>(curve.orders()));
  const SampleRows left = curve.left(angles);
  rounding.scatter.tail<3>() =
      (left.square().rowwise() * seen.weights.transpose()).rowwise().sum() / free;
  const double turned_rad = seen.turns.maxCoeff() - seen.turns.minCoeff();
  const double step = content.angle_step_rad;
  for (Index k = 0; k < 3 && step > 0; ++k) {
    rounding.uneven(3 + k) = unevenness(angles.row(k).transpose());
    // Noise of the turn moves the places along their curve.
    const double noise_rad =
        turned_rad > 0 ? rounding.extent(3 + k) * turn_sigma_rad / turned_rad : 0;
    rounding.agreement(3 + k) = agreement_of((angles.row(k) - left.row(k)).transpose() / step,
                                             seen.weights, noise_rad / step);
  }
  return rounding;
}

StrokeRounding::Told told_rounding(const StrokeSamples& seen, const Eigen::ArrayXd& along_rad,
                                   double across_rad2, double turn_sigma_rad, double step_rad) {
  const double along_rad2 =
      (along_rad.square() * seen.weights).sum() / std::max(1.0, seen.weights.sum());
  return {std::max(0.0, along_rad2 - across_rad2), unevenness(seen.told),
          agreement_of(seen.turns / step_rad, seen.weights, turn_sigma_rad / step_rad)};
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
