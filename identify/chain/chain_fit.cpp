#include "identify/chain/chain_fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <Eigen/Cholesky>

#include "identify/chain/chain_problem.hpp"
#include "identify/chain/home_turn.hpp"
#include "identify/geometry/information.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// A step this small in standard uncertainties is none.
constexpr double kSmallStep = 1e-7;
/// So close the end may be rounding's.
constexpr double kCloseStep = 1e-2;
/// A step that is left, since rounding or effects that turn along lead no further: it adds a
/// fiftieth to an uncertainty at most.
constexpr double kHarmlessStep = 0.2;
constexpr std::string_view kNearly = "converged to a fraction of the uncertainties";
/// Steps that shrink so lead somewhere.
constexpr double kShrinks = 0.7;
constexpr double kFirstDamping = 1e-6;
constexpr double kMostDamping = 1e6;

/// A chain, and what its linearisation says.
struct FitPoint {
  FitPoint(Chain at, NormalEquations found)
      : chain(std::move(at)), equations(std::move(found)), information(equations.normal) {
    to_go =
        std::sqrt(std::max(0.0, information.step(equations.gradient, 0).dot(equations.gradient)));
  }

  /// With random effects the equations are not quite the cost's gradient: effects turn along with
  /// the chain. So what counts is also the step that is left, in the manner of Deuflhard's
  /// monotonicity test (Newton Methods for Nonlinear Problems, 2004, sec. 4.3).
  [[nodiscard]] bool better_than(const FitPoint& before) const {
    if (!std::isfinite(equations.cost) || !std::isfinite(to_go)) return false;
    return equations.cost <= before.equations.cost ||
           (to_go <= kShrinks * before.to_go &&
            information.undetermined() <= before.information.undetermined());
  }

  Chain chain;
  NormalEquations equations;
  Information information;
  double to_go = 0;  ///< length of the step from here, in standard uncertainties
};

template <int Size>
class Fitting {
 public:
  Fitting(const Chain& start, ChainNodes& nodes, const ChainNoise& noise,
          const ChainEffects& effects)
      : problem_(start, nodes, noise, effects), here_(at(with_zeros(start, effects))) {}

  ChainFit run(int most_iterations) {
    Summary summary;
    while (true) {
      problem_.follow();
      if (const auto ending = ended(summary, most_iterations)) {
        summary.ending = *ending;
        break;
      }
      ++summary.iterations;
      if (!step()) {
        summary.converged = here_.to_go < kHarmlessStep;
        summary.ending = summary.converged ? kNearly : "no better place found";
        break;
      }
    }
    summary.cost = here_.equations.cost;
    summary.condition = here_.information.condition();
    summary.undetermined = here_.information.undetermined();
    summary.last_step = here_.to_go;
    Eigen::MatrixXd covariance = here_.information.covariance();
    if (summary.undetermined > 0) {
      const Eigen::MatrixXd open = here_.information.open();
      covariance += open * open.transpose();
    }
    return {std::move(here_.chain), std::move(covariance), {}, summary};
  }

 private:
  static Chain with_zeros(Chain chain, const ChainEffects& effects) {
    chain.zero_rad.resize(effects.zero_rad.size());
    return chain;
  }

  FitPoint at(Chain chain) {
    NormalEquations equations = problem_.linearised(chain);
    return {std::move(chain), std::move(equations)};
  }

  std::optional<std::string_view> ended(Summary& summary, int most_iterations) const {
    if (!std::isfinite(here_.to_go) || !std::isfinite(here_.equations.cost))
      return "numbers beyond all bounds";
    if (here_.to_go < kSmallStep) {
      summary.converged = true;
      return "converged";
    }
    if (summary.iterations < most_iterations) return std::nullopt;
    summary.converged = here_.to_go < kHarmlessStep;
    return summary.converged ? kNearly : "no convergence";
  }

  /// Goes to a better place, if there is one.
  bool step() {
    while (true) {
      FitPoint there = at(after(here_.information.step(here_.equations.gradient, damping_)));
      if (there.better_than(here_)) {
        damping_ = damping_ > kFirstDamping ? damping_ / 10 : 0;
        here_ = std::move(there);
        return true;
      }
      damping_ = std::max(kFirstDamping, 10 * damping_);
      if (damping_ > kMostDamping || here_.to_go < kCloseStep) return false;
    }
  }

  Chain after(const VectorXd& change) const {
    const Index count = ChainProblem<Size>::count(here_.chain);
    Chain there = moved(here_.chain, change.head(count));
    for (std::size_t j = 0; j < there.zero_rad.size(); ++j)
      there.zero_rad[j] += change(count + static_cast<Index>(j));
    for (std::size_t s = 0; s < there.sags.size(); ++s)
      there.sags[s].rad += change(count + static_cast<Index>(there.zero_rad.size() + s));
    const Index drift = problem_.first_drift(there), move = problem_.first_move(there);
    for (Index k = drift; k < move; ++k)
      there.drift_mm((k - drift) % 3, (k - drift) / 3) += change(k);
    for (Index k = move; k < change.size(); ++k) there.move(k - move) += change(k);
    return there;
  }

