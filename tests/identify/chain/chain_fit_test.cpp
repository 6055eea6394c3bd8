#include "identify/chain/chain_fit.hpp"

#include <cmath>

#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"

using namespace identify;
using Eigen::Index;
using Eigen::VectorXd;
using identify::test::difference;
using identify::test::Measured;
using identify::test::nodes_of;
using identify::test::noise_of;
using identify::test::Random;
using identify::test::random_chain;
using identify::test::sweeps_of;

namespace {

/// What the noise is taken to be where there is none.
Measured stated(double share = 1) {
  Measured how;
  how.position_mm = 0.02 * share;
  how.orientation_rad = 2e-5 * share;
  how.locked_rad = 1e-6 * share;
  how.swept_rad = 2e-5 * share;
  return how;
}

/// Directions off by a milliradian, points and targets by a millimetre.
Chain perturbed(const Chain& chain, bool tool, Random& random) {
  const ChainParameters parameters{chain.axes.size(), chain.targets_mm.size()};
  VectorXd change(parameters.count(tool));
  for (Index p = 0; p < change.size(); ++p) {
    const bool angle = p >= parameters.tool() || (p < parameters.target(0) && p % 4 < 2);
    change(p) = random.normal(angle ? 1e-3 : 1);
  }
  return moved(chain, change);
}

/// Without errors but with a wobble, so that the locked joints matter: its square, which the nodes'
/// means do not hold, moves the target by 1e-10 mm.
std::vector<ChainObservation> exact(const Chain& chain, Random& random) {
  Measured how = stated();
  how.locked_rad = 3e-8;
  auto samples = sweeps_of(chain, how, random);
  for (ChainObservation& sample : samples) {
    const auto pose = chain.displacement(sample.turns);
    sample.position_mm = pose * chain.targets_mm[sample.target];
    sample.orientation = pose.linear() * chain.tool;
  }
  return samples;
}

}  // namespace

