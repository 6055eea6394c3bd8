#include "identify/chain/chain_fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "identify/chain/chain_problem.hpp"
#include "identify/chain/information.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// A step this small in standard uncertainties is none.
constexpr double kSmallStep = 1e-7;
/// So close the end may be rounding's.
constexpr double kCloseStep = 1e-2;
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
        summary.converged = here_.to_go < kCloseStep;
        summary.ending = summary.converged ? "converged to rounding" : "no better place found";
        break;
      }
    }
    summary.cost = here_.equations.cost;
    summary.condition = here_.information.condition();
    summary.undetermined = here_.information.undetermined();
    summary.last_step = here_.to_go;
    return {std::move(here_.chain), here_.information.covariance(), {}, summary};
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
    if (summary.iterations == most_iterations) return "no convergence";
    return std::nullopt;
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

}  // namespace identify
