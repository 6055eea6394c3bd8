#include "identify/chain/chain_start.hpp"

#include <algorithm>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"

using namespace identify;
using identify::test::Random;
using identify::test::random_chain;

namespace {

/// Each joint swept by 30 degrees, the others at `home_rad`.
void sweep_all(const Chain& chain, double home_rad, std::vector<ChainObservation>& observations) {
  for (std::size_t joint = 0; joint < chain.axes.size(); ++joint)
    for (int k = 0; k <= 10; ++k) {
      ChainObservation seen;
      seen.joint = joint;
      std::fill_n(seen.turns.begin(), chain.axes.size(), home_rad);
      seen.turns[joint] += 3 * kDegree * k;
      seen.measured_turn = seen.turns[joint];
      seen.position_mm = chain.displacement(seen.turns) * chain.targets_mm[0];
      observations.push_back(seen);
    }
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