TEST_CASE("The exact chain comes back from a start that is off", "[chain_fit]") {
  const bool with_orientation = GENERATE(false, true);
  const bool free = GENERATE(false, true);
  const std::size_t targets = GENERATE(std::size_t{1}, std::size_t{2});
  CAPTURE(with_orientation, free, targets);
  Random random(3);
  const Chain chain = random_chain(6, targets, random);
  auto nodes = nodes_of(exact(chain, random), 6);
  const auto fit = fit_chain(perturbed(chain, with_orientation, random), nodes,
                             noise_of(chain, stated(), free), {}, with_orientation);
  CHECK(fit.summary.converged);
  CHECK(fit.summary.undetermined == 0);
  VectorXd left = difference(chain, fit.chain);
  if (!with_orientation) left.tail<3>().setZero();  // the tool stays where it was
  // Steps end at 1e-7 of uncertainties below 0.1 mm, and converge quadratically before.
  CHECK(left.cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("With one joint whose angles are free, the target along the circle is not determined",
          "[chain_fit]") {
  Random random(4);
  const Chain chain = random_chain(1, 1, random);
  auto nodes = nodes_of(exact(chain, random), 1);
  const auto fit =
      fit_chain(perturbed(chain, false, random), nodes, noise_of(chain, stated(), true), {}, false);
  CHECK(fit.summary.converged);
  CHECK(fit.summary.undetermined == 1);
  const VectorXd left = difference(chain, fit.chain);
  CHECK(left.head<4>().cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("The stated covariance is the scatter of fits over many campaigns", "[chain_fit]") {
  const bool free = GENERATE(false, true);
  const bool with_orientation = !free;
  CAPTURE(free);
  Random random(5);
  const Chain chain = random_chain(3, 1, random);
  Measured how = stated();
  how.samples = 20;
  const ChainNoise noise = noise_of(chain, how, free);
  constexpr int kRuns = 200;
  const ChainParameters parameters{3, 1};
  const Index count = parameters.count(with_orientation);
  VectorXd squares = VectorXd::Zero(count);
  double distance = 0;
  for (int run = 0; run < kRuns; ++run) {
    auto nodes = nodes_of(sweeps_of(chain, how, random), 3);
    const auto fit = fit_chain(chain, nodes, noise, {}, with_orientation);
    REQUIRE(fit.summary.converged);
    const VectorXd error = difference(chain, fit.chain).head(count);
    squares += error.cwiseAbs2().cwiseQuotient(fit.covariance.diagonal());
    distance += error.dot(fit.covariance.llt().solve(error));
  }
  // Each mean of 200 squares scatters by sqrt(2 / 200) = 0.1 about 1, of the chi squared of all by
  // that over the root of their number.
  CHECK((squares / kRuns).minCoeff() > 1 - 0.4);
  CHECK((squares / kRuns).maxCoeff() < 1 + 0.4);
  CHECK(distance / kRuns / static_cast<double>(count) ==
        Approx(1).margin(0.4 / std::sqrt(static_cast<double>(count))));
}

TEST_CASE("Without iterations the step that would be made is stated at the start", "[chain_fit]") {
  Random random(6);
  const Chain chain = random_chain(4, 1, random);
  auto nodes = nodes_of(exact(chain, random), 4);
  Chain start = chain;
  start.targets_mm[0].x() += 0.001;
  const auto noise = noise_of(chain, stated(), false);
  const auto fit = fit_chain(start, nodes, noise, {}, false, 0);
  CHECK_FALSE(fit.summary.converged);
  CHECK(fit.summary.iterations == 0);
  CHECK(fit.chain.targets_mm[0] == start.targets_mm[0]);
  const VectorXd error = difference(start, chain).head(fit.covariance.rows());
  CHECK(fit.summary.last_step ==
        Approx(std::sqrt(error.dot(fit.covariance.llt().solve(error)))).epsilon(1e-3));
}

TEST_CASE("Numbers beyond all bounds end the fit", "[chain_fit]") {
  Random random(7);
  const Chain chain = random_chain(3, 1, random);
  auto nodes = nodes_of(exact(chain, random), 3);
  nodes.observations[21].position_mm.setConstant(1e300);
  CHECK_FALSE(
      fit_chain(chain, nodes, noise_of(chain, stated(), true), {}, false).summary.converged);
}

TEST_CASE("With random effects the stated covariance is the scatter, and the samples' is too small",
          "[chain_fit]") {
  Random random(8);
  const Chain chain = random_chain(3, 1, random);
  Measured how = stated();
  how.samples = 60;
  how.orientation_rad = how.locked_rad = how.swept_rad = 0;
  const ChainNoise noise = noise_of(chain, how, true);
  ChainEffects effects;
  effects.home_rad = 1e-4;
  effects.drift_mm = 0.03;
  const ChainParameters parameters{3, 1};
  VectorXd with = VectorXd::Zero(parameters.count(false)), without = with;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    auto samples = sweeps_of(chain, how, random);
    std::vector<Turns> off(3);
    std::vector<Eigen::Vector3d> drift, slope;
    for (Turns& turns : off) {
      for (std::size_t k = 0; k < 3; ++k) turns[k] = random.normal(effects.home_rad);
      drift.push_back(random.vector(effects.drift_mm));
      // These sweeps tell no time from one to the next: all that can be is taken for granted.
      slope.push_back(random.vector(std::sqrt(0.3) * effects.drift_mm));
    }
    for (ChainObservation& seen : samples) {
      Turns there = seen.turns;
      for (std::size_t k = 0; k < 3; ++k)
        if (k != seen.joint) there[k] += off[seen.sweep][k];
      seen.position_mm += chain.target_mm(0, there) - chain.target_mm(0, seen.turns) +
                          drift[seen.sweep] +
                          seen.turns[seen.joint] / how.to_rad * slope[seen.sweep];
    }
    auto nodes = nodes_of(samples, 3);
    const auto scatter = [&](const ChainEffects& known) -> VectorXd {
      const auto fit = fit_chain(chain, nodes, noise, known, false);
      CAPTURE(fit.summary.ending, fit.summary.iterations, fit.summary.last_step, fit.summary.cost);
      REQUIRE(fit.summary.converged);
      const VectorXd error = difference(chain, fit.chain).head(with.size());
      return error.cwiseAbs2().cwiseQuotient(fit.covariance.diagonal().head(with.size()));
    };
    with += scatter(effects) / kRuns;
    without += scatter({}) / kRuns;
  }
  // Each scatters by sqrt(2 / 200) = 0.1 about 1.
  CHECK(with.minCoeff() > 1 - 0.4);
  CHECK(with.maxCoeff() < 1 + 0.4);
  CHECK(without.maxCoeff() > 10);
}
