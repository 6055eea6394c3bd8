#include "identify/chain/chain_start.hpp"

#include <algorithm>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"

using namespace identify;
using identify::test::Random;
using identify::test::random_chain;

namespace {

/// A joint swept by 30 degrees from so far beyond `home_rad`, the others there.
void sweep(const Chain& chain, std::size_t joint, double home_rad, double beyond_rad,
           std::vector<ChainObservation>& observations) {
  for (int k = 0; k <= 10; ++k) {
    ChainObservation seen;
    seen.joint = joint;
    std::fill_n(seen.turns.begin(), chain.axes.size(), home_rad);
    seen.turns[joint] += beyond_rad + 3 * kDegree * k;
    seen.measured_turn = seen.turns[joint];
    seen.position_mm = chain.displacement(seen.turns) * chain.targets_mm[0];
    observations.push_back(seen);
  }
}

void sweep_all(const Chain& chain, double home_rad, std::vector<ChainObservation>& observations) {
  for (std::size_t joint = 0; joint < chain.axes.size(); ++joint)
    sweep(chain, joint, home_rad, 0, observations);
}

}  // namespace

TEST_CASE("A target is found from sweeps of two homes: those elsewhere run on other circles",
          "[chain_start]") {
  Random random(5);
  const Chain chain = random_chain(6, 1, random);
  std::vector<ChainObservation> observations;
  sweep_all(chain, 0, observations);
  sweep_all(chain, 0.6, observations);
  sweep_all(chain, -0.5, observations);
  const auto targets = starting_targets(chain, observations, 1, true);
  REQUIRE(targets.size() == 1);
  CHECK((targets[0] - chain.targets_mm[0]).norm() < 1e-4);
}

TEST_CASE("Where two circles meet twice the angles know the place, though the other fits better",
          "[chain_start]") {
  Chain truth;
  truth.axes = {{Eigen::Vector3d::UnitZ()}, {Eigen::Vector3d::UnitY()}};
  truth.targets_mm = {{150, 200, 120}};  // they meet at x = -150, too
  std::vector<ChainObservation> seen;
  sweep(truth, 0, 0, 0, seen);
  sweep(truth, 1, 0, -117 * kDegree, seen);  // by x = -150, and far from home
  for (int k = -4; k <= 4; ++k)
    for (int m = -4; m <= 4; ++m) {
      CAPTURE(k, m);
      Chain chain = truth;  // its second axis is off by what a short arc leaves open
      chain.axes[1].point_mm = {0.03 * k, 0, 0.03 * m};
      auto observations = seen;
      const auto targets = starting_targets(chain, observations, 1, true);
      REQUIRE(targets.size() == 1);
      CHECK((targets[0] - truth.targets_mm[0]).norm() < 1);
    }
}