  ChainProblem<Size> problem_;
  FitPoint here_;
  double damping_ = 0;
};

}  // namespace

ChainFit fit_chain(const Chain& start, ChainNodes& nodes, const ChainNoise& noise,
                   const ChainEffects& effects, bool with_orientation, int most_iterations) {
  return with_orientation ? Fitting<6>(start, nodes, noise, effects).run(most_iterations)
                          : Fitting<3>(start, nodes, noise, effects).run(most_iterations);
}

namespace {

Index first_move(const ChainFit& fit) {
  return fit.covariance.rows() - fit.chain.move.size();
}
Index first_drift(const ChainFit& fit, const ChainEffects& effects) {
  return first_move(fit) - effects.drift_columns();
}

}  // namespace

std::optional<ChainEstimate::SteadyDrift> steady_drift_of(const ChainFit& fit,
                                                          const ChainEffects& effects,
                                                          double seconds) {
  constexpr double kSure = 30;  // of a chi-square of three: by chance once in a million campaigns
  constexpr double kWalk = 6;   // the variance of a walk from end to end, in that of its places
  if (!(effects.steady_mm > 0)) return std::nullopt;
  const Index steady = first_drift(fit, effects);
  ChainEstimate::SteadyDrift drift{2 * fit.chain.drift_mm.col(0),
                                   4 * fit.covariance.block<3, 3>(steady, steady), seconds};
  drift.covariance.diagonal().array() += kWalk * effects.drift_mm * effects.drift_mm;
  // And of a walk whose waves are as large as those that were found.
  const DriftTimes walk = drift_of_walk();
  for (Index k = 1; k < effects.drift_parts; ++k)
    drift.covariance.diagonal().array() += 4 * fit.chain.drift_mm.col(k).squaredNorm() /
                                           (walk(k) * walk(k)) / 3 /
                                           static_cast<double>(effects.drift_parts - 1);
  if (drift.mm.dot(drift.covariance.ldlt().solve(drift.mm)) < kSure) return std::nullopt;
  return drift;
}

std::optional<ChainEstimate::MoveSeen> move_of(const ChainFit& fit, const ChainNodes& nodes) {
  const Chain& chain = fit.chain;
  if (chain.move.size() == 0) return std::nullopt;
  const auto covariance =
      fit.covariance.bottomRightCorner(chain.move_numbers(), chain.move_numbers());
  ChainEstimate::MoveSeen move;
  for (std::size_t target = 0; target < chain.targets_mm.size(); ++target) {
    const Eigen::Matrix3Xd by =
        chain.by_move(target, chain.targets_mm[target], Eigen::Matrix3d::Identity());
    const Eigen::Vector3d mm = -by * chain.move;
    if (target == 0 || mm.norm() > move.mm.norm())
      move = {mm, by * covariance * by.transpose(), 0, 0, {}};
  }
  if (move.mm.norm() < kLeastMove_mm) return std::nullopt;
  std::set<std::size_t> before, after;
  for (const std::size_t unit : nodes.in_time()) {
    const std::size_t stroke = nodes.units[unit].front();
    const std::size_t joint = nodes.strokes[stroke].content.joint;
    const auto first = nodes.observations.begin() + static_cast<Index>(nodes.first[stroke]);
    if (std::all_of(first, first + static_cast<Index>(nodes.strokes[stroke].nodes.size()),
                    [](const ChainObservation& seen) { return seen.before_move; })) {
      before.insert(joint);
      continue;
    }
    if (after.empty()) {
      move.joint = joint;
      move.time_s = nodes.begin_s(unit);
    }
    after.insert(joint);
  }
  if (before.size() == 1) move.alone = *before.begin();
  if (after.size() == 1) move.alone = *after.begin();
  return move;
}

double drift_sigma_mm(const ChainFit& fit, const ChainEffects& effects) {
  if (!(effects.steady_mm > 0)) return 0;
  const Index parts = effects.drift_parts, first = first_drift(fit, effects);
  constexpr int kTimes = 64;
  double variance = 0;
  for (int i = 0; i < kTimes; ++i) {
    const DriftTimes times = drift_times((2.0 * i + 1) / kTimes - 1);
    for (Index k = 0; k < parts; ++k)
      for (Index m = 0; m < parts; ++m)
        variance += times(k) * times(m) *
                    fit.covariance.block<3, 3>(first + 3 * k, first + 3 * m).trace() / 3 / kTimes;
  }
  return std::sqrt(std::max(0.0, variance));
}

