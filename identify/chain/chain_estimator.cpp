#include "identify/chain/chain_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/chain/angle_trust.hpp"
#include "identify/chain/chain.hpp"
#include "identify/chain/chain_fit.hpp"
#include "identify/chain/chain_noise.hpp"
#include "identify/chain/chain_start.hpp"
#include "identify/chain/effect_search.hpp"
#include "identify/chain/home_turn.hpp"
#include "identify/chain/linearised_chain.hpp"
#include "identify/chain/locked_places.hpp"
#include "identify/chain/locked_readings.hpp"
#include "identify/dh/upright.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/sweeps/stroke_correlation.hpp"

namespace identify {
namespace {

/// Below this nothing is measured, and nothing computed in double precision.
constexpr double kLeastPosition_mm = 1e-7;

class Estimation {
 public:
  Estimation(const CircleEstimate& circles, std::vector<std::optional<ChainAxis>> axes,
             const Campaign& campaign, double late_s)
      : circles_(circles),
        campaign_(campaign),
        late_s_(late_s),
        joints_(circles.joints.size()),
        axes_(std::move(axes)) {}

  std::optional<ChainEstimate> run() {
    nodes_ = chain_nodes(circles_, axes_, campaign_.resolution);
    if (nodes_.strokes.empty()) return std::nullopt;
    const double correlation = correlation_of(nodes_.strokes);
    for (StrokeMoments& stroke : nodes_.strokes) stroke.correlation *= correlation;
    Chain start;
    for (const auto& axis : axes_) start.axes.push_back(axis.value_or(ChainAxis{}));
    start.up = up_in(start).value_or(Eigen::Vector3d::Zero());
    start.targets_mm =
        starting_targets(start, nodes_.observations, nodes_.targets, nodes_.with_angles);
    set_quanta(nodes_.with_angles);
    const double step_rad = campaign_.resolution.angle_rad;
    if (nodes_.with_angles) effects_.zero_rad = unseen_zeros(nodes_, step_rad);
    effects_.places_rad = untold_places(nodes_, effects_.zero_rad, step_rad);

    FittedChain best = without_angles(start);
    if (nodes_.with_angles && discount_readings(nodes_, best.fit.chain, best.noise, step_rad))
      best = settled(best.fit.chain, best.noise, false);
    by_device_ = noise_of_device(best);
    ChainEstimate estimate;
    estimate.angles.assign(joints_, AngleEvidence{});
    for (AngleEvidence& evidence : estimate.angles) evidence.reason = "no angles";
    if (nodes_.with_angles) {
      estimate.angles = seen_angle_errors(best.fit.chain, nodes_, best.noise, quantum_, {});
      if (by_print_alone(best)) believe_angles(best, estimate.angles);
    }
    // No angles, or none believed; more noise would have the rounding average out.
    if (effects_.print_mm == 0 && !by_device_ &&
        (explained_by_print(best, false) || !effects_.places_rad.empty())) {
      effects_.print_mm = campaign_.resolution.position_mm;
      best = settled(best.fit.chain, best.noise, false);
      if (by_print_alone(best)) search().size(best, with_places(effects_));
    }
    if (!by_print_alone(best)) {
      others_ = search().find_all(best);
      judge_gears(best, estimate.angles);
    }
    if (nodes_.with_orientation) estimate.with_orientation = add_orientation(best);
    finish(best, estimate);
    return estimate;
  }

 private:
  /// Without a specified arm, the first joint that turns is taken to stand upright.
  [[nodiscard]] std::optional<Eigen::Vector3d> up_in(const Chain& start) const {
    std::vector<std::optional<Eigen::Vector3d>> seen;
    for (const auto& axis : axes_)
      seen.push_back(axis ? std::optional(axis->direction) : std::nullopt);
    if (!campaign_.specified) {
      const auto first = first_turning(start);
      return first ? seen[*first] : std::nullopt;
    }
    Arm arm = *campaign_.specified;
    arm.rows = circles_.specified;
    return up_among(seen, arm, campaign_.up);
  }

