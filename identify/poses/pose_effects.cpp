#include "identify/poses/pose_effects.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "identify/dh/upright.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of what an effect does, so much must be left when the others have taken up what they can.
constexpr double kOwnShare = 1e-3;
constexpr int kMostFits = 4;
/// So much likelier, in twice the logarithm, is what the poses tell.
constexpr double kClearly = 10;
constexpr double kStartGears_rad = 10 * kArcsec;

/// The chance of a larger chi-square of one or two degrees of freedom.
double chance_above(double square, Index degrees) {
  return degrees == 1 ? std::erfc(std::sqrt(square / 2)) : std::exp(-square / 2);
}

/// Of links whose weights nobody knows: those on the joint's own link and on the next two. About an
/// axis that stays upright nothing pulls.
std::vector<JointEffect> weights(const PoseModel& model) {
  constexpr std::size_t kFarther = 2;
  const auto& axes = model.chain.axes;
  std::vector<JointEffect> all;
  for (std::size_t j = 0; j < axes.size(); ++j) {
    const bool stays = all.empty() && is_upright(axes[j].direction, model.chain.up);
    for (std::size_t k = j; k < std::min(axes.size(), j + kFarther + 1); ++k)
      if (!stays && !axes[j].linear && !axes[k].linear)
        all.push_back({JointEffect::Kind::weight, j, k});
  }
  return all;
}

/// What the model does not have yet.
std::vector<JointEffect> missing(const PoseModel& model) {
  std::vector<JointEffect> all;
  if (model.loads.empty()) all = weights(model);
  for (std::size_t j = 0; j < model.chain.axes.size(); ++j) {
    if (model.chain.axes[j].linear) continue;
    all.push_back({JointEffect::Kind::once, j});
    all.push_back({JointEffect::Kind::twice, j});
    if (!model.loads.empty()) all.push_back({JointEffect::Kind::compliance, j});
  }
  std::erase_if(all, [&](const JointEffect& effect) {
    return std::any_of(model.effects.begin(), model.effects.end(),
                       [&](const JointEffect& one) { return one.is_like(effect); });
  });
  const auto at_home = model.patterns(all, {});
  for (std::size_t e = 0; e < all.size(); ++e) all[e].middle = at_home[e];
  return all;
}

/// Of these, what poses can tell: a weight on the first link that tilts goes with its joint, once a
/// turn, and is told as that.
std::vector<JointEffect> candidates(const PoseModel& model) {
  auto all = missing(model);
  if (!all.empty() && all.front().kind == JointEffect::Kind::weight) all.erase(all.begin());
  return all;
}

/// What the candidates do to the poses beyond what the model's parameters can do: a normal matrix
/// and a gradient, from which effects are taken up one by one. The fit has come to its end: of its
/// own parameters no gradient is left.
class Scores {
 public:
  Scores(const PoseFit& fit, const std::vector<Pose>& poses, std::vector<JointEffect> candidates)
      : candidates_(std::move(candidates)) {
    Index count = 0;
    for (const JointEffect& candidate : candidates_) {
      first_.push_back(count);
      count += candidate.count();
    }
    normal_ = MatrixXd::Zero(count, count);
    gradient_ = VectorXd::Zero(count);
    MatrixXd with_parameters = MatrixXd::Zero(count, fit.model.parameters());
    for (const StandRows& stand : fit.counted()) {
      MatrixXd columns(stand.off.size(), count);
      Index at = 0;
      for (const std::size_t i : stand.poses) {
        const PoseRow& row = fit.rows[i];
        columns.middleRows(at, row.off.size()) =
            effect_columns(fit.model, candidates_, poses[i], row);
        at += row.off.size();
      }
      stand.root.matrixL().solveInPlace(columns);
      normal_ += columns.transpose() * columns;
      gradient_ += columns.transpose() * stand.off;
      with_parameters(Eigen::all, stand.parameters) +=
          columns.transpose() * stand.columns.transpose();
    }
    whole_ = normal_.diagonal();
    normal_ -= with_parameters * fit.covariance * with_parameters.transpose();
  }

  [[nodiscard]] std::size_t count() const { return candidates_.size(); }

