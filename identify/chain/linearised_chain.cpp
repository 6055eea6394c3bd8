#include "identify/chain/linearised_chain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "identify/chain/chain_problem.hpp"

namespace identify {

using Eigen::MatrixXd;
using Eigen::VectorXd;

LinearisedChain::LinearisedChain(const Chain& chain, ChainNodes& nodes, const ChainNoise& noise,
                                 const ChainEffects& shape, bool with_orientation)
    : nodes_(nodes), shape_(shape), columns_(shape, nodes) {
  sags_.resize(static_cast<Eigen::Index>(chain.sags.size()));
  for (std::size_t s = 0; s < chain.sags.size(); ++s)
    sags_(static_cast<Eigen::Index>(s)) = chain.sags[s].rad;
  const auto set = [&](auto&& problem) {
    strokes_ = problem.products(chain);
    prior_ = problem.prior(chain);
  };
  if (with_orientation)
    set(ChainProblem<6>(chain, nodes, noise, shape));
  else
    set(ChainProblem<3>(chain, nodes, noise, shape));
}

double LinearisedChain::deviance(const ChainEffects& effects) const {
  auto all =
      eliminate(strokes_, nodes_.home_of, variances_of(effects, nodes_, columns_), prior_.size());
  // Nothing would be left to say what strokes differ by if sags could be anything.
  const VectorXd known = prior_.tail(sags_.size());
  all.normal.diagonal().tail(sags_.size()) += known;
  all.gradient.tail(sags_.size()) -= known.cwiseProduct(sags_);
  all.squares += sags_.dot(known.cwiseProduct(sags_));
  // By Cholesky's factors where all is determined, which is many times faster.
  const VectorXd scale = all.normal.diagonal().cwiseSqrt().cwiseInverse();
  if (scale.allFinite()) {
    const Eigen::LLT<MatrixXd> factors(scale.asDiagonal() * all.normal * scale.asDiagonal());
    const VectorXd pivots = factors.matrixLLT().diagonal();
    if (factors.info() == Eigen::Success && pivots.minCoeff() > std::sqrt(kNoInformation)) {
      const VectorXd side = factors.matrixL().solve(scale.cwiseProduct(all.gradient));
      return all.log_determinant + 2 * (pivots.array() / scale.array()).log().sum() + all.squares -
             side.squaredNorm();
    }
  }
  const Information information(all.normal);
  const VectorXd step = information.step(all.gradient, 0);
  return all.log_determinant + information.log_determinant() + all.squares - step.dot(all.gradient);
}

std::vector<ChainEstimate::Part> LinearisedChain::parts() const {
  const EffectVariances all = variances_of(shape_, nodes_, columns_);
  const auto normal_at = [&](const EffectVariances& variances) -> MatrixXd {
    return eliminate(strokes_, nodes_.home_of, variances, prior_.size()).normal;
  };
  MatrixXd normal = normal_at(all);
  normal.diagonal() += prior_;
  const MatrixXd covariance = Information(normal).covariance();
  std::vector<ChainEstimate::Part> found;
  MatrixXd left = covariance;
  const auto add = [&](Cause cause, const MatrixXd& information) {
    found.push_back({cause, covariance * information * covariance});
    left -= found.back().covariance;
  };
  ChainEffects home, drift, figure, offset, print;
  home.home_rad = shape_.home_rad;
  drift.drift_mm = shape_.drift_mm;
  figure.figure_mm = shape_.figure_mm;
  offset.offset_rad = shape_.offset_rad;
  print.print_mm = shape_.print_mm;
  print.print_rad = shape_.print_rad;
  print.told_rad = shape_.told_rad;
  for (const auto& [cause, effect] : {std::pair<Cause, const ChainEffects&>(Cause::home, home),
                                      {Cause::drift, drift},
                                      {Cause::figure, figure},
                                      {Cause::offset, offset},
                                      {Cause::print, print}}) {
    // The effect's variances V add K V K^T to the covariance, K = N^-1 X^T V^-1: which is
    // -N^-1 dN/ds N^-1 where V grows by s.
    constexpr double kStep = 1e-3;
    const EffectVariances own = variances_of(effect, nodes_, columns_);
    const auto changed = [&](double by) {
      EffectVariances variances = all;
      for (std::size_t s = 0; s < all.own.size(); ++s) variances.own[s] += by * own.own[s];
      for (std::size_t g = 0; g < all.shared.size(); ++g) variances.shared[g] += by * own.shared[g];
      for (std::size_t h = 0; h < all.home.size(); ++h) variances.home[h] += by * own.home[h];
      return normal_at(variances);
    };
    MatrixXd information = (changed(-kStep) - changed(kStep)) / (2 * kStep);
    const Eigen::Index others = prior_.size() - sags_.size();
    if (cause == Cause::print) information.diagonal().head(others) += prior_.head(others);
    if (!information.isZero(0)) add(cause, information);
  }
  if (sags_.size() > 0) {
    MatrixXd information = MatrixXd::Zero(prior_.size(), prior_.size());
    information.diagonal().tail(sags_.size()) = prior_.tail(sags_.size());
    add(Cause::sag, information);
  }
  found.push_back({Cause::noise, left});
  std::rotate(found.begin(), found.end() - 1, found.end());
  return found;
}

namespace {

using Size = double ChainEffects::*;
constexpr std::size_t kCount = 5;
constexpr std::array<Size, kCount> kSizes{&ChainEffects::home_rad, &ChainEffects::drift_mm,
                                          &ChainEffects::figure_mm, &ChainEffects::offset_rad,
                                          &ChainEffects::told_rad};
constexpr std::size_t kFigure = 2;
/// Arcs depart from circles by no more than this share of the arm's reach: thirty times what any
/// arm showed. With more, an axis may be anywhere, its arc being any curve, and takes the blame for
/// angles that contradict each other.
constexpr double kMostFigure = 1e-2;
/// SizeSteps of each effect's size: nothing, then up by this factor.
using SizeSteps = std::array<int, kCount>;

/// The likelihood over the grid of sizes, computed where it is asked for.
class SizeGrid {
 public:
  SizeGrid(const LinearisedChain& chain, const ChainEffects& shape, double smallest_mm,
           double reach_mm)
      : chain_(chain), shape_(shape) {
    // In units of each effect in which they move the target alike.
    const double turn = smallest_mm / reach_mm;
    unit_ = {turn, smallest_mm, smallest_mm, turn, turn};
    last_.fill(last_step(reach_mm / smallest_mm));
    last_[kFigure] = last_step(kMostFigure * reach_mm / smallest_mm);
  }

