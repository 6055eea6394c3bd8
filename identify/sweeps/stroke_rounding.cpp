#include "identify/sweeps/stroke_rounding.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/sweeps/even_motion.hpp"
#include "identify/sweeps/stroke_curve.hpp"
#include "identify/sweeps/stroke_moments.hpp"
#include "identify/sweeps/stroke_samples.hpp"

namespace identify {

using Eigen::Index;

namespace {

constexpr double kWhole = 1.0 / 12;  // variance of what is spread evenly over a step
/// Of so many steps those where an arc turns back count, and their places are not looked at.
constexpr double kManySteps = 100;
constexpr double kOnAStep = 4;  // samples, and more, of a coordinate that goes slowly
/// Where a coordinate stays to the last digit, it most likely does not move at all, as along an
/// axis that lies along the frame's. This share of what may be hidden counts: of arms whose axes
/// lie 0.05 degrees beside those, 93 to 95 % of the numbers are then inside their 95 % intervals
/// (KR 5, 30 degrees, one decimal). Arms whose axes lie along them pay for it: with two decimals a
/// is off by 10 um and theta by 8 arcsec, by a tenth of it 9 um and 4 arcsec.
constexpr double kMayMove = 0.3;

/// Shares of all rounding's variance, of numbers within a step; all in squares of steps.
/// By how little numbers scatter about their smooth curve, 0 to 1.
double within_a_step(double scatter, double samples) {
  // Squares of evenly spread errors, whose mean is known, scatter by 2 / sqrt(5) of it each.
  constexpr double kOfSquares = 0.894;
  constexpr double kChance = 3;  // standard deviations
  const double unseen = 1 - scatter / kWhole;
  const double chance = kChance * kOfSquares / std::sqrt(std::max(1.0, samples));
  return unseen < chance ? 0 : unseen;
}

/// What numbers at places that agree are all off by, by how they scatter from one to the next.
double same_place(double uneven) {
  // An even motion goes on by a number of steps or by one more: at most a sixth. At one place
  // within the step, two printed values in turn have the variance p (1 - p), and tell by p where
  // that is. Noise of more than half a step averages out.
  constexpr double kTwoValues = 0.25;
  return uneven < kTwoValues ? std::min(1.0, (kTwoValues - uneven) / kWhole)
                             : std::exp(-4 * kPi * kPi * (uneven - kWhole));
}

using Agreement = std::array<double, StrokeRounding::kOrders>;

/// Of a saw tooth as long as the stroke, with any phase: the variances of its Legendre
/// coefficients, in that of the tooth, (2n+1)^2 j_n(pi)^2 / 2 pi^2 and so on. What moves within a
/// step shows no more of it.
constexpr Agreement kOfOneTooth{1, 0.6, 1.4};

/// How far places agree that were seen on an even motion with this standard deviation, all in
/// steps: see StrokeRounding::agreement. `ahead`: from minus one to one along the stroke.
Agreement agreement_of(const EvenMotion& motion, const Eigen::ArrayXd& seen_places,
                       const Eigen::ArrayXd& ahead, const Eigen::ArrayXd& weights,
                       double seen_sigma) {
  // What rounding adds is a saw tooth of the place within a step, sum_m sin(2 pi m x) / (pi m) but
  // for signs. What it leaves of each wave in a Legendre polynomial is that of the samples' places.
  constexpr int kWaves = 4;
  // Numbers that go on by four fifths of a step, as at 20 degrees/s, 4 ms and one decimal, take up
  // five places in turn: what they are all off by is the fifth wave, and those of its multiples.
  constexpr int kWavesOfLevel = 30;
  constexpr double kFarFromChance = 4;  // standard deviations
  const Eigen::ArrayXd places = motion(seen_places);
  const double sigma = motion.noise() * seen_sigma;
  const Eigen::ArrayXcd wave =
      (std::complex<double>(0, 2 * kPi) * (places - places(0)).cast<std::complex<double>>()).exp();
  const Eigen::ArrayXd shares = weights / weights.sum();
  const Eigen::ArrayXd grown = 3 * shares * ahead;
  const Eigen::ArrayXd bent = 5 * shares * (1.5 * ahead.square() - 0.5);
  Eigen::ArrayXcd waves = wave;
  Agreement squares{};
  double all = 0;
  for (int m = 1; m <= kWaves; ++m, waves *= wave) {
    // Noise of the places hides how far they agree.
    const double hidden = std::exp(-2 * std::pow(kPi * m * sigma, 2));
    const double level = std::min(1.0, std::abs((waves * shares).sum()) / hidden);
    squares[0] += std::pow(level / m, 2);
    squares[1] += std::pow(std::abs((waves * grown).sum()) / m, 2);
    squares[2] += std::pow(std::abs((waves * bent).sum()) / m, 2);
    all += 1.0 / (m * m);
  }
  const double chance = kFarFromChance * std::sqrt(shares.square().sum());
  for (int m = kWaves + 1; m <= kWavesOfLevel; ++m, waves *= wave) {
    const double seen = std::abs((waves * shares).sum());
    if (!(seen > chance)) continue;
    squares[0] += std::pow(std::min(1.0, seen * std::exp(2 * std::pow(kPi * m * sigma, 2))) / m, 2);
    all += 1.0 / (m * m);
  }
  for (double& square : squares) square /= all;
  return squares;
}

/// From minus one at the stroke's least turn to one at its greatest.
Eigen::ArrayXd along(const Eigen::ArrayXd& turns) {
  const double least = turns.minCoeff(), turned = turns.maxCoeff() - least;
  return turned > 0 ? (2 * (turns - least) / turned - 1).eval() : 0 * turns;
}

Eigen::ArrayXd times_of(const StrokeSamples& seen) {
  Eigen::ArrayXd times(static_cast<Index>(seen.samples.size()));
  for (Index i = 0; i < times.size(); ++i)
    times(i) = seen.samples[static_cast<std::size_t>(i)]->time_s;
  return times;
}

/// A, B and C since the first sample, on beyond half a turn.
template <class Rows>
void set_angles(Rows&& angles, const StrokeSamples& seen) {
  angles.col(0).setZero();
  for (Index i = 1; i < angles.cols(); ++i) {
    const auto& before = seen.samples[static_cast<std::size_t>(i - 1)]->abc_rad;
    const auto& here = seen.samples[static_cast<std::size_t>(i)]->abc_rad;
    for (Index k = 0; k < 3; ++k) {
      const auto at = static_cast<std::size_t>(k);
      angles(k, i) = angles(k, i - 1) + short_way(here[at] - before[at]);
    }
  }
}

}  // namespace

std::array<double, StrokeRounding::kOrders> StrokeRounding::told_shifts(double step_rad) const {
  std::array<double, kOrders> variances{};
  if (!(step_rad > 0) || !told) return variances;
  const double squared = step_rad * step_rad;
  const double same = same_place(told->uneven / squared);
  const double within = within_a_step(told->scatter / squared, samples);
  for (std::size_t order = 0; order < kOrders; ++order) {
    const double tooth = kOfOneTooth[order] * within;
    // Where it goes on by whole steps, all that it is off by is its level.
    const double slow = order == 0 ? tooth : std::min(tooth, told->agreement[order]);
    variances[order] = squared * kWhole * std::max(slow, same * told->agreement[order]);
  }
  return variances;
}

std::array<StrokeRounding::Coordinates, StrokeRounding::kOrders> StrokeRounding::shifts(
    double step_mm, double step_rad) const {
  std::array<Coordinates, kOrders> variances = {Coordinates::Zero(), Coordinates::Zero(),
                                                Coordinates::Zero()};
  for (Index k = 0; k < extent.size(); ++k) {
    const double step = k < 3 ? step_mm : step_rad;
    if (!(step > 0)) continue;
    const double squared = step * step;
    // Where it turns back, a coordinate that passes n steps stays within one for 1 / sqrt(n) of the
    // samples. Noise of variance s^2 leaves of the saw tooth's first wave exp(-2 (pi s / step)^2).
    const double noise = std::max(0.0, scatter(k) / squared - kWhole);
    const double fades = std::exp(-2 * kPi * kPi * noise);
    const double steps = extent(k) / step;
    const double turning = fades / (1 + steps);
    // Where many samples lie on each step, their curve shows the places within it, the better the
    // more steps it passes.
    const bool slow = kOnAStep * steps < samples;
    const double hidden = !followed(k) ? 0 : slow ? std::min(1.0, 2 / (steps * steps)) : 1;
    const double within = hidden * within_a_step(scatter(k) / squared, samples);
    const double same = followed(k) ? same_place(uneven(k) / squared) : 0;
    for (std::size_t order = 0; order < kOrders; ++order) {
      // Of an even way of n steps, with any phase and n: 3 (2l+1)^2 / pi^4 n^2.
      const double legendre = 2 * static_cast<double>(order) + 1;
      const double even = 3 * std::pow(legendre / (kPi * kPi * steps), 2);
      const double least = order == 0    ? turning
                           : followed(k) ? fades * std::min(kOfOneTooth[order], even)
                           : order == 1  ? turning * (1 - turning) / 3
                                         : 0;
      // What goes on by whole steps, nearly, is bent as its places say.
      const double tooth = order < 2 || slow ? kOfOneTooth[order] * within : 0;
      const double moves = order > 0 && steps == 0 ? kMayMove : 1;
      variances[order](k) =
          kWhole * squared * std::max({moves * least, moves * tooth, same * agreement[order](k)});
    }
  }
  return variances;
}

StrokeRounding rounding_of(const StrokeSamples& seen, const StrokeContent& content,
                           const StrokeCurve& curve, double across_mm2, double turn_sigma_rad) {
  StrokeRounding rounding;
  const Index count = seen.positions_mm.cols();
  if (count == 0) return rounding;
  SampleRows numbers(content.orientation ? 6 : 3, count);
  numbers.topRows(3) = seen.positions_mm;
  if (content.orientation) set_angles(numbers.bottomRows(3), seen);
  for (Index k = 0; k < numbers.rows(); ++k)
    rounding.extent(k) = numbers.row(k).maxCoeff() - numbers.row(k).minCoeff();
  rounding.scatter.head<3>() = across_mm2;
  rounding.samples = seen.weights.sum();
  const double free = std::max(1.0, rounding.samples - static_cast<double>(curve.orders()));
  const double turned = seen.turns.maxCoeff() - seen.turns.minCoeff();
  const Eigen::ArrayXd ahead = along(seen.turns);
  const EvenMotion motion(times_of(seen));
  for (Index k = 0; k < numbers.rows(); ++k) {
    const double step = k < 3 ? content.printed.position_mm : content.printed.angle_rad;
    rounding.followed(k) = k >= 3 || (step > 0 && rounding.extent(k) < kManySteps * step);
    if (!rounding.followed(k)) continue;
    const SampleRows left = curve.left(numbers.row(k));
    rounding.scatter(k) = (left.row(0).square() * seen.weights.transpose()).sum() / free;
    if (!(step > 0)) continue;
    rounding.uneven(k) = unevenness(numbers.row(k).transpose());
    // Noise of the turn moves the places along their curve.
    const double noise = turned > 0 ? rounding.extent(k) * turn_sigma_rad / turned : 0;
    const Agreement agreement =
        agreement_of(motion, (numbers.row(k) - left.row(0)).transpose() / step, ahead, seen.weights,
                     noise / step);
    for (std::size_t order = 0; order < agreement.size(); ++order)
      rounding.agreement[order](k) = agreement[order];
  }
  return rounding;
}

StrokeRounding::Told told_rounding(const StrokeSamples& seen, const Eigen::ArrayXd& along_rad,
                                   double across_rad2, double turn_sigma_rad, double step_rad) {
  const double along_rad2 =
      (along_rad.square() * seen.weights).sum() / std::max(1.0, seen.weights.sum());
  return {std::max(0.0, along_rad2 - across_rad2), unevenness(seen.told),
          agreement_of(EvenMotion(times_of(seen)), seen.turns / step_rad, along(seen.turns),
                       seen.weights, turn_sigma_rad / step_rad)};
}

double told_level_rad(const Eigen::ArrayXd& times_s, const Eigen::ArrayXd& told_rad,
                      const Eigen::ArrayXd& seen_rad, double seen_sigma_rad, double step_rad) {
  if (!(step_rad > 0)) return 0;
  const Agreement agreement =
      agreement_of(EvenMotion(times_s), seen_rad / step_rad, along(seen_rad),
                   Eigen::ArrayXd::Ones(seen_rad.size()), seen_sigma_rad / step_rad);
  const double same = same_place(unevenness(told_rad) / (step_rad * step_rad));
  return step_rad * std::sqrt(kWhole * same * agreement[0]);
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
