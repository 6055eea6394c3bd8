#include "identify/chain_noise.hpp"

#include <algorithm>

#include "identify/chain_fit.hpp"
#include "random_chain.hpp"
#include "tests/catch.hpp"

using namespace identify;
using Eigen::Vector3d;
using identify::test::Measured;
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
ChainNoise settled(const Chain& chain, const std::vector<ChainObservation>& samples,
                   ChainNoise noise, bool with_orientation) {
  noise.position_mm *= 1.5;
  noise.orientation_rad *= 1.5;
  noise.locked_rad *= 0.5;
  for (double& sigma : noise.swept_rad) sigma *= 0.5;
  for (int k = 0; k < 8; ++k)
    noise = estimate_noise(chain, samples, noise, floor_of(chain), with_orientation);
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

TEST_CASE("The noise that was put in comes back, component by component") {
  const bool with_orientation = GENERATE(false, true);
  CAPTURE(with_orientation);
  Random random(21);
  const Chain chain = random_chain(4, 1, random);
  const Measured how = device();
  auto samples = sweeps_of(chain, how, random);
  const ChainNoise noise = noise_of(chain, how, false);
  const auto fit = fit_chain(chain, samples, noise, with_orientation);
  const ChainNoise found = settled(fit.chain, samples, noise, with_orientation);
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
  CHECK(misfit(fit.chain, samples, found, with_orientation) == Approx(1).margin(0.05));
}

TEST_CASE("A component that is not there stays at its floor") {
  Random random(22);
  const Chain chain = random_chain(4, 1, random);
  Measured how;
  how.position_mm = 0.02;
  how.samples = 400;
  const auto samples = sweeps_of(chain, how, random);
  ChainNoise noise = noise_of(chain, device(), false);
  ChainNoise floor = floor_of(chain);
  floor.locked_rad = 1e-7;
  for (int k = 0; k < 8; ++k) {
    noise = estimate_noise(chain, samples, noise, floor, false);
    CHECK(noise.position_mm >= floor.position_mm);
    CHECK(noise.locked_rad >= floor.locked_rad);
    for (std::size_t j = 0; j < 4; ++j) CHECK(noise.swept_rad[j] >= floor.swept_rad[j]);
  }
  // 1600 samples tell angles from positions to about their sigma over 500 mm and over the fourth
  // root of the number of samples: 0.02 / 500 / 6 = 7e-6.
  CHECK(noise.locked_rad < 3e-5);
  CHECK(noise.position_mm == Approx(0.02).epsilon(0.08));
  floor.position_mm = 0.05;
  CHECK(estimate_noise(chain, samples, noise, floor, false).position_mm == 0.05);
}

TEST_CASE("An angle that is not used has no noise to estimate") {
  Random random(23);
  const Chain chain = random_chain(3, 1, random);
  Measured how = device();
  how.locked_rad = 0;
  auto samples = sweeps_of(chain, how, random);
  ChainNoise noise = noise_of(chain, how, true);
  const auto fit = fit_chain(chain, samples, noise, false);
  noise.position_mm = 1;
  for (int k = 0; k < 4; ++k)
    noise = estimate_noise(fit.chain, samples, noise, floor_of(chain), false);
  // 2400 coordinates: 1.4 %.
  CHECK(noise.position_mm == Approx(how.position_mm).epsilon(0.06));
  for (const double swept : noise.swept_rad) CHECK(std::isinf(swept));
}

TEST_CASE("Samples five millimetres off lose their weight, good ones keep theirs") {
  const bool free = GENERATE(false, true);
  CAPTURE(free);
  Random random(24);
  const Chain chain = random_chain(4, 1, random);
  Measured how = device();
  how.locked_rad = 0;
  how.swept_rad = 2e-5;
  auto samples = sweeps_of(chain, how, random);
  const ChainNoise noise = noise_of(chain, how, free);
  std::vector<std::size_t> off;
  ChainPose pose(chain);
  for (std::size_t i = 0; i < samples.size(); i += 20) {
    // Not along the circle, where free angles follow.
    pose.set(samples[i].target, samples[i].turns, false);
    const Vector3d along = pose.by_turn[samples[i].joint].head<3>().normalized();
    samples[i].position_mm += 5 * along.cross(random.direction()).normalized();
    off.push_back(i);
  }
  reweight(chain, samples, noise, false);
  for (const std::size_t i : off) CHECK(samples[i].weight == 0);
  const auto full = std::count_if(samples.begin(), samples.end(),
                                  [](const ChainObservation& seen) { return seen.weight == 1; });
  // One in some thousand of 1520 good ones is further off than usual.
  CHECK(static_cast<std::size_t>(full) + off.size() >= samples.size() - 10);
}

TEST_CASE("Half of the samples far off don't change the robust sigma much") {
  Random random(25);
  const Chain chain = random_chain(4, 1, random);
  Measured how = device();
  how.locked_rad = 0;
  auto samples = sweeps_of(chain, how, random);
  const ChainNoise noise = noise_of(chain, how, true);
  // The largest of four medians of 400: 1.2 / sqrt(2 * 400) = 4 % each.
  CHECK(robust_position_sigma(chain, samples, noise) == Approx(0.02).epsilon(0.2));
  for (std::size_t i = 0; i < samples.size(); i += 4) samples[i].position_mm += random.vector(20);
  // The median is the good ones' two-thirds quantile then: 2.2 in chi squared for 1.39.
  CHECK(robust_position_sigma(chain, samples, noise) == Approx(0.026).epsilon(0.2));
}

TEST_CASE("Correlated samples are worth fewer independent ones") {
  Random random(26);
  const Chain chain = random_chain(3, 1, random);
  ChainNoise noise;
  noise.position_mm = 0.02;
  noise.swept_rad.assign(3, kFreeAngle);
  const auto found = [&](double memory) {
    auto samples = correlated(chain, memory, 1500, random);
    const auto fit = fit_chain(chain, samples, noise, false);
    return samples_per_independent(fit.chain, samples, noise, false);
  };
  // Over 2 * 4500 numbers; summing the correlations of lags up to five times the result T has an
  // error of T sqrt(2 (2 * 5 T + 1) / 9000) (Sokal): 5 % for white noise. For T = (1 + 0.9) /
  // (1 - 0.9) = 19 it is 4, and the 15 parameters' share of slow changes is put back only on
  // average: within half.
  CHECK(found(0) == Approx(1).margin(0.2));
  CHECK(found(0.9) == Approx(19).epsilon(0.5));
}
