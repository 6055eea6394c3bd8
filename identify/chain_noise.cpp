#include "identify/chain_noise.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Position, orientation, locked angles, and the angle of each joint.
constexpr int kMostComponents = 3 + static_cast<int>(kMostJoints);
using Components = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostComponents, 1>;
using Products =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostComponents, kMostComponents>;
enum : Index { kPosition, kOrientation, kLocked, kSwept };

/// Calls `see` with each sample's index, residual and pose.
template <int Size, class See>
void visit(const Chain& chain, const std::vector<ChainObservation>& samples,
           const ChainNoise& noise, const See& see) {
  ChainPose pose(chain);
  ChainResidual<Size> residual;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    pose.set(samples[i].target, samples[i].turns, false);
    residual.set(chain, samples[i], pose, noise);
    see(i, residual, pose);
  }
}

/// Of the samples, by their weights.
template <int Size>
double row_count(const std::vector<ChainObservation>& samples, const ChainNoise& noise) {
  double rows = 0;
  for (const ChainObservation& sample : samples)
    rows += sample.weight * (std::isfinite(noise.swept_rad[sample.joint]) ? Size : Size - 1);
  return rows;
}

template <int Size>
double parameter_count(const Chain& chain) {
  return static_cast<double>(
      ChainParameters{chain.axes.size(), chain.targets_mm.size()}.count(Size == 6));
}

/// Variances beside that of the position have to pass their floor by so many standard deviations:
/// else they would only weigh samples by chance.
constexpr double kChance = 3;

/// M v = u with v not below `floor`: what wants to fall below stays there.
Components bounded_solution(Products m, Components u, const Components& floor) {
  const Index count = u.size();
  std::vector<bool> held(static_cast<std::size_t>(count), false);
  Components v = floor;
  for (Index round = 0; round <= count; ++round) {
    std::vector<Index> open;
    for (Index c = 0; c < count; ++c)
      if (!held[static_cast<std::size_t>(c)] && m(c, c) > 0) open.push_back(c);
    const auto size = static_cast<Index>(open.size());
    if (size == 0) break;
    Products scaled(size, size);
    Components right(size);
    for (Index r = 0; r < size; ++r) {
      const Index at = open[static_cast<std::size_t>(r)];
      const double scale = std::sqrt(m(at, at));
      right(r) = u(at);
      for (Index c = 0; c < count; ++c)
        if (held[static_cast<std::size_t>(c)]) right(r) -= m(at, c) * floor(c);
      right(r) /= scale;
      for (Index c = 0; c < size; ++c) {
        const Index other = open[static_cast<std::size_t>(c)];
        scaled(r, c) = m(at, other) / (scale * std::sqrt(m(other, other)));
      }
      scaled(r, r) += 1e-9;  // components that cannot be told apart share
    }
    const Eigen::LDLT<Products> solver(scaled);
    const Components found = solver.solve(right);
    const Products inverse = solver.solve(Products::Identity(size, size));
    Index worst = -1;
    double least = 0;
    for (Index r = 0; r < size; ++r) {
      const Index at = open[static_cast<std::size_t>(r)];
      v(at) = found(r) / std::sqrt(m(at, at));
      // Estimates of variances scatter by 2 M^-1.
      const double above = (v(at) - floor(at)) * std::sqrt(m(at, at) / (2 * inverse(r, r)));
      const double margin = above - (at == kPosition ? 0 : kChance);
      if (margin < least) {
        least = margin;
        worst = at;
      }
    }
    if (worst < 0) break;
    held[static_cast<std::size_t>(worst)] = true;
    v(worst) = floor(worst);
  }
  return v.cwiseMax(floor);
}

