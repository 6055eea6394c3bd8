#include "identify/chain/angle_trust.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/LU>

#include "identify/chain/chain_effects.hpp"
#include "identify/chain/chain_nodes.hpp"
#include "identify/chain/error_curve.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/sweeps/stroke_rounding.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// The variance along smooth curves may be this many times that of white noise: by chance it is so
/// once in 10^8 times (chi squared with six degrees of freedom, over six).
constexpr double kMostCoherence = 8;
/// An even motion printed with few decimals is off by a saw tooth, which is smooth where its teeth
/// are long: as large a pattern as all rounding, and a little for chance.
constexpr double kPrinted = 1.2;
/// Home was printed, too, and is off by up to half a step: so many standard deviations of rounding.
constexpr double kPrintedHome = 0.5 / kEvenlySpread;

/// Variance along `terms` curves in that of what is left.
double coherence(double explained, Index terms, double left, double samples) {
  const double free = samples - static_cast<double>(terms);
  if (terms == 0 || free <= 0 || left <= 0) return 0;
  return (explained / static_cast<double>(terms)) / (left / free);
}

/// How many successive samples of the joint's strokes are worth one.
double correlation_of(const ChainNodes& nodes, std::size_t joint) {
  for (const StrokeMoments& stroke : nodes.strokes)
    if (stroke.content.joint == joint) return stroke.correlation;
  return 1;
}

double rms(double squares, double weights) {
  return weights > 0 ? std::sqrt(std::max(0.0, squares) / weights) : 0;
}

/// A node of a stroke whose angles follow the arc, and how far the mean angle of its samples, as
/// told, is from where the target was seen.
struct SeenNode {
  std::size_t stroke = 0;
  double place = 0;  ///< from minus one at the stroke's least turn to one
  const ChainObservation& seen;
  const NodeScatter<3>& scatter;
  const ChainPose& pose;
  Eigen::Matrix3d weight;  ///< of a sample's position
  double mean = 0;
  double within = 0;  ///< sum of squares about the mean
  double sigma = 0;   ///< that the noise alone gives one sample
};

/// Calls `see` with one node after the other.
template <class See>
void visit(const Chain& chain, const ChainNodes& nodes, const ChainNoise& noise, const See& see) {
  ChainPose pose(chain);
  visit_nodes<3>(chain, nodes, noise, [&](std::size_t s, const auto& scatter) {
    const StrokeMoments& stroke = nodes.strokes[s];
    if (!stroke.told) return;
    for (std::size_t n = 0; n < scatter.size(); ++n) {
      const ChainObservation& seen = nodes.observations[nodes.first[s] + n];
      pose.set(seen.target, turns_of(chain, seen, noise), false);
      const auto& at = scatter[n].residual;
      const Eigen::Matrix3d weight = ChainResidual<3>::base_weight(chain, seen, noise, pose);
      const Eigen::Vector3d along = weight * at.by_swept;
      const double information = along.dot(at.by_swept);
      if (!(information > 0)) continue;
      see(SeenNode{s, stroke.place_of(stroke.nodes[n].turn_rad), seen, scatter[n], pose, weight,
                   at.toward, along.dot(scatter[n].within * along) / information / information,
                   at.toward_sigma});
    }
  });
}

/// Of each joint's strokes, those seen at once together, with effects of their own.
class Curves {
 public:
  Curves(const ChainNodes& nodes, const ChainEffects& effects)
      : nodes_(nodes),
        effects_(effects),
        columns_(own_ones(effects), nodes),
        unit_(nodes.strokes.size()) {
    columns_.wander = 0;  // what strokes have in common is not asked for
    variances_ = variances_of(effects, nodes, columns_).own;
    for (std::size_t u = 0; u < nodes.units.size(); ++u)
      for (const std::size_t s : nodes.units[u]) unit_[s] = u;
    // At another home all of its strokes are off alike, which no curve of the joint's is.
    const auto turns = static_cast<Index>(nodes.known.size());
    for (std::size_t u = 0; u < nodes.units.size() && columns_.own > 0; ++u)
      if (nodes.home_of[nodes.group[u]] > 0)
        for (Index k = 0; k < turns; ++k)
          if (static_cast<std::size_t>(k) != nodes.strokes[nodes.units[u].front()].content.joint)
            variances_(k, static_cast<Index>(u)) += effects.offset_rad * effects.offset_rad;
    units_.assign(nodes.units.size(), ErrorCurve::Stroke(columns_.own));
    errors_.assign(nodes.known.size(), 0.0);
  }