using Eigen::Index;
using Eigen::MatrixXd;

void set_fitted_axes(ChainEstimate& estimate, const ChainFit& fit, const std::vector<bool>& known,
                     std::size_t targets) {
  const std::size_t joints = known.size();
  estimate.chain = fit.chain;
  // The pose at which each angle as told is home's: the joints turned by what they stand off it.
  Turns zero{};
  std::copy(fit.chain.zero_rad.begin(), fit.chain.zero_rad.end(), zero.begin());
  for (std::size_t j = 0; j < joints; ++j) {
    Turns before{};
    std::copy_n(zero.begin(), j, before.begin());
    const Eigen::Isometry3d moved = fit.chain.displacement(before);
    estimate.chain.axes[j].direction = moved.linear() * fit.chain.axes[j].direction;
    estimate.chain.axes[j].point_mm = moved * fit.chain.axes[j].point_mm;
  }
  const Eigen::Isometry3d at_home = fit.chain.displacement(zero);
  for (Eigen::Vector3d& target : estimate.chain.targets_mm) target = at_home * target;
  estimate.chain.tool = at_home.linear() * fit.chain.tool;
  estimate.chain.zero_rad.clear();
  estimate.locked_rad.clear();
  for (const double zero_rad : fit.chain.zero_rad) estimate.locked_rad.push_back(-zero_rad);
  estimate.chain.sags.clear();  // at home there is none
  estimate.chain.drift_mm.setZero();
  estimate.chain.move.resize(0);
  const ChainParameters parameters{joints, fit.chain.targets_mm.size()};
  const auto tool = static_cast<Index>(6 * joints + 3 * targets);
  const auto rows = tool + (estimate.with_orientation ? 3 : 0);
  MatrixXd by_parameter = MatrixXd::Zero(rows, fit.covariance.rows());
  estimate.axes.assign(joints, std::nullopt);
  for (std::size_t j = 0; j < joints; ++j) {
    if (!known[j]) continue;
    ChainAxis& axis = estimate.chain.axes[j];
    const auto basis = across(axis.direction);
    if (axis.linear) {  // its place: where the target passes, until convention gives it one
      axis.point_mm = estimate.chain.targets_mm.front();
      by_parameter.block<3, 2>(static_cast<Index>(6 * j), parameters.axis(j)) = basis;
      by_parameter.block<3, 3>(static_cast<Index>(6 * j + 3), parameters.target(0)).setIdentity();
      continue;
    }
    const double along = axis.direction.dot(estimate.chain.targets_mm.front() - axis.point_mm);
    const auto row = static_cast<Index>(6 * j);
    by_parameter.block<3, 2>(row, parameters.axis(j)) = basis;
    by_parameter.block<3, 2>(row + 3, parameters.axis(j)) = along * basis;
    by_parameter.block<3, 2>(row + 3, parameters.axis(j) + 2) = basis;
    axis.point_mm += along * axis.direction;
  }
  const Index zeros = parameters.count(estimate.with_orientation);
  for (std::size_t k = 0; k < fit.chain.zero_rad.size(); ++k)
    by_parameter.col(zeros + static_cast<Index>(k)) =
        by_turn_at_home(estimate.chain, k, known, targets, estimate.with_orientation);
  for (std::size_t t = 0; t < targets; ++t)
    by_parameter.block<3, 3>(static_cast<Index>(6 * joints + 3 * t), parameters.target(t)) =
        Eigen::Matrix3d::Identity();
  if (estimate.with_orientation)
    by_parameter.block<3, 3>(tool, parameters.tool()) = Eigen::Matrix3d::Identity();
  const auto of_axes = [&](const MatrixXd& covariance) -> MatrixXd {
    return by_parameter.lazyProduct(MatrixXd(covariance.lazyProduct(by_parameter.transpose())));
  };
  estimate.covariance = of_axes(fit.covariance);
  estimate.parts.clear();
  for (const ChainEstimate::Part& part : fit.parts)
    estimate.parts.push_back({part.cause, of_axes(part.covariance)});
  estimate.chain.targets_mm.resize(targets);
  for (std::size_t j = 0; j < joints; ++j) {
    if (!known[j]) continue;
    const auto row = static_cast<Index>(6 * j);
    const Axis axis{estimate.chain.axes[j].direction, estimate.chain.axes[j].point_mm,
                    estimate.covariance.block<6, 6>(row, row), estimate.chain.axes[j].linear};
    const bool finite = axis.direction.allFinite() && axis.point_mm.allFinite();
    if (finite && axis.direction_sigma_rad() < kWorstDirection_rad) estimate.axes[j] = axis;
  }
}

}  // namespace identify