  /// The one that poses ask for most; nothing where none is left.
  [[nodiscard]] std::optional<EffectEvidence> strongest() const {
    std::optional<EffectEvidence> best;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      const Index first = first_[k], size = candidates_[k].count();
      const MatrixXd own = normal_.block(first, first, size, size);
      if (!(own.diagonal().array() > kOwnShare * whole_.segment(first, size).array()).all() ||
          !(own.determinant() > kOwnShare * own.diagonal().prod()))
        continue;
      const VectorXd pull = gradient_.segment(first, size);
      const double chance = chance_above(pull.dot(own.llt().solve(pull)), size);
      if (!best || chance < best->chance)
        best = EffectEvidence{candidates_[k], Eigen::Vector2d::Zero(), chance};
    }
    return best;
  }

  /// The model has it now: the others are left with what it does not take up.
  void take_up(const JointEffect& effect) {
    const auto at = std::find_if(candidates_.begin(), candidates_.end(),
                                 [&](const JointEffect& one) { return one.is_like(effect); });
    const auto k = static_cast<std::size_t>(at - candidates_.begin());
    const Index first = first_[k], size = effect.count();
    const MatrixXd inverse = normal_.block(first, first, size, size).inverse();
    const MatrixXd with = normal_.middleCols(first, size);
    const VectorXd pull = gradient_.segment(first, size);
    gradient_ -= with * (inverse * pull);
    normal_ -= with * inverse * with.transpose();
  }

 private:
  std::vector<JointEffect> candidates_;
  std::vector<Index> first_;
  MatrixXd normal_;
  VectorXd gradient_;
  VectorXd whole_;  // of each, before anything is taken up
};

/// What no test finds is there all the same.
void assume_others(PoseFit& fit, const std::vector<Pose>& poses,
                   const std::optional<ChainPrior>& prior) {
  PoseModel model = fit.model;
  for (JointEffect& effect : missing(fit.model)) {
    if (effect.kind == JointEffect::Kind::compliance) continue;
    effect.assumed = true;
    model.effects.push_back(effect);
  }
  PoseNoise noise = fit.noise;
  noise.gears_rad = kStartGears_rad;
  if (model.loads.empty()) noise.weights_rad = kStartGears_rad;
  PoseFit with = fitted(model, noise, poses, fit.with_orientation, prior);
  if (with.converged) fit = std::move(with);
}

std::vector<EffectEvidence> add_effects(PoseFit& fit, const std::vector<Pose>& poses,
                                        const std::optional<ChainPrior>& prior) {
  std::vector<EffectEvidence> added;
  for (int round = 0; round < kMostFits && fit.converged; ++round) {
    Scores scores(fit, poses, candidates(fit.model));
    PoseModel model = fit.model;
    const std::size_t known = added.size();
    for (std::size_t left = scores.count(); left > 0; --left) {
      const auto best = scores.strongest();
      if (!best || best->chance * static_cast<double>(left) > kEffectByChance) break;
      scores.take_up(best->effect);
      // Before those that are assumed.
      model.effects.insert(model.effects.begin() + static_cast<std::ptrdiff_t>(added.size()),
                           best->effect);
      added.push_back(*best);
    }
    if (added.size() == known) break;
    const PoseFit before = fit;
    fit = fitted(model, fit.noise, poses, fit.with_orientation, prior);
    if (fit.converged) continue;
    fit = before;
    added.resize(known);
  }
  if (fit.converged) assume_others(fit, poses, prior);
  Index at = fit.model.chain_parameters().count(true);
  for (std::size_t e = 0; e < added.size(); ++e) {
    added[e].effect = fit.model.effects[e];
    const Index size = added[e].effect.count();
    added[e].sigma.head(size) = fit.covariance.diagonal().segment(at, size).cwiseSqrt();
    at += size;
  }
  return added;
}

}  // namespace

EffectsFit fitted_with_effects(const PoseModel& start, const PoseNoise& noise,
                               const std::vector<Pose>& poses, bool with_orientation,
                               const std::optional<ChainPrior>& prior) {
  const auto from = [&](const PoseModel& model) {
    EffectsFit found{fitted(model, noise, poses, with_orientation, prior), {}};
    found.effects = add_effects(found.fit, poses, prior);
    return found;
  };
  EffectsFit shared = from(start);
  if (start.places.empty()) return shared;
  PoseModel of_rests = start;
  of_rests.places.clear();
  EffectsFit anew = from(of_rests);
  const VectorXd weights = shared.fit.weights.cwiseMin(anew.fit.weights);
  const auto off = [&](const EffectsFit& of) { return deviance(of.fit, weights, poses, prior); };
  if (anew.fit.converged && (!shared.fit.converged || off(anew) + kClearly < off(shared)))
    return anew;
  return shared;
}

}  // namespace identify