  static constexpr double kFactor = 4;
  static int last_step(double largest) {
    const double range = std::log(largest) / std::log(kFactor);
    return 1 + static_cast<int>(std::ceil(std::clamp(range, 1.0, 40.0)));
  }

  [[nodiscard]] double size(std::size_t effect, int step) const {
    return step == 0 ? 0 : unit_[effect] * std::pow(kFactor, step - 1);
  }
  [[nodiscard]] int last(std::size_t effect) const { return last_[effect]; }
  double deviance(const SizeSteps& steps) {
    const auto [found, fresh] = known_.try_emplace(steps, 0.0);
    if (fresh) {
      ChainEffects effects = shape_;
      for (std::size_t k = 0; k < kCount; ++k) effects.*kSizes[k] = size(k, steps[k]);
      const double deviance = chain_.deviance(effects);
      found->second = std::isfinite(deviance) ? deviance : 1e300;
    }
    return found->second;
  }
  template <class Visit>
  void visit_next_to(const SizeSteps& steps, const Visit& visit) {
    for (std::size_t k = 0; k < kCount; ++k)
      for (const int by : {-1, 1}) {
        SizeSteps next = steps;
        next[k] += by;
        if (shape_.*kSizes[k] > 0 && next[k] >= 0 && next[k] <= last_[k]) visit(next);
      }
  }
  SizeSteps lowest_from(SizeSteps steps) {
    for (bool better = true; better;) {
      SizeSteps best = steps;
      visit_next_to(steps, [&](const SizeSteps& next) {
        if (deviance(next) < deviance(best)) best = next;
      });
      better = best != steps;
      steps = best;
    }
    return steps;
  }

 private:
  const LinearisedChain& chain_;
  const ChainEffects& shape_;
  std::array<double, kCount> unit_{};
  std::array<int, kCount> last_{};
  std::map<SizeSteps, double> known_;
};

/// Whether the data limit the size of this effect: far beyond all that was seen, each number that
/// tells of it takes log(size^2) from the likelihood. With two or fewer the mean size has no limit:
/// a campaign of one stroke says nothing of other strokes.
bool is_limited(const LinearisedChain& chain, const ChainEffects& shape, double smallest_mm,
                double reach_mm, std::size_t effect) {
  if (!(shape.*kSizes[effect] > 0)) return true;
  SizeGrid grid(chain, shape, smallest_mm, reach_mm);
  SizeSteps before{}, most{};
  before[effect] = grid.last(effect) - 1;
  most[effect] = grid.last(effect);
  constexpr double kNumbers = 2.5;
  return grid.deviance(most) - grid.deviance(before) > 2 * kNumbers * std::log(SizeGrid::kFactor);
}

}  // namespace

ChainEffects effect_sizes(const LinearisedChain& chain, const ChainEffects& shape,
                          double smallest_mm, double reach_mm) {
  ChainEffects limited = shape;
  for (std::size_t k = 0; k < kCount; ++k)
    if (!is_limited(chain, shape, smallest_mm, reach_mm, k)) limited.*kSizes[k] = 0;
  SizeGrid grid(chain, limited, smallest_mm, reach_mm);
  double least = std::numeric_limits<double>::infinity();
  // From nothing, and from each effect alone.
  std::vector<SizeSteps> open;
  for (std::size_t one = 0; one <= kCount; ++one) {
    if (one < kCount && !(limited.*kSizes[one] > 0)) continue;
    SizeSteps start{};
    if (one < kCount) start[one] = std::min(4, grid.last(one));
    open.push_back(grid.lowest_from(start));
    least = std::min(least, grid.deviance(open.back()));
  }
  // All around that is not out of the question.
  constexpr double kOut = 10;
  // Beforehand an effect is as likely none as it has any of so many sizes. Less, and white noise
  // alone would widen every interval; more, and what hardly shows would be passed over.
  constexpr double kNone = 30;
  std::set<SizeSteps> seen;
  double sum = 0;
  std::array<double, kCount> squares{};
  while (!open.empty()) {
    const SizeSteps here = open.back();
    open.pop_back();
    if (!seen.insert(here).second) continue;
    double weight = std::exp((least - grid.deviance(here)) / 2);
    for (std::size_t k = 0; k < kCount; ++k)
      if (here[k] == 0 && limited.*kSizes[k] > 0) weight *= kNone;
    sum += weight;
    for (std::size_t k = 0; k < kCount; ++k)
      squares[k] += weight * grid.size(k, here[k]) * grid.size(k, here[k]);
    grid.visit_next_to(here, [&](const SizeSteps& next) {
      if (grid.deviance(next) < least + kOut) open.push_back(next);
    });
  }
  ChainEffects effects = limited;
  for (std::size_t k = 0; k < kCount; ++k) effects.*kSizes[k] = std::sqrt(squares[k] / sum);
  return effects;
}

}  // namespace identify
