#include "identify/chain/angle_trust.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "identify/chain/chain_nodes.hpp"
#include "identify/geometry/angle.hpp"

namespace identify {
namespace {

using Eigen::Index;

/// The variance along smooth curves may be this many times that of white noise: by chance it is so
/// once in 10^8 times (chi squared with six degrees of freedom, over six).
constexpr double kMostCoherence = 8;
/// An even motion printed with few decimals is off by a saw tooth, which is smooth where its teeth
/// are long: as large a pattern as all rounding, and a little for chance.
constexpr double kPrinted = 1.2;

constexpr Index kCurve = 6;   // offset, scale, two harmonics
constexpr Index kHigher = 8;  // harmonics three to six
constexpr Index kBacklash = 1;
using Row = Eigen::Matrix<double, kCurve + kHigher + kBacklash, 1>;

Row regressors(double turn, bool falling) {
  Row row;
  row(0) = 1;
  row(1) = turn;
  for (Index k = 1; k <= 6; ++k) {
    row(2 * k) = std::cos(static_cast<double>(k) * turn) - 1;
    row(2 * k + 1) = std::sin(static_cast<double>(k) * turn);
  }
  row(kCurve + kHigher) = falling ? 0.5 : -0.5;
  return row;
}

/// Errors over the turn, and how well smooth curves describe them.
class Curve {
 public:
  /// `within`: what the errors of these samples scatter by, beside their mean; sum of squares.
  void add(double turn, bool falling, double error, double weight, double within) {
    const Row row = regressors(turn, falling);
    normal_.noalias() += weight * row * row.transpose();
    right_ += weight * error * row;
    squares_ += weight * error * error + within;
    weights_ += weight;
    (falling ? falls_ : rises_) = true;
  }

  struct Fit {
    Row coefficients = Row::Zero();
    Row variances = Row::Zero();  ///< for errors of unit variance
    double explained = 0;         ///< sum of squares
    Index terms = 0;              ///< that could be told apart
  };
  /// By the first `count` regressors, and the backlash where there are strokes both ways.
  [[nodiscard]] Fit fit(Index count) const {
    std::vector<Index> chosen;
    for (Index k = 0; k < count; ++k) chosen.push_back(k);
    if (rises_ && falls_) chosen.push_back(kCurve + kHigher);
    // Short arcs cannot tell harmonics apart: Cholesky, one regressor after the other, without
    // those that the ones before leave nothing of.
    constexpr double kLeast = 1e-9;
    using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Row::SizeAtCompileTime,
                                 Row::SizeAtCompileTime>;
    Fit found;
    std::vector<Index> kept;
    Square root =
        Square::Zero(static_cast<Index>(chosen.size()), static_cast<Index>(chosen.size()));
    for (const Index k : chosen) {
      const auto size = static_cast<Index>(kept.size());
      for (Index i = 0; i < size; ++i) {
        double value = normal_(k, kept[static_cast<std::size_t>(i)]);
        for (Index l = 0; l < i; ++l) value -= root(size, l) * root(i, l);
        root(size, i) = value / root(i, i);
      }
      const double left = normal_(k, k) - root.row(size).head(size).squaredNorm();
      if (!(left > kLeast * normal_(k, k))) continue;
      root(size, size) = std::sqrt(left);
      kept.push_back(k);
    }
    const auto size = static_cast<Index>(kept.size());
    found.terms = size;
    Square inverse = Square::Zero(size, size);
    for (Index c = 0; c < size; ++c)
      for (Index r = c; r < size; ++r) {
        double value = r == c ? 1 : 0;
        for (Index l = c; l < r; ++l) value -= root(r, l) * inverse(l, c);
        inverse(r, c) = value / root(r, r);
      }
    for (Index i = 0; i < size; ++i) {
      double along = 0;
      for (Index c = 0; c <= i; ++c)
        along += inverse(i, c) * right_(kept[static_cast<std::size_t>(c)]);
      found.explained += along * along;
      for (Index c = 0; c <= i; ++c) {
        const Index k = kept[static_cast<std::size_t>(c)];
        found.coefficients(k) += inverse(i, c) * along;
        found.variances(k) += inverse(i, c) * inverse(i, c);
      }
    }
    return found;
  }

  [[nodiscard]] double squares() const { return squares_; }
  [[nodiscard]] double weights() const { return weights_; }
  [[nodiscard]] bool both_ways() const { return rises_ && falls_; }