template <int Size>
ChainNoise estimate(const Chain& chain, const std::vector<ChainObservation>& samples,
                    const ChainNoise& noise, const ChainNoise& lowest) {
  using Square = typename ChainResidual<Size>::Square;
  const auto count = kSwept + static_cast<Index>(chain.axes.size());
  Products m = Products::Zero(count, count);
  Components u = Components::Zero(count);
  visit<Size>(chain, samples, noise,
              [&](std::size_t i, const ChainResidual<Size>& at, const ChainPose& pose) {
                const ChainObservation& sample = samples[i];
                if (sample.weight == 0) return;
                const bool angle_used = std::isfinite(noise.swept_rad[sample.joint]);
                // W B of each component that this sample speaks of.
                std::array<std::pair<Index, Square>, 4> parts;
                for (auto& part : parts) part.second.setZero();
                std::size_t used = 0;
                const auto part = [&](Index component) -> Square& {
                  parts[used].first = component;
                  return parts[used++].second;
                };
                part(kPosition).template leftCols<3>() = at.weight.template leftCols<3>();
                if constexpr (Size == 6) {
                  part(kOrientation).template rightCols<3>() = at.weight.template rightCols<3>();
                }
                Square by_locked = Square::Zero();
                for (std::size_t k = 0; k < chain.axes.size(); ++k)
                  if (k != sample.joint)
                    by_locked.noalias() += pose.by_turn[k].template head<Size>() *
                                           pose.by_turn[k].template head<Size>().transpose();
                part(kLocked).noalias() = at.weight * by_locked;
                if (angle_used)
                  part(kSwept + static_cast<Index>(sample.joint)).noalias() =
                      (at.weight * at.by_swept) * at.by_swept.transpose();
                const auto weighted = (at.weight * at.error).eval();
                for (std::size_t a = 0; a < used; ++a) {
                  // r^T W B W r = (r^T) (W B) (W r).
                  u(parts[a].first) += sample.weight * at.error.dot(parts[a].second * weighted);
                  for (std::size_t b = 0; b <= a; ++b) {
                    const double product =
                        parts[a].second.cwiseProduct(parts[b].second.transpose()).sum();
                    m(parts[a].first, parts[b].first) += sample.weight * product;
                    if (a != b) m(parts[b].first, parts[a].first) += sample.weight * product;
                  }
                }
              });
  // The fit has taken up part of the scatter: as many rows as it has parameters.
  const double rows = row_count<Size>(samples, noise);
  u *= rows / std::max(1.0, rows - parameter_count<Size>(chain));

  Components floor = Components::Zero(count);
  const auto square = [](double value) { return value * value; };
  floor(kPosition) = square(lowest.position_mm);
  floor(kOrientation) = square(lowest.orientation_rad);
  floor(kLocked) = square(lowest.locked_rad);
  for (std::size_t j = 0; j < chain.axes.size(); ++j)
    floor(kSwept + static_cast<Index>(j)) = square(lowest.swept_rad[j]);
  const Components variances = bounded_solution(m, u, floor);
  ChainNoise found = noise;
  found.position_mm = std::sqrt(variances(kPosition));
  found.orientation_rad = std::sqrt(variances(kOrientation));
  found.locked_rad = std::sqrt(variances(kLocked));
  for (std::size_t j = 0; j < chain.axes.size(); ++j)
    if (std::isfinite(noise.swept_rad[j]))
      found.swept_rad[j] = std::sqrt(variances(kSwept + static_cast<Index>(j)));
  return found;
}

/// Of each stroke, the median squared distance in that of good samples.
template <int Size>
std::vector<double> median_squares(const Chain& chain, const std::vector<ChainObservation>& samples,
                                   const ChainNoise& noise) {
  std::vector<double> medians;
  std::vector<double> squares;
  const auto close = [&](std::size_t joint) {
    const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::nth_element(squares.begin(), middle, squares.end());
    // The median of chi squared is close to k (1 - 2 / 9k)^3.
    const double k = std::isfinite(noise.swept_rad[joint]) ? Size : Size - 1;
    medians.push_back(*middle / (k * std::pow(1 - 2 / (9 * k), 3)));
    squares.clear();
  };
  visit<Size>(chain, samples, noise,
              [&](std::size_t i, const ChainResidual<Size>& at, const ChainPose&) {
                if (i > 0 && samples[i].sweep != samples[i - 1].sweep) close(samples[i - 1].joint);
                squares.push_back(at.squared());
              });
  if (!squares.empty()) close(samples.back().joint);
  return medians;
}

template <int Size>
void set_weights(const Chain& chain, std::vector<ChainObservation>& samples,
                 const ChainNoise& noise) {
  // Half of a stroke's samples are good, whatever the noise is said to be: else weights and noise
  // would make each other ever smaller.
  const auto medians = median_squares<Size>(chain, samples, noise);
  std::size_t stroke = 0;
  visit<Size>(chain, samples, noise,
              [&](std::size_t i, const ChainResidual<Size>& at, const ChainPose&) {
                // The distance that a good sample hardly passes, for its number of free directions.
                const double plateau = std::sqrt(static_cast<double>(Size)) + 2.5;
                if (i > 0 && samples[i].sweep != samples[i - 1].sweep) ++stroke;
                const double unit = std::sqrt(std::max(1.0, medians[stroke]));
                const double distance = std::sqrt(at.squared()) / (unit * plateau);
                const double left = std::clamp(2 - distance, 0.0, 1.0);
                samples[i].weight = left * left;
              });
}