  void set_quanta(bool with_angles) {
    const Resolution& step = campaign_.resolution;
    const double angle = std::max(kLeastAngle_rad, kEvenlySpread * step.angle_rad);
    quantum_ = {std::max(kLeastPosition_mm, kEvenlySpread * step.position_mm), angle,
                with_angles ? angle : 0, std::vector<double>(joints_, angle)};
    // A locked joint whose angle is printed the same all the time does not scatter by its quantum.
    floor_ = quantum_;
    floor_.locked_rad = 0;
  }

  /// Fits and estimates the noise until neither changes the other.
  FittedChain settled(Chain chain, ChainNoise noise, bool with_orientation) {
    constexpr int kMostRounds = 8;
    FittedChain result;
    int iterations = 0;
    for (int round = 0; round < kMostRounds; ++round) {
      result.fit = fit_chain(chain, nodes_, noise, effects_, with_orientation);
      iterations += result.fit.summary.iterations;
      chain = result.fit.chain;
      const ChainNoise before =
          std::exchange(noise, estimate_noise(chain, nodes_, noise, floor_, with_orientation));
      if (same(noise, before)) break;
    }
    result.fit = fit_chain(chain, nodes_, noise, effects_, with_orientation);
    result.fit.summary.iterations += iterations;
    result.noise = noise;
    return result;
  }

  [[nodiscard]] EffectSearch search() { return {nodes_, effects_, campaign_.sag_rad}; }

  static bool same(const ChainNoise& a, const ChainNoise& b) {
    constexpr double kAlike = 0.01;
    const auto alike = [](double x, double y) {
      return x == y || std::abs(x - y) <= kAlike * std::max(x, y);
    };
    bool all = alike(a.position_mm, b.position_mm) && alike(a.orientation_rad, b.orientation_rad) &&
               alike(a.locked_rad, b.locked_rad);
    for (std::size_t j = 0; j < a.swept_rad.size(); ++j)
      all = all && alike(a.swept_rad[j], b.swept_rad[j]);
    return all;
  }

  /// The first fit: the noise is not known yet.
  FittedChain without_angles(const Chain& start) {
    ChainNoise noise = floor_;
    noise.swept_rad.assign(joints_, kFreeAngle);
    noise.position_mm = 1;
    const Chain chain = fit_chain(start, nodes_, noise, effects_, false).chain;
    return settled(chain, estimate_noise(chain, nodes_, noise, floor_, false), false);
  }

  /// Root mean square of what is left, in what printed numbers alone would leave.
  [[nodiscard]] double misprint(const FittedChain& fitted, bool with_orientation) const {
    ChainNoise printed = quantum_;
    // At another home by its step, and by that of the first one.
    if (nodes_.homes.size() > 1) printed.locked_rad *= std::sqrt(2.0);
    for (std::size_t j = 0; j < joints_; ++j)
      if (std::isinf(fitted.noise.swept_rad[j])) printed.swept_rad[j] = kFreeAngle;
    return misfit(fitted.fit.chain, nodes_, printed, with_orientation);
  }

  [[nodiscard]] bool explained_by_print(const FittedChain& fitted, bool with_orientation) const {
    return misprint(fitted, with_orientation) <= kMostQuanta;
  }

  /// Few decimals of locked joints' angles explain much: a device's noise, too. But a joint that
  /// shakes moves the target as its lever is, and a device's noise is the same wherever it stands.
  [[nodiscard]] bool noise_of_device(const FittedChain& fitted) const {
    const ChainNoise& noise = fitted.noise;
    return noise.position_mm > kMostQuanta * quantum_.position_mm &&
           noise.position_mm > noise.locked_rad * reach_mm(fitted.fit.chain, nodes_.known);
  }

  /// Positions that a controller computed are off by their rounding and nothing else. What a device
  /// measured is off by its noise, and gears err between it and the angles, however coarse the
  /// print is that hides them.
  [[nodiscard]] bool by_print_alone(const FittedChain& fitted) const {
    constexpr double kRounding = 1.03, kByChance = 2;
    const double numbers = 3 * static_cast<double>(nodes_.samples());
    // What is not printed in steps is off by what computing makes.
    const double most = campaign_.resolution.position_mm > 0
                            ? kRounding + kByChance / std::sqrt(numbers)
                            : kMostQuanta;
    return !by_device_ && misprint(fitted, false) <= most;
  }

