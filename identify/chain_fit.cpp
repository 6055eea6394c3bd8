#include "identify/chain_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identify/chain_problem.hpp"
#include "identify/information.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A step this small in standard uncertainties is none.
constexpr double kSmallStep = 1e-7;
/// So close the cost no longer tells: with random effects it is not quite that of the equations.
constexpr double kCloseStep = 1e-2;

template <int Size>
ChainFit fit(const Chain& start, ChainNodes& nodes, const ChainNoise& noise,
             const ChainEffects& effects, int most_iterations) {
  ChainProblem<Size> problem(start, nodes, noise, effects);
  ChainFit result;
  result.chain = start;
  result.chain.zero_rad.resize(effects.zero_rad.size());
  Summary& summary = result.summary;
  summary.ending = "no convergence";
  double previous = std::numeric_limits<double>::infinity();
  double damping = 0;
  NormalEquations equations = problem.linearised(result.chain);
  while (true) {
    problem.follow();
    const Information information(equations.normal);
    const VectorXd step = information.step(equations.gradient, 0);
    result.covariance = information.covariance();
    summary.cost = equations.cost;
    summary.condition = information.condition();
    summary.undetermined = information.undetermined();
    summary.last_step = std::sqrt(std::max(0.0, step.dot(equations.gradient)));
    if (!step.allFinite() || !std::isfinite(equations.cost)) {
      summary.ending = "numbers beyond all bounds";
      break;
    }
    if (summary.last_step < kSmallStep) {
      summary.converged = true;
      summary.ending = "converged";
      break;
    }
    // So close to the end the cost is only rounding: the steps alone tell, as long as they shrink.
    const bool close = summary.last_step < kCloseStep;
    if (close && summary.last_step > previous / 2) {
      summary.converged = true;
      summary.ending = "converged to rounding";
      break;
    }
    if (summary.iterations == most_iterations) break;
    previous = summary.last_step;
    ++summary.iterations;
    constexpr double kFirstDamping = 1e-6;
    constexpr double kMostDamping = 1e6;
    const auto better = [&](const NormalEquations& there) {
      return there.cost <= equations.cost || (close && std::isfinite(there.cost));
    };
    const auto after = [&](const VectorXd& change) {
      Chain there = moved(result.chain, change.head(ChainProblem<Size>::count(result.chain)));
      for (std::size_t j = 0; j < there.zero_rad.size(); ++j)
        there.zero_rad[j] +=
            change(ChainProblem<Size>::count(result.chain) + static_cast<Index>(j));
      return there;
    };
    Chain next = after(information.step(equations.gradient, damping));
    NormalEquations there = problem.linearised(next);
    while (!better(there) && damping < kMostDamping) {
      damping = std::max(kFirstDamping, 10 * damping);
      next = after(information.step(equations.gradient, damping));
      there = problem.linearised(next);
    }
    if (damping >= kMostDamping) {
      summary.ending = "no better place found";
      break;
    }
    damping = damping > kFirstDamping ? damping / 10 : 0;
    result.chain = std::move(next);
    equations = std::move(there);
  }
  return result;
}

}  // namespace

ChainFit fit_chain(const Chain& start, ChainNodes& nodes, const ChainNoise& noise,
                   const ChainEffects& effects, bool with_orientation, int most_iterations) {
  return with_orientation ? fit<6>(start, nodes, noise, effects, most_iterations)
                          : fit<3>(start, nodes, noise, effects, most_iterations);
}

}  // namespace identify
