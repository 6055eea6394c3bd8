#include "identify/chain_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/angle_trust.hpp"
#include "identify/chain_fit.hpp"
#include "identify/chain_noise.hpp"
#include "identify/chain_samples.hpp"
#include "identify/fitted_axes.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

/// Below this nothing is measured, and nothing computed in double precision.
constexpr double kLeastPosition_mm = 1e-7;
constexpr double kLeastAngle_rad = 1e-11;

/// A way to explain the samples, and how well it does.
struct Fitted {
  ChainFit fit;
  ChainNoise noise;
};

class Estimation {
 public:
  Estimation(const Identification& circles, const Campaign& campaign)
      : circles_(circles), campaign_(campaign), joints_(circles.joints.size()) {}

  std::optional<ChainEstimate> run() {
    axes_ = starting_axes(circles_);
    ChainSamples found = chain_samples(circles_, axes_);
    samples_ = std::move(found.observations);
    if (samples_.empty()) return std::nullopt;
    targets_ = found.targets;
    Chain start;
    for (const auto& axis : axes_) start.axes.push_back(axis.value_or(ChainAxis{}));
    start.targets_mm = starting_targets(start, samples_, targets_, found.with_angles);
    set_quanta(found.with_angles);

    Fitted best = without_angles(start, found.with_angles);
    ChainEstimate estimate;
    estimate.angles.assign(joints_, AngleEvidence{});
    for (AngleEvidence& evidence : estimate.angles) evidence.reason = "no angles";
    if (found.with_angles) {
      estimate.angles = seen_angle_errors(best.fit.chain, samples_, best.noise, quantum_);
      if (shared_home_ && explained_by_print(best, false)) believe_angles(best, estimate.angles);
    }
    if (found.with_orientation) estimate.with_orientation = add_orientation(best);
    finish(best, estimate);
    return estimate;
  }

 private:
  void set_quanta(bool with_angles) {
    const double step = 1 / std::sqrt(12.0);
    quantum_.position_mm = std::max(kLeastPosition_mm, step * campaign_.resolution.position_mm);
    const double angle = std::max(kLeastAngle_rad, step * campaign_.resolution.angle_rad);
    quantum_.orientation_rad = angle;
    quantum_.locked_rad = with_angles ? angle : 0;
    quantum_.swept_rad.assign(joints_, angle);
    // A locked joint whose angle is printed the same all the time does not scatter by its quantum.
    floor_ = quantum_;
    floor_.locked_rad = 0;
  }

  /// Fits, estimates the noise, weighs the samples, until neither changes the other.
  Fitted settled(Chain chain, ChainNoise noise, bool with_orientation) {
    constexpr int kMostRounds = 8;
    Fitted result;
    int iterations = 0;
    for (int round = 0; round < kMostRounds; ++round) {
      result.fit = fit_chain(chain, samples_, noise, with_orientation);
      iterations += result.fit.summary.iterations;
      chain = result.fit.chain;
      const ChainNoise before =
          std::exchange(noise, estimate_noise(chain, samples_, noise, floor_, with_orientation));
      const double weights = total_weight();
      reweight(chain, samples_, noise, with_orientation);
      if (same(noise, before) && std::abs(total_weight() - weights) < 0.5) break;
    }
    result.fit = fit_chain(chain, samples_, noise, with_orientation);
    result.fit.summary.iterations += iterations;
    result.noise = noise;
    return result;
  }

  [[nodiscard]] double total_weight() const {
    double sum = 0;
    for (const ChainObservation& sample : samples_) sum += sample.weight;
    return sum;
  }

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