  /// Where a locked joint stands, its printed angle tells to a step: at another home it is off
  /// otherwise, and from stroke to stroke it may come back elsewhere within the step.
  [[nodiscard]] ChainEffects with_places(ChainEffects shape) const {
    shape.home_rad = nodes_.units.size() > 1 ? 1 : 0;
    shape.offset_rad = nodes_.homes.size() > 1 ? 1 : 0;
    return shape;
  }

  /// Believes all angles, then takes back those of the worst joint that fails the test, and so on.
  void believe_angles(FittedChain& best, std::vector<AngleEvidence>& evidence) {
    ChainNoise noise = best.noise;
    noise.locked_rad = std::max(noise.locked_rad, floor_.locked_rad);
    std::vector<bool> swept(joints_, false);
    for (const StrokeMoments& stroke : nodes_.strokes)
      if (stroke.told) swept[stroke.content.joint] = true;
    for (std::size_t j = 0; j < joints_; ++j)
      if (swept[j]) noise.swept_rad[j] = quantum_.swept_rad[j];
    effects_.print_mm = campaign_.resolution.position_mm;
    effects_.print_turn_rad = campaign_.resolution.angle_rad;
    effects_.late_s = late_s_;
    const auto free_nodes = nodes_.observations;
    for (std::size_t tried = 0; tried <= joints_; ++tried) {
      nodes_.observations = free_nodes;
      for (ChainObservation& sample : nodes_.observations)
        if (std::isfinite(noise.swept_rad[sample.joint]))
          sample.turns[sample.joint] = sample.measured_turn;
      effects_.told_rad = effects_.home_rad = effects_.offset_rad = 0;
      FittedChain believed = settled(best.fit.chain, noise, false);
      ChainEffects shape = with_places(effects_);
      shape.told_rad = 1;
      search().size(believed, shape);
      test_believed_angles(believed.fit.chain, nodes_, believed.noise, quantum_, evidence);
      const bool printed = by_print_alone(believed);
      std::optional<std::size_t> worst;
      bool any = false;
      for (std::size_t j = 0; j < joints_; ++j) {
        if (std::isinf(noise.swept_rad[j])) continue;
        any = true;
        if (!(printed && stands_test(evidence[j])) &&
            (!worst || evidence[j].size > evidence[*worst].size))
          worst = j;
      }
      if (!worst && any) {
        best = std::move(believed);
        for (std::size_t j = 0; j < joints_; ++j)
          if (std::isfinite(noise.swept_rad[j])) {
            evidence[j].trust = AngleTrust::trusted;
            evidence[j].reason = "residuals along the motion are those of the printed decimals";
          }
        return;
      }
      if (!any) break;
      evidence[*worst].reason = !printed || evidence[*worst].size > kMostQuanta
                                    ? "larger errors than the printed decimals explain"
                                    : "a pattern in the residuals along the motion";
      noise.swept_rad[*worst] = kFreeAngle;
    }
    nodes_.observations = free_nodes;
    effects_.print_mm = effects_.print_turn_rad = effects_.late_s = effects_.told_rad = 0;
    effects_.home_rad = effects_.offset_rad = 0;
  }

  /// Of angles that are not believed, what their gears have beside what strokes have.
  void judge_gears(const FittedChain& best, std::vector<AngleEvidence>& evidence) const {
    if (!nodes_.with_angles) return;
    ChainEffects open = effects_;  // strokes have for themselves what is not known of a drift, too
    open.drift_mm = std::hypot(open.drift_mm, drift_sigma_mm(best.fit, effects_));
    auto now = seen_angle_errors(best.fit.chain, nodes_, best.noise, quantum_, open);
    if (!best.fit.summary.converged) {
      now.assign(joints_, AngleEvidence{});
      for (AngleEvidence& nothing : now) nothing.reason = "the chain did not come to its end";
    }
    for (std::size_t j = 0; j < joints_; ++j)
      if (evidence[j].trust != AngleTrust::trusted) evidence[j] = std::move(now[j]);
  }