  /// Of the angle alone.
  void add(const SeenNode& at, double error_rad, double weight) {
    of(at).add(at.seen.turns[at.seen.joint], at.seen.falling, at.seen.weight, error_rad, at.within,
               weight);
  }
  /// With what was seen across the motion, where strokes have effects of their own: it tells where
  /// the locked joints stood. What the effects make of the angle's error is what is returned, as a
  /// variance.
  double add_with_effects(const SeenNode& at, double error_rad, double quantum_rad) {
    const double correlation = nodes_.strokes[at.stroke].correlation;
    if (columns_.own == 0) {
      errors_[at.seen.joint] += at.seen.weight;
      add(at, error_rad, 1 / ((at.sigma * at.sigma + quantum_rad * quantum_rad) * correlation));
      return 0;
    }
    const Vector3d& by_turn = at.scatter.residual.by_swept;
    const Vector3d told = at.scatter.residual.error - (error_rad + at.mean) * by_turn;
    // An arc's figure is the same wherever the locked joints stood: no samples average it out.
    const Vector3d along = by_turn.normalized();
    const double figure_mm = effects_.figure_mm() * effects_.figure_times_of(at.seen.joint);
    const double across = figure_mm * figure_mm * nodes_.strokes[at.stroke].weight / correlation;
    const Eigen::Matrix3d noise =
        at.weight.inverse() + quantum_rad * quantum_rad * by_turn * by_turn.transpose();
    const Eigen::Matrix3d weight =
        (noise + across * (Eigen::Matrix3d::Identity() - along * along.transpose())).inverse();
    errors_[at.seen.joint] += at.seen.weight * (weight * noise).trace();
    const Eigen::MatrixXd by_effects = own_effects<3>(columns_, at.pose, nodes_.known, at.seen,
                                                      at.place, nodes_.middle_mm(unit_[at.stroke]));
    of(at).add(at.seen.turns[at.seen.joint], at.seen.falling, at.seen.weight,
               {by_effects, by_turn.transpose(), -told.transpose(), at.scatter.within,
                weight / correlation});
    const Vector3d projected = at.weight * by_turn / by_turn.dot(at.weight * by_turn);
    return (by_effects * projected)
        .cwiseAbs2()
        .dot(variances_.col(static_cast<Index>(unit_[at.stroke])));
  }
  /// How many errors of the noise add_with_effects() had of a joint: up to three a sample, fewer
  /// where a figure hides those across the motion.
  [[nodiscard]] double errors_of(std::size_t joint) const { return errors_[joint]; }

  /// By how much a joint's strokes are off otherwise, as a variance; one a joint. Nothing where no
  /// two strokes go the same way.
  using Levels = std::vector<std::optional<double>>;

  /// One a joint. `levels`: one a joint, or none; see ErrorCurve::add().
  [[nodiscard]] std::vector<ErrorCurve> sums(std::size_t joints, const Levels& levels = {}) const {
    std::vector<ErrorCurve> curves(joints);
    for (std::size_t u = 0; u < units_.size(); ++u) {
      const std::size_t joint = joint_of(u);
      curves[joint].add(units_[u], variances_.col(static_cast<Index>(u)),
                        levels.empty() ? 0 : levels[joint].value_or(0));
    }
    return curves;
  }