 private:
  Eigen::Matrix<double, Row::SizeAtCompileTime, Row::SizeAtCompileTime> normal_ =
      decltype(normal_)::Zero();
  Row right_ = Row::Zero();
  double squares_ = 0;
  double weights_ = 0;
  bool rises_ = false;
  bool falls_ = false;
};

/// Variance along `terms` curves in that of what is left.
double coherence(double explained, Index terms, double left, double samples) {
  const double free = samples - static_cast<double>(terms);
  if (terms == 0 || free <= 0 || left <= 0) return 0;
  return (explained / static_cast<double>(terms)) / (left / free);
}

double rms(double squares, double weights) {
  return weights > 0 ? std::sqrt(std::max(0.0, squares) / weights) : 0;
}

/// Of the samples of a node: how far their mean angle, as told, is from where the target was seen,
/// and the sum of squares about that.
struct AngleError {
  double mean = 0;
  double within = 0;
  double sigma = 0;  ///< that the noise alone gives one sample
};

/// Calls `see` with the nodes of strokes whose angles follow the arc.
template <class See>
void visit(const Chain& chain, const ChainNodes& nodes, const ChainNoise& noise, const See& see) {
  ChainPose pose(chain);
  visit_nodes<3>(chain, nodes, noise, [&](std::size_t s, const auto& scatter) {
    if (!nodes.strokes[s].told) return;
    for (std::size_t n = 0; n < scatter.size(); ++n) {
      const ChainObservation& seen = nodes.observations[nodes.first[s] + n];
      pose.set(seen.target, turns_of(chain, seen, noise), false);
      const auto& at = scatter[n].residual;
      const Eigen::Vector3d along =
          ChainResidual<3>::base_weight(chain, seen, noise, pose) * at.by_swept;
      const double information = along.dot(at.by_swept);
      if (!(information > 0)) continue;
      see(seen,
          AngleError{at.toward, along.dot(scatter[n].within * along) / information / information,
                     at.toward_sigma});
    }
  });
}

}  // namespace

double AngleEvidence::curve_at(double turn) const {
  const Row row = regressors(turn, false);
  double sum = 0;
  for (std::size_t k = 0; k < curve.size(); ++k) sum += curve[k] * row(static_cast<Index>(k));
  return sum;
}

std::vector<AngleEvidence> seen_angle_errors(const Chain& chain, const ChainNodes& nodes,
                                             const ChainNoise& noise, const ChainNoise& quantum) {
  std::vector<AngleEvidence> evidence(chain.axes.size());
  std::vector<Curve> curves(chain.axes.size());
  std::vector<double> expected(chain.axes.size(), 0.0);
  std::vector<bool> astray(chain.axes.size(), false);
  for (const StrokeMoments& stroke : nodes.strokes) {
    if (!stroke.squares) continue;
    if (stroke.told)
      evidence[stroke.content.joint].samples += stroke.samples;
    else
      astray[stroke.content.joint] = stroke.content.joints > 0;
  }
  visit(chain, nodes, noise, [&](const ChainObservation& seen, const AngleError& at) {
    const double error =
        std::remainder(seen.measured_turn - seen.turns[seen.joint] - at.mean, 2 * kPi);
    curves[seen.joint].add(seen.turns[seen.joint], seen.falling, error, seen.weight, at.within);
    expected[seen.joint] += seen.weight * (at.sigma * at.sigma + quantum.swept_rad[seen.joint] *
                                                                     quantum.swept_rad[seen.joint]);
  });
  for (std::size_t j = 0; j < evidence.size(); ++j) {
    AngleEvidence& found = evidence[j];
    const Curve& errors = curves[j];
    if (found.samples == 0) {
      found.reason = astray[j] ? "the angles do not follow the arc" : "no angles";
      continue;
    }
    const auto smooth = errors.fit(kCurve);
    const auto wiggly = errors.fit(kCurve + kHigher);
    const double left = std::max(0.0, errors.squares() - smooth.explained);
    found.error_rms_rad = rms(errors.squares(), errors.weights());
    found.remainder_rms_rad = rms(left, errors.weights());
    found.expected_rms_rad = rms(expected[j], errors.weights());
    found.coherence = coherence(smooth.explained, smooth.terms, left, errors.weights());
    found.remainder_coherence =
        coherence(wiggly.explained - smooth.explained, wiggly.terms - smooth.terms,
                  errors.squares() - wiggly.explained, errors.weights());
    for (std::size_t k = 0; k < found.curve.size(); ++k)
      found.curve[k] = smooth.coefficients(static_cast<Index>(k));
    if (errors.both_ways()) {
      found.backlash_rad = smooth.coefficients(kCurve + kHigher);
      found.backlash_sigma_rad =
          found.remainder_rms_rad * std::sqrt(smooth.variances(kCurve + kHigher));
    }
    const bool described = found.remainder_coherence <= kMostCoherence &&
                           found.remainder_rms_rad <= 2 * found.expected_rms_rad;
    found.trust = described ? AngleTrust::smooth : AngleTrust::free;
    found.reason = described ? "the positions are no better than what a smooth error could hide in"
                             : "the error follows no smooth curve";
  }
  return evidence;
}

void test_believed_angles(const Chain& chain, const ChainNodes& nodes, const ChainNoise& noise,
                          const ChainNoise& quantum, std::vector<AngleEvidence>& evidence) {
  std::vector<Curve> curves(chain.axes.size());
  // How far each residual is off in what the print quanta would make it scatter.
  ChainNoise printed = quantum;
  for (std::size_t j = 0; j < evidence.size(); ++j)
    if (std::isinf(noise.swept_rad[j])) printed.swept_rad[j] = noise.swept_rad[j];
  visit(chain, nodes, printed, [&](const ChainObservation& seen, const AngleError& at) {
    if (std::isfinite(noise.swept_rad[seen.joint]))
      curves[seen.joint].add(seen.turns[seen.joint], seen.falling, at.mean / at.sigma, seen.weight,
                             at.within / (at.sigma * at.sigma));
  });
  for (std::size_t j = 0; j < evidence.size(); ++j) {
    if (std::isinf(noise.swept_rad[j])) continue;
    const Curve& errors = curves[j];
    const auto smooth = errors.fit(kCurve);
    evidence[j].size = rms(errors.squares(), errors.weights());
    evidence[j].coherence = rms(smooth.explained, errors.weights()) <= kPrinted
                                ? 0
                                : coherence(smooth.explained, smooth.terms,
                                            errors.squares() - smooth.explained, errors.weights());
  }
}

bool stands_test(const AngleEvidence& evidence) {
  return evidence.size <= kMostQuanta && evidence.coherence <= kMostCoherence;
}

}  // namespace identify