  /// Circles about one chain. Where they do not pass one common home point, each by itself.
  Fitted without_angles(const Chain& start, bool with_angles) {
    Fitted shared = robustly_started(start);
    if (axes() < 2) return shared;
    const auto kept = samples_;
    Chain apart = shared.fit.chain;
    for (std::size_t t = 0; t < targets_; ++t)
      for (std::size_t j = 1; j < joints_; ++j) apart.targets_mm.push_back(apart.targets_mm[t]);
    for (ChainObservation& sample : samples_)
      if (sample.joint > 0)
        sample.target = targets_ + sample.target * (joints_ - 1) + sample.joint - 1;
    // What home points of their own would gain, to first order: the score test (Rao 1948). A step
    // squared, in standard uncertainties, is the chi squared that it takes away. Chi squared passes
    // its mean by eight of its standard deviations never.
    const double step = fit_chain(apart, samples_, shared.noise, false, 0).summary.last_step;
    const double freedom = 2 * static_cast<double>(targets_) * static_cast<double>(axes());
    const double bound = freedom + 8 * std::sqrt(2 * freedom);
    if (step * step > bound || shared.noise.position_mm > 2 * circle_scatter()) {
      // In earnest: by the noise that is left without a common home, and its correlation.
      apart.axes = start.axes;
      apart.targets_mm = starting_targets(apart, samples_, apart.targets_mm.size(), with_angles);
      Fitted separate = robustly_started(std::move(apart));
      std::vector<ChainObservation> pooled = kept;
      for (std::size_t i = 0; i < pooled.size(); ++i) pooled[i].weight = samples_[i].weight;
      const double cost = fit_chain(shared.fit.chain, pooled, separate.noise, false).summary.cost;
      if (2 * (cost - separate.fit.summary.cost) > bound * correlated(separate, false)) {
        shared_home_ = false;
        return separate;
      }
    }
    samples_ = kept;
    return shared;
  }

  [[nodiscard]] double correlated(const Fitted& fitted, bool with_orientation) const {
    return samples_per_independent(fitted.fit.chain, samples_, fitted.noise, with_orientation);
  }

  /// How far samples are off the circles that they were found on, in the worst joint.
  [[nodiscard]] double circle_scatter() const {
    double scatter = 0;
    for (const JointResult& joint : circles_.joints)
      if (joint.circle)
        scatter = std::max({scatter, joint.circle->plane_rms_mm, joint.circle->radial_rms_mm});
    return scatter;
  }

  [[nodiscard]] std::size_t axes() const {
    return static_cast<std::size_t>(std::count_if(
        axes_.begin(), axes_.end(), [](const auto& axis) { return axis.has_value(); }));
  }