  /// Whether the tool's orientations agree with what the positions found; then they are used. Only
  /// a fit with them tells: a target near an axis leaves open how that lies.
  bool add_orientation(FittedChain& best) {
    Chain chain = best.fit.chain;
    chain.tool = starting_tool(chain, nodes_.observations);
    best.fit.chain.tool = chain.tool;
    if (!by_print_alone(best)) return false;  // they share their encoders, or are left alone
    const auto kept = nodes_.observations;
    ChainNoise noise = best.noise;
    noise.orientation_rad = quantum_.orientation_rad;
    effects_.print_rad = campaign_.resolution.angle_rad;
    FittedChain oriented = settled(chain, noise, true);
    const bool consistent = oriented.fit.summary.converged && explained_by_print(oriented, true);
    if (consistent) {
      best = std::move(oriented);
    } else {
      nodes_.observations = kept;
      effects_.print_rad = 0;
    }
    return consistent;
  }

  /// Something moved, if what explains as much is so.
  void add_doubt(ChainFit& fit) const {
    if (others_.empty()) return;
    const Eigen::MatrixXd doubt = doubt_of(others_, fit.covariance.rows());
    fit.covariance += doubt;
    const auto drift = std::find_if(fit.parts.begin(), fit.parts.end(),
                                    [](const auto& part) { return part.cause == Cause::drift; });
    if (drift == fit.parts.end())
      fit.parts.push_back({Cause::drift, doubt});
    else
      drift->covariance += doubt;
  }

  void finish(FittedChain& best, ChainEstimate& estimate) {
    estimate.noise = best.noise;
    estimate.summary = best.fit.summary;
    estimate.samples = nodes_.samples();
    estimate.outliers = nodes_.outliers();
    double sum = 0, weight = 0;
    for (const StrokeMoments& stroke : nodes_.strokes) {
      sum += stroke.weight / stroke.correlation;
      weight += stroke.weight;
      if (!stroke.squares) estimate.summed += stroke.strokes;
    }
    estimate.samples_per_independent = weight / sum;

    estimate.effects = effects_;
    double home_mm = 0;
    for (std::size_t j = 0; j < joints_; ++j)
      if (nodes_.known[j])
        home_mm = std::max(home_mm, effects_.home_rad_of(j) * lever_mm(best.fit.chain, j));
    // A wave is, on the average of its square, a half.
    const double waves = best.fit.chain.drift_mm.rightCols<kDriftParts - 1>().squaredNorm() / 2 / 3;
    estimate.wander_mm = std::hypot(effects_.drift_mm, std::sqrt(waves));
    estimate.home_scatter_mm = std::hypot(home_mm, estimate.wander_mm);
    LinearisedChain linearised(best.fit.chain, nodes_, best.noise, effects_,
                               estimate.with_orientation);
    best.fit.parts = linearised.parts();
    estimate.others = explanations(others_, best.fit, nodes_);
    add_doubt(best.fit);
    estimate.steady_drift =
        steady_drift_of(best.fit, effects_, campaign_.timed ? nodes_.seconds() : 0);
    estimate.move = move_of(best.fit, nodes_);
    estimate.strays = strays_of(effects_, nodes_);
    set_fitted_axes(estimate, best.fit, nodes_.known, nodes_.targets);
    add_turns_at_home(estimate, play_variances(estimate.angles));
  }

  const CircleEstimate& circles_;
  const Campaign& campaign_;
  double late_s_;
  std::size_t joints_;
  std::vector<std::optional<ChainAxis>> axes_;  ///< to start from
  ChainNodes nodes_;
  ChainEffects effects_;
  std::vector<Incident> others_;  ///< that explain about as much
  ChainNoise quantum_;            ///< what printed numbers alone would scatter
  ChainNoise floor_;              ///< what estimates of the noise do not go below
  bool by_device_ = false;
};

}  // namespace

std::optional<ChainEstimate> estimate_chain(const CircleEstimate& circles,
                                            std::vector<std::optional<ChainAxis>> axes,
                                            const Campaign& campaign, double late_s) {
  return Estimation(circles, std::move(axes), campaign, late_s).run();
}

}  // namespace identify
