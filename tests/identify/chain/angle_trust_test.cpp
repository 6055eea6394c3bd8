#include "identify/chain/angle_trust.hpp"

#include <cmath>

#include "identify/chain/chain_fit.hpp"
#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"

using namespace identify;
using identify::test::Measured;
using identify::test::nodes_of;
using identify::test::Random;
using identify::test::random_chain;
using identify::test::sweeps_of;

namespace {

constexpr double kLastDigit = 1e-4;  // mm and degrees
const double kQuantum_rad = kLastDigit * kDegree / std::sqrt(12.0);

ChainNoise quantum(std::size_t joints) {
  return {kLastDigit / std::sqrt(12.0), kQuantum_rad, kQuantum_rad,
          std::vector<double>(joints, kQuantum_rad)};
}

Measured as_controller() {
  Measured how;
  how.position_mm = kLastDigit / std::sqrt(12.0);
  how.locked_rad = how.swept_rad = kQuantum_rad;
  how.samples = 400;
  return how;
}

/// 20 um, and angles of which only the curve and the quantum are wrong.
Measured tracked() {
  Measured how;
  how.position_mm = 0.02;
  how.swept_rad = kQuantum_rad;
  how.from_rad = -45 * kDegree;
  how.to_rad = 45 * kDegree;
  how.samples = 400;
  return how;
}

/// As after a fit with free angles, which leaves the turns where the positions are.
std::vector<AngleEvidence> seen_errors(const Chain& chain,
                                       const std::vector<ChainObservation>& samples) {
  ChainNoise noise;
  noise.position_mm = 0.02;
  noise.swept_rad.assign(chain.axes.size(), kFreeAngle);
  auto nodes = nodes_of(samples, chain.axes.size());
  // At the true chain: the fit's own errors are not what is tested.
  ChainPose pose(chain);
  ChainResidual<3> residual;
  for (ChainObservation& node : nodes.observations)
    for (int k = 0; k < 3; ++k) {
      pose.set(node.target, node.turns, false);
      residual.set(chain, node, pose, noise);
      node.turns[node.joint] += residual.toward;
    }
  return seen_angle_errors(chain, nodes, noise, quantum(chain.axes.size()), {});
}

}  // namespace

TEST_CASE("Angles that are off by white print quanta stand the test", "[angle_trust]") {
  for (const std::uint32_t seed : {31u, 32u, 33u, 34u, 35u}) {
    Random random(seed);
    const Chain chain = random_chain(4, 1, random);
    auto nodes = nodes_of(sweeps_of(chain, as_controller(), random), 4);
    const ChainNoise noise = quantum(4);
    const auto fit = fit_chain(chain, nodes, noise, {}, false);
    std::vector<AngleEvidence> evidence(4);
    test_believed_angles(fit.chain, nodes, noise, noise, evidence);
    for (const AngleEvidence& joint : evidence) {
      CHECK(stands_test(joint));
      // 400 samples: 1 / sqrt(2 * 400) = 3.5 %.
      CHECK(joint.size == Approx(1).epsilon(0.15));
    }
  }
}

TEST_CASE("An angle that is off by a sine of two seconds of arc does not stand the test",
          "[angle_trust]") {
  Random random(36);
  const Chain chain = random_chain(4, 1, random);
  auto samples = sweeps_of(chain, as_controller(), random);
  for (ChainObservation& sample : samples)
    if (sample.joint == 1) {
      sample.turns[1] += 2 * kArcsec * std::sin(3 * sample.turns[1] + 0.7);
      sample.measured_turn = sample.turns[1];
    }
  const ChainNoise noise = quantum(4);
  auto nodes = nodes_of(samples, 4);
  const auto fit = fit_chain(chain, nodes, noise, {}, false);
  std::vector<AngleEvidence> evidence(4);
  test_believed_angles(fit.chain, nodes, noise, noise, evidence);
  CHECK_FALSE(stands_test(evidence[1]));
}