template <int Size>
double correlated(const Chain& chain, const std::vector<ChainObservation>& samples,
                  const ChainNoise& noise) {
  using Vector = typename ChainResidual<Size>::Vector;
  std::vector<Vector> errors(samples.size());
  std::vector<Vector> weighted(samples.size());
  visit<Size>(chain, samples, noise,
              [&](std::size_t i, const ChainResidual<Size>& at, const ChainPose&) {
                errors[i] = at.error;
                // What an unused angle could explain is no residual.
                if (std::isinf(noise.swept_rad[samples[i].joint]))
                  errors[i] -= at.by_swept * at.toward;
                errors[i] *= std::sqrt(samples[i].weight);
                weighted[i] = at.weight * errors[i];
              });
  const auto covariance = [&](std::size_t lag) {
    double sum = 0;
    for (std::size_t i = 0; i + lag < samples.size(); ++i)
      if (samples[i].sweep == samples[i + lag].sweep) sum += weighted[i].dot(errors[i + lag]);
    return sum;
  };
  const double variance = covariance(0);
  if (!(variance > 0)) return 1;
  // Each parameter takes up one direction; the correlations of what is left sum to zero over all
  // lags along it.
  constexpr double kMostTakenUp = 0.6;
  constexpr double kSigmas = 3;
  constexpr double kLeastWindow = 200;
  constexpr double kWindow = 20;
  const double rows = std::max(1.0, row_count<Size>(samples, noise));
  const double share = parameter_count<Size>(chain) / rows;
  double sum = 1;
  double longest = 1;
  std::size_t window = 1;
  for (std::size_t lag = 1; lag < samples.size() / 4; ++lag) {
    const double lags = 2 * static_cast<double>(lag) + 1;
    if (lags * share > kMostTakenUp) break;
    sum += 2 * covariance(lag) / variance;
    if (lag < window) continue;
    window *= 2;
    const double time = sum / (1 - lags * share);
    // Of white noise the sum scatters by sqrt(2 lags / rows).
    if (time > longest && time - 1 > kSigmas * std::sqrt(2 * lags / rows)) longest = time;
    if (static_cast<double>(lag) > std::max(kLeastWindow, kWindow * longest)) break;
  }
  return longest;
}

template <int Size>
double root_mean_square(const Chain& chain, const std::vector<ChainObservation>& samples,
                        const ChainNoise& noise) {
  double sum = 0;
  visit<Size>(chain, samples, noise,
              [&](std::size_t i, const ChainResidual<Size>& at, const ChainPose&) {
                sum += samples[i].weight * at.squared();
              });
  const double freedom = row_count<Size>(samples, noise) - parameter_count<Size>(chain);
  return std::sqrt(sum / std::max(1.0, freedom));
}

}  // namespace

ChainNoise estimate_noise(const Chain& chain, const std::vector<ChainObservation>& samples,
                          const ChainNoise& noise, const ChainNoise& floor, bool with_orientation) {
  return with_orientation ? estimate<6>(chain, samples, noise, floor)
                          : estimate<3>(chain, samples, noise, floor);
}

double robust_position_sigma(const Chain& chain, const std::vector<ChainObservation>& samples,
                             const ChainNoise& noise) {
  const auto medians = median_squares<3>(chain, samples, noise);
  if (medians.empty()) return noise.position_mm;
  return noise.position_mm * std::sqrt(*std::max_element(medians.begin(), medians.end()));
}

void reweight(const Chain& chain, std::vector<ChainObservation>& samples, const ChainNoise& noise,
              bool with_orientation) {
  with_orientation ? set_weights<6>(chain, samples, noise) : set_weights<3>(chain, samples, noise);
}

double misfit(const Chain& chain, const std::vector<ChainObservation>& samples,
              const ChainNoise& noise, bool with_orientation) {
  return with_orientation ? root_mean_square<6>(chain, samples, noise)
                          : root_mean_square<3>(chain, samples, noise);
}

double samples_per_independent(const Chain& chain, const std::vector<ChainObservation>& samples,
                               const ChainNoise& noise, bool with_orientation) {
  return with_orientation ? correlated<6>(chain, samples, noise)
                          : correlated<3>(chain, samples, noise);
}

}  // namespace identify
