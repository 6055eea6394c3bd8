#include "identify/chain/angle_trust.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/chain/chain_effects.hpp"
#include "identify/chain/chain_nodes.hpp"
#include "identify/chain/error_curve.hpp"
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

/// Of the samples of a node: how far their mean angle, as told, is from where the target was seen,
/// and the sum of squares about that.
struct AngleError {
  double mean = 0;
  double within = 0;
  double sigma = 0;            ///< that the noise alone gives one sample
  Eigen::VectorXd by_effects;  ///< what each effect of the stroke's own changes it by
};

/// Calls `see` with the nodes of strokes whose angles follow the arc.
template <class See>
void visit(const Chain& chain, const ChainNodes& nodes, const ChainNoise& noise, bool with_effects,
           const See& see) {
  ChainPose pose(chain);
  visit_nodes<3>(chain, nodes, noise, [&](std::size_t s, const auto& scatter) {
    const StrokeMoments& stroke = nodes.strokes[s];
    if (!stroke.told) return;
    for (std::size_t n = 0; n < scatter.size(); ++n) {
      const ChainObservation& seen = nodes.observations[nodes.first[s] + n];
      pose.set(seen.target, turns_of(chain, seen, noise), false);
      const auto& at = scatter[n].residual;
      const Eigen::Vector3d along =
          ChainResidual<3>::base_weight(chain, seen, noise, pose) * at.by_swept;
      const double information = along.dot(at.by_swept);
      if (!(information > 0)) continue;
      AngleError error{at.toward,
                       along.dot(scatter[n].within * along) / information / information,
                       at.toward_sigma,
                       {}};
      if (with_effects)
        error.by_effects = own_effects<3>(pose.by_turn, nodes.known, seen.joint,
                                          stroke.place_of(stroke.nodes[n].turn_rad)) *
                           along / information;
      see(s, seen, error);
    }
  });
}

/// Of each joint's strokes, those seen at once together, with effects of their own.
class Curves {
 public:
  Curves(const ChainNodes& nodes, const ChainEffects& effects)
      : nodes_(nodes), columns_(own_ones(effects), nodes), unit_(nodes.strokes.size()) {
    variances_ = variances_of(effects, nodes, columns_).own;
    for (std::size_t u = 0; u < nodes.units.size(); ++u)
      for (const std::size_t s : nodes.units[u]) unit_[s] = u;
    // At another home all of its strokes are off alike, which no curve of the joint's is.
    const auto turns = static_cast<Index>(nodes.known.size());
    for (std::size_t u = 0; u < variances_.size() && columns_.own > 0; ++u)
      if (nodes.home_of[nodes.group[u]] > 0)
        variances_[u].head(turns).array() += effects.offset_rad * effects.offset_rad;
    units_.assign(nodes.units.size(), ErrorCurve::Stroke(columns_.own));
  }

  [[nodiscard]] bool any_effects() const { return columns_.own > 0; }
  [[nodiscard]] ErrorCurve::Stroke& of_stroke(std::size_t s) { return units_[unit_[s]]; }
  /// Of what the stroke's own effects make of the error.
  [[nodiscard]] double variance(std::size_t s, const Eigen::VectorXd& by_effects) const {
    return by_effects.size() > 0 ? by_effects.cwiseAbs2().dot(variances_[unit_[s]]) : 0;
  }
  /// One a joint.
  [[nodiscard]] std::vector<ErrorCurve> sums(std::size_t joints) const {
    std::vector<ErrorCurve> curves(joints);
    for (std::size_t u = 0; u < units_.size(); ++u)
      curves[nodes_.strokes[nodes_.units[u].front()].content.joint].add(units_[u], variances_[u]);
    return curves;
  }

 private:
  static ChainEffects own_ones(ChainEffects effects) {
    effects.home_rad += effects.offset_rad;
    effects.figure_mm = effects.told_rad = effects.offset_rad = 0;
    return effects;
  }

  const ChainNodes& nodes_;
  EffectColumns columns_;
  std::vector<std::size_t> unit_;  ///< of each stroke
  std::vector<Eigen::VectorXd> variances_;
  std::vector<ErrorCurve::Stroke> units_;
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
  std::vector<bool> astray(joints, false);
  for (const StrokeMoments& stroke : nodes.strokes) {
    if (!stroke.squares) continue;
    if (stroke.told)
      evidence[stroke.content.joint].samples += stroke.samples;
    else
      astray[stroke.content.joint] = stroke.content.joints > 0;
  }
  Curves plain(nodes, {}), weighed(nodes, effects);
  visit(chain, nodes, noise, weighed.any_effects(),
        [&](std::size_t s, const ChainObservation& seen, const AngleError& at) {
          const double error =
              std::remainder(seen.measured_turn - seen.turns[seen.joint] - at.mean, 2 * kPi);
          const double turn = seen.turns[seen.joint];
          const double quantum_rad = quantum.swept_rad[seen.joint];
          const double variance = at.sigma * at.sigma + quantum_rad * quantum_rad;
          plain.of_stroke(s).add(turn, seen.falling, {}, error, seen.weight, at.within, 1);
          weighed.of_stroke(s).add(turn, seen.falling, at.by_effects, error, seen.weight, at.within,
                                   1 / (variance * nodes.strokes[s].correlation));
          expected[seen.joint] += seen.weight * (variance + weighed.variance(s, at.by_effects));
        });
  const auto plain_sums = plain.sums(joints), weighed_sums = weighed.sums(joints);
  for (std::size_t j = 0; j < joints; ++j) {
    AngleEvidence& found = evidence[j];
    if (found.samples == 0) {
      found.reason = astray[j] ? "the angles do not follow the arc" : "no angles";
      continue;
    }
    const ErrorCurve& errors = plain_sums[j];
    found.error_rms_rad = rms(errors.squares(), errors.samples());
    found.remainder_rms_rad =
        rms(errors.squares() - errors.fit(ErrorCurve::kSmooth).explained, errors.samples());
    found.expected_rms_rad = rms(expected[j], errors.samples());
    const ErrorCurve& against = weighed_sums[j];
    const double samples = against.samples() / correlation_of(nodes, j);
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
      const double more = left / std::max(1.0, samples - static_cast<double>(smooth.terms));
      found.backlash_rad = smooth.coefficients(ErrorCurve::kBacklash);
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
  visit(chain, nodes, printed, false,
        [&](std::size_t s, const ChainObservation& seen, const AngleError& at) {
          if (std::isfinite(noise.swept_rad[seen.joint]))
            curves.of_stroke(s).add(seen.turns[seen.joint], seen.falling, {}, at.mean, seen.weight,
                                    at.within, 1 / (at.sigma * at.sigma));
        });
  const auto sums = curves.sums(evidence.size());
  for (std::size_t j = 0; j < evidence.size(); ++j) {
    if (std::isinf(noise.swept_rad[j])) continue;
    const ErrorCurve& errors = sums[j];
    const auto smooth = errors.fit(ErrorCurve::kSmooth);
    evidence[j].size = rms(errors.squares(), errors.samples());
    evidence[j].coherence = rms(smooth.explained, errors.samples()) <= kPrinted
                                ? 0
                                : coherence(smooth.explained, smooth.terms,
                                            errors.squares() - smooth.explained, errors.samples());
  }
}

bool stands_test(const AngleEvidence& evidence) {
  return evidence.size <= kMostQuanta && evidence.coherence <= kMostCoherence;
}

}  // namespace identify