TEST_CASE("An even motion printed in coarse steps is no error, wherever within a step home is",
          "[angle_trust]") {
  constexpr double kStep = 0.1 * kDegree;
  const ChainNoise printed{kLastDigit, kQuantum_rad, kQuantum_rad,
                           std::vector<double>(4, kStep / std::sqrt(12.0))};
  Measured how;
  how.from_rad = -15 * kDegree;
  how.to_rad = 15 * kDegree;
  how.samples = 300;  // 1.0033 steps from one to the next: one tooth of the saw
  Random random(43);
  const Chain chain = random_chain(4, 1, random);
  const auto samples = sweeps_of(chain, how, random);
  const auto tested = [&](double home_rad, double error_rad) {
    auto told = samples;
    for (ChainObservation& sample : told) {
      const double turn = sample.turns[sample.joint];
      sample.turns[sample.joint] = sample.measured_turn =
          kStep * std::round((turn + home_rad + error_rad * std::sin(6 * turn)) / kStep);
    }
    std::vector<AngleEvidence> evidence(4);
    test_believed_angles(chain, nodes_of(told, 4), printed, printed, evidence);
    return evidence;
  };
  for (const double home : {-0.49, -0.3, 0.0, 0.3, 0.49}) {
    for (const AngleEvidence& joint : tested(home * kStep, 0)) CHECK(stands_test(joint));
    for (const AngleEvidence& joint : tested(home * kStep, kStep)) CHECK_FALSE(stands_test(joint));
  }
}

TEST_CASE("Joints whose angles are not used are not tested", "[angle_trust]") {
  Random random(37);
  const Chain chain = random_chain(2, 1, random);
  const auto nodes = nodes_of(sweeps_of(chain, as_controller(), random), 2);
  ChainNoise noise = quantum(2);
  noise.swept_rad[0] = kFreeAngle;
  std::vector<AngleEvidence> evidence(2);
  test_believed_angles(chain, nodes, noise, quantum(2), evidence);
  CHECK(evidence[0].size == 0);
  CHECK(evidence[1].size > 0);
}

TEST_CASE("A joint that was not swept is told from one without angles", "[angle_trust]") {
  Random random(36);
  const Chain chain = random_chain(4, 1, random);
  auto samples = sweeps_of(chain, tracked(), random);
  std::erase_if(samples, [](const ChainObservation& sample) { return sample.joint == 2; });
  const auto evidence = seen_errors(chain, samples);
  CHECK(evidence[2].samples == 0);
  CHECK(evidence[2].reason == "not swept");
  CHECK(evidence[1].samples > 0);
}

TEST_CASE("A smooth error of an angle is seen as the curve that it is", "[angle_trust]") {
  Random random(38);
  const Chain chain = random_chain(3, 1, random);
  const auto error = [](double turn) {
    return 20 * kArcsec + 1e-4 * turn + 60 * kArcsec * std::sin(turn + 0.7);
  };
  auto samples = sweeps_of(chain, tracked(), random);
  for (ChainObservation& sample : samples)
    if (sample.joint == 1) sample.measured_turn += error(sample.turns[1]);
  const auto found = seen_errors(chain, samples);
  CHECK(found[1].trust == AngleTrust::smooth);
  const double noise = found[1].remainder_rms_rad;
  CHECK(noise == Approx(found[1].expected_rms_rad).epsilon(0.15));
  // Six coefficients from 400 samples: each value of the curve to about sqrt(6 / 400) of a sample's
  // scatter on average, at the ends of the range two to three times that.
  for (double turn = -45; turn <= 45; turn += 5) {
    CAPTURE(turn);
    CHECK(std::abs(found[1].curve_at(turn * kDegree) - error(turn * kDegree)) <
          4 * 2.5 * std::sqrt(6.0 / 400) * noise);
  }
  CHECK(found[1].error_rms_rad > 4 * found[1].remainder_rms_rad);
  CHECK(found[1].backlash_rad == 0);
}

TEST_CASE("A backlash is seen with its uncertainty", "[angle_trust]") {
  Random random(39);
  const Chain chain = random_chain(3, 1, random);
  constexpr double kBacklash = 5 * kArcsec;
  double squares = 0;
  constexpr int kRuns = 20;
  for (int run = 0; run < kRuns; ++run) {
    Measured how = tracked();
    how.samples = 150;
    auto samples = sweeps_of(chain, how, random);
    std::swap(how.from_rad, how.to_rad);
    for (ChainObservation sample : sweeps_of(chain, how, random)) {
      sample.falling = true;
      sample.sweep += chain.axes.size();
      sample.measured_turn += kBacklash;
      samples.push_back(sample);
    }
    const auto found = seen_errors(chain, samples);
    for (const AngleEvidence& joint : found) {
      REQUIRE(joint.backlash_sigma_rad > 0);
      const double off = (joint.backlash_rad - kBacklash) / joint.backlash_sigma_rad;
      CHECK(std::abs(off) < 4.5);
      squares += off * off;
    }
  }
  // The mean of 60 squares scatters by sqrt(2 / 60) = 0.18.
  CHECK(squares / (3 * kRuns) == Approx(1).margin(0.7));
}