  /// The first fit: the noise is not known yet, and some points may be far off.
  Fitted robustly_started(Chain chain) {
    ChainNoise noise = floor_;
    noise.swept_rad.assign(joints_, kFreeAngle);
    noise.position_mm = 1;
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      const double sigma =
          std::max(floor_.position_mm, robust_position_sigma(chain, samples_, noise));
      noise.position_mm = sigma;
      reweight(chain, samples_, noise, false);
      chain = fit_chain(chain, samples_, noise, false).chain;
    }
    noise.position_mm = std::max(floor_.position_mm, robust_position_sigma(chain, samples_, noise));
    reweight(chain, samples_, noise, false);
    return settled(std::move(chain), noise, false);
  }

  /// Root mean square of what is left, in what printed numbers alone would leave.
  [[nodiscard]] double misprint(const Fitted& fitted, bool with_orientation) const {
    ChainNoise printed = quantum_;
    for (std::size_t j = 0; j < joints_; ++j)
      if (std::isinf(fitted.noise.swept_rad[j])) printed.swept_rad[j] = kFreeAngle;
    return misfit(fitted.fit.chain, samples_, printed, with_orientation);
  }

  [[nodiscard]] bool explained_by_print(const Fitted& fitted, bool with_orientation) const {
    return misprint(fitted, with_orientation) <= kMostQuanta;
  }

  /// Believes all angles, then takes back the worst joint's that does not stand the test, and so
  /// on.
  void believe_angles(Fitted& best, std::vector<AngleEvidence>& evidence) {
    ChainNoise noise = best.noise;
    noise.locked_rad = std::max(noise.locked_rad, floor_.locked_rad);
    std::vector<bool> swept(joints_, false);
    for (const ChainObservation& sample : samples_) swept[sample.joint] = true;
    for (std::size_t j = 0; j < joints_; ++j)
      if (swept[j]) noise.swept_rad[j] = quantum_.swept_rad[j];
    const auto free_samples = samples_;
    for (std::size_t tried = 0; tried <= joints_; ++tried) {
      samples_ = free_samples;
      for (ChainObservation& sample : samples_)
        if (std::isfinite(noise.swept_rad[sample.joint]))
          sample.turns[sample.joint] = sample.measured_turn;
      Fitted believed = settled(best.fit.chain, noise, false);
      test_believed_angles(believed.fit.chain, samples_, believed.noise, quantum_, evidence);
      std::optional<std::size_t> worst;
      bool any = false;
      for (std::size_t j = 0; j < joints_; ++j) {
        if (std::isinf(noise.swept_rad[j])) continue;
        any = true;
        if (!stands_test(evidence[j]) && (!worst || evidence[j].size > evidence[*worst].size))
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
      evidence[*worst].reason = evidence[*worst].size > kMostQuanta
                                    ? "larger errors than the printed decimals explain"
                                    : "a pattern in the residuals along the motion";
      noise.swept_rad[*worst] = kFreeAngle;
    }
    samples_ = free_samples;
  }

  /// Whether the tool's orientations agree with what the positions found; then they are used.
  bool add_orientation(Fitted& best) {
    Chain chain = best.fit.chain;
    // The tool at home, as the mean over all samples: the rotation closest to it.
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const ChainObservation& sample : samples_)
      sum += sample.weight * chain.displacement(sample.turns).linear().transpose() *
             sample.orientation;
    const Eigen::Quaterniond mean = closest_rotation(sum);
    chain.tool = mean.toRotationMatrix();
    // They share their encoders with the positions, or they are left alone.
    best.fit.chain.tool = chain.tool;
    if (!explained_by_print(best, false) || misprint(best, true) > 2 * kMostQuanta) return false;
    const auto kept = samples_;
    ChainNoise noise = best.noise;
    noise.orientation_rad = quantum_.orientation_rad;
    Fitted oriented = settled(chain, noise, true);
    const bool consistent = oriented.fit.summary.converged && explained_by_print(oriented, true);
    if (consistent) {
      best = std::move(oriented);
    } else {
      samples_ = kept;
    }
    return consistent;
  }

  static Eigen::Quaterniond closest_rotation(const Eigen::Matrix3d& sum) {
    // Polar decomposition by Newton's iteration (Higham 1986).
    Eigen::Matrix3d rotation = sum;
    for (int k = 0; k < 30 && std::abs(rotation.determinant()) > 1e-300; ++k)
      rotation = 0.5 * (rotation + rotation.inverse().transpose());
    if (!rotation.allFinite() || rotation.determinant() <= 0) return Eigen::Quaterniond::Identity();
    return Eigen::Quaterniond(rotation).normalized();
  }

  void finish(const Fitted& best, ChainEstimate& estimate) const {
    estimate.noise = best.noise;
    estimate.summary = best.fit.summary;
    estimate.shared_home = shared_home_;
    estimate.samples = samples_.size();
    estimate.samples_per_independent = correlated(best, estimate.with_orientation);
    for (const ChainObservation& sample : samples_)
      if (sample.weight < 0.5) ++estimate.outliers;

    std::vector<bool> known;
    for (const auto& axis : axes_) known.push_back(axis.has_value());
    set_fitted_axes(estimate, best.fit, known, targets_);
  }

  const Identification& circles_;
  const Campaign& campaign_;
  std::size_t joints_;
  std::size_t targets_ = 1;
  std::vector<std::optional<ChainAxis>> axes_;  ///< to start from
  std::vector<ChainObservation> samples_;
  ChainNoise quantum_;  ///< what printed numbers alone would scatter
  ChainNoise floor_;    ///< what estimates of the noise do not go below
  bool shared_home_ = true;
};

}  // namespace

std::optional<ChainEstimate> estimate_chain(const Identification& circles,
                                            const Campaign& campaign) {
  return Estimation(circles, campaign).run();
}

}  // namespace identify