  /// Those of which strokes of one direction differ by more than their noise and effects tell
  /// (DerSimonian & Laird, Controlled Clinical Trials 7, 1986). `curves`: the sums without them.
  [[nodiscard]] Levels levels(const std::vector<ErrorCurve>& curves) const {
    Levels found;
    for (std::size_t j = 0; j < curves.size(); ++j) {
      const auto smooth = curves[j].fit(ErrorCurve::kSmooth);
      const double scale = noise_scale(curves[j], smooth, j);
      double beyond = 0, share = 0;
      for (const bool falls : {false, true}) {
        double weights = 0, squared = 0, sum = 0, squares = 0, strokes = 0;
        for (std::size_t u = 0; u < units_.size(); ++u) {
          if (joint_of(u) != j) continue;
          const auto seen =
              ErrorCurve::level_of(units_[u], variances_.col(static_cast<Index>(u)), smooth);
          if (seen.falls != falls || !(seen.weight > 0)) continue;
          weights += seen.weight;
          squared += seen.weight * seen.weight;
          sum += seen.weight * seen.error_rad;
          squares += seen.weight * seen.error_rad * seen.error_rad;
          ++strokes;
        }
        if (strokes < 2 || !(scale > 0)) continue;
        beyond += (squares - sum * sum / weights) / scale - (strokes - 1);
        share += weights - squared / weights;
      }
      found.push_back(share > 0 ? std::optional(std::max(0.0, beyond / share)) : std::nullopt);
    }
    return found;
  }
  /// Variance of what a fit leaves of a joint's errors, in that of the noise that they have.
  [[nodiscard]] double noise_scale(const ErrorCurve& curve, const ErrorCurve::Fit& fit,
                                   std::size_t joint) const {
    const double samples = errors_of(joint) / correlation_of(nodes_, joint);
    return std::max(0.0, curve.squares() - fit.explained) /
           std::max(1.0, samples - static_cast<double>(fit.terms));
  }

 private:
  static ChainEffects own_ones(ChainEffects effects) {
    effects.home_rad += effects.offset_rad;
    effects.figures_mm = {};
    effects.told_rad = effects.offset_rad = effects.late_s = 0;
    effects.home_lasts = HomeLasts::stroke;
    return effects;
  }
  ErrorCurve::Stroke& of(const SeenNode& at) { return units_[unit_[at.stroke]]; }
  [[nodiscard]] std::size_t joint_of(std::size_t unit) const {
    return nodes_.strokes[nodes_.units[unit].front()].content.joint;
  }

  const ChainNodes& nodes_;
  ChainEffects effects_;
  EffectColumns columns_;
  std::vector<std::size_t> unit_;  ///< of each stroke
  Eigen::MatrixXd variances_;      ///< of each unit's own effects, a unit a column
  std::vector<ErrorCurve::Stroke> units_;
  std::vector<double> errors_;  ///< one a joint
};

}  // namespace

double AngleEvidence::curve_at(double turn) const {
  const ErrorCurve::Row row = ErrorCurve::regressors(turn, false);
  double sum = 0;
  for (std::size_t k = 0; k < curve.size(); ++k) sum += curve[k] * row(static_cast<Index>(k));
  return sum;
}

