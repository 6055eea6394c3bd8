#include "identify/chain/chain_noise.hpp"

#include <cmath>

#include "identify/chain/chain_fit.hpp"
#include "identify/sweeps/stroke_correlation.hpp"
#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"

using namespace identify;
using Eigen::Vector3d;
using identify::test::Measured;
using identify::test::nodes_of;
using identify::test::noise_of;
using identify::test::Random;
using identify::test::random_chain;
using identify::test::sweeps_of;

namespace {

Measured device() {
  Measured how;
  how.position_mm = 0.02;
  how.orientation_rad = 4e-5;
  how.locked_rad = 6e-5;
  how.swept_rad = 1e-4;
  how.samples = 400;
  return how;
}

ChainNoise floor_of(const Chain& chain) {
  return {1e-3, 1e-6, 0, std::vector<double>(chain.axes.size(), 1e-6)};
}

/// Where Fisher scoring ends, from noise that is off by half.
ChainNoise settled(const Chain& chain, const ChainNodes& nodes, ChainNoise noise,
                   bool with_orientation) {
  noise.position_mm *= 1.5;
  noise.orientation_rad *= 1.5;
  noise.locked_rad *= 0.5;
  for (double& sigma : noise.swept_rad) sigma *= 0.5;
  for (int k = 0; k < 8; ++k)
    noise = estimate_noise(chain, nodes, noise, floor_of(chain), with_orientation);
  return noise;
}

/// Position errors that remember the last one's share `memory`.
std::vector<ChainObservation> correlated(const Chain& chain, double memory, int samples,
                                         Random& random) {
  Measured how;
  how.samples = samples;
  auto all = sweeps_of(chain, how, random);
  Vector3d error = Vector3d::Zero();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool first = i == 0 || all[i].sweep != all[i - 1].sweep;
    const double old = first ? 0 : memory;
    error = old * error + std::sqrt(1 - old * old) * random.vector(0.02);
    all[i].position_mm += error;
  }
  return all;
}

}  // namespace

TEST_CASE("The noise that was put in comes back, component by component", "[chain_noise]") {
  const bool with_orientation = GENERATE(false, true);
  CAPTURE(with_orientation);
  Random random(21);
  const Chain chain = random_chain(4, 1, random);
  const Measured how = device();
  auto nodes = nodes_of(sweeps_of(chain, how, random), 4);
  const ChainNoise noise = noise_of(chain, how, false);
  const auto fit = fit_chain(chain, nodes, noise, {}, with_orientation);
  const ChainNoise found = settled(fit.chain, nodes, noise, with_orientation);
  // A standard deviation from n numbers is uncertain by 1 / sqrt(2 n). Positions: a third of 4800
  // coordinates is theirs alone (1600: 2 %); locked joints: about as many (2 %); each sweeping
  // joint has 400 samples (4 %), its angle's share of the scatter along is more than half (8 %).
  // Four times that.
  CHECK(found.position_mm == Approx(how.position_mm).epsilon(0.08));
  CHECK(found.locked_rad == Approx(how.locked_rad).epsilon(0.08));
  for (const double swept : found.swept_rad) CHECK(swept == Approx(how.swept_rad).epsilon(0.32));
  if (with_orientation)
    CHECK(found.orientation_rad == Approx(how.orientation_rad).epsilon(0.08));
  else
    CHECK(found.orientation_rad == floor_of(chain).orientation_rad);
  // By the noise that was found the residuals are as they should: 4800 of them, 1 %.
  CHECK(misfit(fit.chain, nodes, found, with_orientation) == Approx(1).margin(0.05));
}

TEST_CASE("A component that is not there stays at its floor", "[chain_noise]") {
  Random random(22);
  const Chain chain = random_chain(4, 1, random);
  Measured how;
  how.position_mm = 0.02;
  how.samples = 400;
  const auto nodes = nodes_of(sweeps_of(chain, how, random), 4);
  ChainNoise noise = noise_of(chain, device(), false);
  ChainNoise floor = floor_of(chain);
  floor.locked_rad = 1e-7;
  for (int k = 0; k < 8; ++k) {
    noise = estimate_noise(chain, nodes, noise, floor, false);
    CHECK(noise.position_mm >= floor.position_mm);
    CHECK(noise.locked_rad >= floor.locked_rad);
    for (std::size_t j = 0; j < 4; ++j) CHECK(noise.swept_rad[j] >= floor.swept_rad[j]);
  }
  // 1600 samples tell angles from positions to about their sigma over 500 mm and over the fourth
  // root of the number of samples: 0.02 / 500 / 6 = 7e-6.
  CHECK(noise.locked_rad < 3e-5);
  CHECK(noise.position_mm == Approx(0.02).epsilon(0.08));
  floor.position_mm = 0.05;
  CHECK(estimate_noise(chain, nodes, noise, floor, false).position_mm == 0.05);
}

TEST_CASE("An angle that is not used has no noise to estimate", "[chain_noise]") {
  Random random(23);
  const Chain chain = random_chain(3, 1, random);
  Measured how = device();
  how.locked_rad = 0;
  auto nodes = nodes_of(sweeps_of(chain, how, random), 3);
  ChainNoise noise = noise_of(chain, how, true);
  const auto fit = fit_chain(chain, nodes, noise, {}, false);
  noise.position_mm = 1;
  for (int k = 0; k < 4; ++k)
    noise = estimate_noise(fit.chain, nodes, noise, floor_of(chain), false);
  // 2400 coordinates: 1.4 %.
  CHECK(noise.position_mm == Approx(how.position_mm).epsilon(0.06));
  for (const double swept : noise.swept_rad) CHECK(std::isinf(swept));
}

TEST_CASE("Correlated samples are worth fewer independent ones", "[chain_noise]") {
  Random random(26);
  const Chain chain = random_chain(3, 1, random);
  const auto found = [&](double memory) {
    return correlation_of(nodes_of(correlated(chain, memory, 1500, random), 3, false).strokes);
  };
  CHECK(found(0) == 1);
  // (1 + 0.9) / (1 - 0.9) = 19 from 4500 samples, of which some 240 are independent: the largest
  // blocks decide, and there are few of them.
  CHECK(found(0.9) == Approx(19).epsilon(0.5));
}

TEST_CASE("What a stroke as a whole is off by is no noise", "[chain_noise]") {
  Random random(27);
  const Chain chain = random_chain(3, 1, random);
  Measured how = device();
  how.locked_rad = how.swept_rad = 0;
  auto samples = sweeps_of(chain, how, random);
  const auto bend = [](double turn) { return 0.3 * std::cos(2 * turn) + 0.2 * turn; };
  for (ChainObservation& seen : samples)
    if (seen.joint == 1) seen.position_mm.array() += bend(seen.turns[1]);
  const auto nodes = nodes_of(samples, 3);
  ChainNoise noise = noise_of(chain, how, true);
  for (int k = 0; k < 4; ++k) noise = estimate_noise(chain, nodes, noise, floor_of(chain), false);
  CHECK(noise.position_mm == Approx(how.position_mm).epsilon(0.06));
}