std::vector<AngleEvidence> seen_angle_errors(const Chain& chain, const ChainNodes& nodes,
                                             const ChainNoise& noise, const ChainNoise& quantum,
                                             const ChainEffects& effects) {
  const std::size_t joints = chain.axes.size();
  std::vector<AngleEvidence> evidence(joints);
  std::vector<double> expected(joints, 0.0);
  std::vector<bool> astray(joints, false), swept(joints, false);
  for (const StrokeMoments& stroke : nodes.strokes) {
    swept[stroke.content.joint] = true;
    if (!stroke.squares) continue;
    if (stroke.told)
      evidence[stroke.content.joint].samples += stroke.samples;
    else
      astray[stroke.content.joint] = stroke.content.joints > 0;
  }
  Curves plain(nodes, {}), weighed(nodes, effects);
  visit(chain, nodes, noise, [&](const SeenNode& at) {
    const std::size_t joint = at.seen.joint;
    const double error =
        std::remainder(at.seen.measured_turn - at.seen.turns[joint] - at.mean, 2 * kPi);
    const double quantum_rad = quantum.swept_rad[joint];
    plain.add(at, error, 1);
    expected[joint] += at.seen.weight * (at.sigma * at.sigma + quantum_rad * quantum_rad +
                                         weighed.add_with_effects(at, error, quantum_rad));
  });
  const auto plain_sums = plain.sums(joints);
  const auto levels = weighed.levels(weighed.sums(joints));
  const auto weighed_sums = weighed.sums(joints, levels);
  for (std::size_t j = 0; j < joints; ++j) {
    AngleEvidence& found = evidence[j];
    if (found.samples == 0) {
      found.reason = astray[j]  ? "the angles do not follow the arc"
                     : swept[j] ? "no angles"
                                : "not swept";
      continue;
    }
    const ErrorCurve& errors = plain_sums[j];
    found.error_rms_rad = rms(errors.squares(), errors.samples());
    found.remainder_rms_rad =
        rms(errors.squares() - errors.fit(ErrorCurve::kSmooth).explained, errors.samples());
    found.expected_rms_rad = rms(expected[j], errors.samples());
    const ErrorCurve& against = weighed_sums[j];
    const double samples = weighed.errors_of(j) / correlation_of(nodes, j);
    const auto smooth = against.fit(ErrorCurve::kSmooth);
    const auto wiggly = against.fit(ErrorCurve::kSmooth + ErrorCurve::kHigher);
    const double left = std::max(0.0, against.squares() - smooth.explained);
    found.coherence = coherence(smooth.explained, smooth.terms, left, samples);
    found.remainder_coherence =
        coherence(wiggly.explained - smooth.explained, wiggly.terms - smooth.terms,
                  against.squares() - wiggly.explained, samples);
    for (std::size_t k = 0; k < found.curve.size(); ++k)
      found.curve[k] = smooth.coefficients(static_cast<Index>(k));
    if (against.both_ways()) {
      const double more = weighed.noise_scale(against, smooth, j);
      found.backlash_rad = smooth.coefficients(ErrorCurve::kBacklash);
      found.backlash_repeats = levels[j].has_value();
      found.backlash_sigma_rad = std::sqrt(more * smooth.variances(ErrorCurve::kBacklash));
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
  Curves curves(nodes, {});
  // How far each residual is off in what the print quanta would make it scatter.
  ChainNoise printed = quantum;
  for (std::size_t j = 0; j < evidence.size(); ++j)
    if (std::isinf(noise.swept_rad[j])) printed.swept_rad[j] = noise.swept_rad[j];
  visit(chain, nodes, printed, [&](const SeenNode& at) {
    if (std::isfinite(noise.swept_rad[at.seen.joint]))
      curves.add(at, at.mean, 1 / (at.sigma * at.sigma));
  });
  const auto sums = curves.sums(evidence.size());
  for (std::size_t j = 0; j < evidence.size(); ++j) {
    if (std::isinf(noise.swept_rad[j])) continue;
    const ErrorCurve& errors = sums[j];
    const auto smooth = errors.fit(ErrorCurve::kSmooth);
    evidence[j].size = rms(errors.squares(), errors.samples());
    const double level = errors.fit(1).explained;
    const bool rounded = rms(level, errors.samples()) <= kPrintedHome &&
                         rms(smooth.explained - level, errors.samples()) <= kPrinted;
    evidence[j].coherence = rounded
                                ? 0
                                : coherence(smooth.explained, smooth.terms,
                                            errors.squares() - smooth.explained, errors.samples());
  }
}

bool stands_test(const AngleEvidence& evidence) {
  return evidence.size <= kMostQuanta && evidence.coherence <= kMostCoherence;
}

}  // namespace identify
