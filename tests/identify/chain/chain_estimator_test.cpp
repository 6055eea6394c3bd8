#include "identify/chain/chain_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/simulated_campaign.hpp"

using namespace identify;
using Eigen::Vector3d;
using identify::test::for_kr5;
using identify::test::kPrinted;
using identify::test::segment;

namespace {

std::vector<Sample> as_printed(std::vector<Sample> samples) {
  for (Sample& sample : samples) {
    for (Eigen::Index k = 0; k < 3; ++k)
      sample.position_mm(k) = test::printed(sample.position_mm(k));
    for (std::size_t k = 0; k < sample.joints; ++k)
      sample.angles_rad[k] = test::printed(sample.angles_rad[k] / kDegree) * kDegree;
  }
  return samples;
}

/// Each number of the table against the specified one, in its standard uncertainties.
void check_table(const Identification& found, double sigmas) {
  REQUIRE(found.dh.size() == found.specified.size());
  for (std::size_t i = 0; i + 1 < found.dh.size(); ++i) {
    CAPTURE(i);
    const auto check = [&](const DhNumber& number, double expected) {
      if (number.knowledge != Knowledge::identified) return;
      CHECK(number.sigma > 0);
      CHECK(std::abs(wrapped(number.value - expected)) < sigmas * number.sigma);
    };
    const DhRow& row = found.specified[i];
    const auto length = [&](const DhNumber& number, double expected) {
      if (number.knowledge == Knowledge::identified)
        CHECK(std::abs(number.value - expected) < sigmas * number.sigma);
    };
    length(found.dh[i].b_mm, row.b_mm);
    check(found.dh[i].theta_rad, row.theta_rad);
    length(found.dh[i].a_mm, row.a_mm);
    check(found.dh[i].alpha_rad, row.alpha_rad);
  }
}

bool says(const Identification& found, const std::string& code) {
  return std::any_of(found.warnings.begin(), found.warnings.end(),
                     [&](const Warning& warning) { return warning.code == code; });
}

/// Whatever happened, nothing in a result is other than a number.
void check_finite(const Identification& found) {
  CHECK(found.dh.size() == found.joints.size());
  for (const auto* table : {&found.dh, &found.circle_dh})
    for (const DhEstimate& row : *table)
      for (const auto* number :
           {&row.b_mm, &row.theta_rad, &row.a_mm, &row.alpha_rad, &row.beta_rad}) {
        CHECK(std::isfinite(number->value));
        CHECK(std::isfinite(number->sigma));
      }
  for (const JointResult& joint : found.joints)
    if (joint.axis) {
      CHECK(joint.axis->direction.allFinite());
      CHECK(joint.axis->point_mm.allFinite());
      CHECK(joint.axis->covariance.allFinite());
    }
  CHECK((found.status == Status::complete || !found.reason.empty()));
}

Sweep sweep_of(std::vector<Sample> samples, std::size_t joint = 0) {
  Sweep sweep;
  sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
  sweep.joint = joint;
  sweep.direction = 1;
  sweep.range_rad = 1;
  return sweep;
}

Sample at(const Vector3d& position, double time_s = 0) {
  Sample sample;
  sample.position_mm = position;
  sample.time_s = time_s;
  sample.has_position = true;
  return sample;
}

/// A quarter of a circle about `axis` through the origin, `radius` off, with noise.
std::vector<Sample> noisy_arc(const Vector3d& axis, const Vector3d& start, int count, double noise,
                              double end_rad = 1.5) {
  std::mt19937 random(3);
  std::normal_distribution<> normal;
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    const Vector3d point =
        Eigen::AngleAxisd(end_rad * i / std::max(1, count - 1), axis.normalized()) * start;
    samples.push_back(
        at(point + noise * Vector3d(normal(random), normal(random), normal(random)), 0.004 * i));
  }
  return samples;
}

}  // namespace

TEST_CASE("angles of a controller are believed, and the wobble is no noise", "[chain_estimator]") {
  test::Campaign campaign(test::kr5_arc(), {0.0005, 0, 2});
  campaign.sweep_all_30();
  const auto found = identify::identify(
      segment(as_printed(campaign.samples()), {kPrinted, kPrinted * kDegree}), for_kr5(kPrinted));
  REQUIRE(found.estimator == Estimator::chain);
  CHECK(found.chain->summary.converged);
  CHECK(found.chain->summary.undetermined == 0);
  for (const auto& evidence : found.chain->angles) CHECK(evidence.trust == AngleTrust::trusted);
  // Rounding to four decimals scatters by 1e-4 / sqrt(12).
  CHECK(found.chain->noise.locked_rad ==
        Approx(kPrinted * kDegree / std::sqrt(12.0)).epsilon(0.05));
  CHECK(found.dh[3].a_mm.sigma < 0.001);
  CHECK(found.dh[3].a_mm.sigma < found.circle_dh[3].a_mm.sigma / 20);
  check_table(found, 4.5);
}

TEST_CASE("a tracker's points are fitted without angles, and their error is told",
          "[chain_estimator]") {
  test::Campaign campaign(test::kr5_arc(), {0, 0.02, 2});
  campaign.sweep_all_90();
  auto samples = campaign.samples();
  const double arcsec = kDegree / 3600;
  for (Sample& sample : samples)
    sample.angles_rad[1] += 100 * arcsec * std::sin(sample.angles_rad[1]);
  auto known = for_kr5();
  const auto found = identify::identify(segment(samples), known);
  REQUIRE(found.estimator == Estimator::chain);
  CHECK(found.chain->noise.position_mm == Approx(0.02).epsilon(0.05));
  for (const auto& evidence : found.chain->angles) CHECK(evidence.trust == AngleTrust::smooth);
  const AngleEvidence& sagging = found.chain->angles[1];
  // From home, -90 degrees, to -60 the error goes from -100 to -87 arcsec: +13 as home sees it.
  const double seen = sagging.curve_at(30 * kDegree) - sagging.curve_at(0);
  CHECK(seen / arcsec == Approx(100 * (1 - std::sin(60 * kDegree))).margin(4));
  CHECK(sagging.coherence > 100);
  // Theta of the sagging joint is stated at the angle that its controller shows.
  const double home_error = 100 * arcsec;
  for (std::size_t i = 0; i < 5; ++i)
    if (found.dh[i].alpha_rad.knowledge == Knowledge::identified)
      CHECK(std::abs(wrapped(found.dh[i].alpha_rad.value - found.specified[i].alpha_rad)) <
            4.5 * found.dh[i].alpha_rad.sigma);
  CHECK(std::abs(found.dh[1].theta_rad.value - found.specified[1].theta_rad) ==
        Approx(home_error).epsilon(0.3));
}

TEST_CASE("one joint whose angles sag is not believed while the others are",
          "[chain_estimator][long]") {
  test::Campaign campaign(test::kr5_arc(), {0.0005, 0, 7});
  campaign.sweep_all_90();
  auto samples = campaign.samples();
  for (Sample& sample : samples)
    sample.angles_rad[2] += 2 * kDegree / 3600 * std::sin(2 * sample.angles_rad[2]);
  const auto found = identify::identify(
      segment(as_printed(samples), {kPrinted, kPrinted * kDegree}), for_kr5(kPrinted));
  REQUIRE(found.chain);
  for (std::size_t j = 0; j < 6; ++j) {
    CAPTURE(j);
    CHECK((found.chain->angles[j].trust == AngleTrust::trusted) == (j != 2));
    CHECK_FALSE(found.chain->angles[j].reason.empty());
  }
}

TEST_CASE("sweeps from two homes and of two targets make one fit", "[chain_estimator]") {
  test::Campaign first(test::kr5_arc(), {0.0005, 0, 3});
  first.sweep_all_30();
  auto samples = first.samples();
  auto sweeps = segment(samples);
  // The same arm with another tool point, from the same home.
  Arm other = test::kr5_arc();
  other.tool_mm = {-60, 160, 120};
  test::Campaign second(other, {0.0005, 0, 4});
  second.sweep_all_30();
  for (Sweep sweep : segment(second.samples())) {
    sweep.target = 1;
    sweeps.push_back(std::move(sweep));
  }
  const auto both = identify::identify(sweeps, for_kr5());
  REQUIRE(both.chain);
  CHECK(both.chain->chain.targets_mm.size() == 2);
  CHECK(both.status == Status::complete);
  // Full precision: the wobble is known entirely, and nothing but rounding is left.
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(both.dh[i].a_mm.value == Approx(both.specified[i].a_mm).margin(1e-6));
    CHECK(std::abs(wrapped(both.dh[i].alpha_rad.value - both.specified[i].alpha_rad)) < 1e-8);
  }
  std::vector<double> home;
  for (const auto& angle : both.home_rad) home.push_back(*angle);
  const Eigen::Isometry3d last = forward_kinematics(other, home);
  CHECK((both.chain->chain.targets_mm[1] - last * other.tool_mm).norm() < 1e-6);
}

TEST_CASE("a second target without angles makes the table more certain",
          "[chain_estimator][long]") {
  std::vector<Sweep> one;
  std::vector<Sweep> both;
  for (std::size_t target = 0; target < 2; ++target) {
    Arm arm = test::kr5_arc();
    if (target == 1) arm.tool_mm = {-200, 0, 215};
    test::Campaign campaign(arm, {0, 0.02, 8});
    campaign.sweep_all_90();
    for (Sweep sweep : segment(campaign.samples())) {
      auto samples = *sweep.samples;
      for (Sample& sample : samples) sample.joints = 0;
      sweep.samples = std::make_shared<const std::vector<Sample>>(samples);
      sweep.target = target;
      if (target == 0) one.push_back(sweep);
      both.push_back(std::move(sweep));
    }
  }
  const auto with_one = identify::identify(one, for_kr5());
  const auto with_both = identify::identify(both, for_kr5());
  CHECK(with_both.status == Status::complete);
  for (std::size_t j = 0; j < 6; ++j) CHECK(with_both.joints[j].circle_target == 0);
  for (std::size_t i = 0; i < 5; ++i) {
    CAPTURE(i);
    CHECK(with_both.dh[i].a_mm.sigma < 0.9 * with_one.dh[i].a_mm.sigma);
    CHECK(with_both.dh[i].alpha_rad.sigma < 0.9 * with_one.dh[i].alpha_rad.sigma);
  }
  check_table(with_both, 4.5);
}

TEST_CASE("joints that did not come home are told, and the noise is that of the samples",
          "[chain_estimator][long]") {
  test::Campaign campaign(test::kr5_arc(), {0, 0.005, 5});
  campaign.sweep_all_90();
  auto sweeps = segment(campaign.samples());
  // The device was moved by half a millimetre while joint 4 swept.
  for (Sweep& sweep : sweeps) {
    auto samples = *sweep.samples;
    for (Sample& sample : samples) {
      sample.joints = 0;
      if (sweep.joint == 3) sample.position_mm += Vector3d(0.3, 0.4, 0);
    }
    sweep.samples = std::make_shared<const std::vector<Sample>>(samples);
  }
  const auto found = identify::identify(sweeps, for_kr5());
  REQUIRE(found.chain);
  // One of six strokes is off by 0.5 mm: 0.2 mm each, or what turns of that size do.
  CHECK(found.chain->home_scatter_mm > 0.1);
  CHECK(found.chain->home_scatter_mm < 1);
  CHECK(found.chain->noise.position_mm == Approx(0.005).epsilon(0.1));
  check_finite(found);
}

TEST_CASE("how far the target stood off home is told at the target, also where an axis is near it",
          "[chain_estimator][long]") {
  auto arm = test::kr5_arc();
  arm.tool_mm = {2.3, 0, 215};
  test::Campaign campaign(arm, {0, 0.005, 5});
  for (int round = 0; round < 3; ++round) campaign.sweep_all_90();
  auto sweeps = segment(campaign.samples());
  // Something moves the target by 0.3 mm in each coordinate from sweep to sweep.
  std::mt19937 random(1);
  std::normal_distribution<double> off_mm(0, 0.3);
  for (Sweep& sweep : sweeps) {
    const Vector3d off{off_mm(random), off_mm(random), off_mm(random)};
    auto samples = *sweep.samples;
    for (Sample& sample : samples) {
      sample.joints = 0;
      sample.position_mm += off;
    }
    sweep.samples = std::make_shared<const std::vector<Sample>>(samples);
  }
  const auto found = identify::identify(sweeps, for_kr5());
  REQUIRE(found.chain);
  CHECK(found.chain->home_scatter_mm > 0.1);
  CHECK(found.chain->home_scatter_mm < 1.5);  // five of 0.3 mm: some of the motions explain others
}

TEST_CASE("a twentieth of the points may be anywhere", "[chain_estimator]") {
  test::Campaign campaign(test::kr5_arc(), {0, 0.02, 6});
  campaign.sweep_all_30();
  auto sweeps = segment(campaign.samples());
  std::mt19937 random(1);
  std::uniform_real_distribution<> uniform;
  std::size_t moved = 0;
  for (Sweep& sweep : sweeps) {
    auto samples = *sweep.samples;
    for (Sample& sample : samples)
      if (uniform(random) < 0.05) {
        sample.position_mm += 1000 * Vector3d(uniform(random), uniform(random), uniform(random));
        if (!sweep.positioning) ++moved;
      }
    sweep.samples = std::make_shared<const std::vector<Sample>>(samples);
  }
  const auto found = identify::identify(sweeps, for_kr5());
  REQUIRE(found.estimator == Estimator::chain);
  INFO(found.reason);
  CHECK(found.status == Status::complete);
  CHECK(found.chain->outliers > 0);
  CHECK(found.chain->outliers <= moved);
  CHECK(found.chain->noise.position_mm == Approx(0.02).epsilon(0.05));
  check_table(found, 4.5);
}

TEST_CASE("absurd data end in a result that says so", "[chain_estimator]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Campaign one;
  one.joints = 1;
  const auto found = [&](std::vector<Sweep> sweeps, std::size_t joints = 1) {
    one.joints = joints;
    return identify::identify(std::move(sweeps), one);
  };
  const Vector3d z = Vector3d::UnitZ();
  const Vector3d x(300, 0, 0);

  SECTION("no sweep at all") {
    CHECK(found({}).status == Status::failed);
  }
  SECTION("one sample") {
    const auto result = found({sweep_of({at(x)})});
    CHECK(result.status == Status::failed);
    check_finite(result);
  }
  SECTION("the same point all the time") {
    const auto result = found({sweep_of(std::vector<Sample>(100, at(x)))});
    CHECK(result.status == Status::failed);
    check_finite(result);
  }
  SECTION("points on a line") {
    std::vector<Sample> samples;
    for (int i = 0; i < 100; ++i) samples.push_back(at(i * x));
    const auto result = found({sweep_of(samples)});
    CHECK(result.joints[0].linear);  // no arc is as straight
    CHECK(result.dh[0].relation == Relation::last);
    check_finite(result);
  }
  SECTION("four points of a circle") {
    check_finite(found({sweep_of(noisy_arc(z, x, 4, 0.01))}));
  }
  SECTION("noise as large as the circle") {
    check_finite(found({sweep_of(noisy_arc(z, x, 200, 300))}));
  }
  SECTION("an arc of a hundredth of a degree") {
    const auto result = found({sweep_of(noisy_arc(z, x, 200, 0.02, 2e-4))});
    CHECK(result.status == Status::failed);
    check_finite(result);
  }
  SECTION("lengths of kilometres and of nanometres") {
    check_finite(found({sweep_of(noisy_arc(z, 1e12 * x, 200, 1e9))}));
    check_finite(found({sweep_of(noisy_arc(z, 1e-9 * x, 200, 1e-12))}));
  }
  SECTION("numbers that are none, here and there and everywhere") {
    auto samples = noisy_arc(z, x, 200, 0.01);
    samples[17].position_mm.y() = nan;
    check_finite(found({sweep_of(samples)}));
    for (Sample& sample : samples) sample.position_mm.setConstant(nan);
    check_finite(found({sweep_of(samples)}));
  }
  SECTION("one joint about two axes") {
    const auto result =
        found({sweep_of(noisy_arc(z, x, 200, 0.01)),
               sweep_of(noisy_arc(Vector3d::UnitX(), Vector3d(0, 200, 50), 200, 0.01))});
    check_finite(result);
  }
  SECTION("two joints about the same axis") {
    check_finite(found(
        {sweep_of(noisy_arc(z, x, 200, 0.01), 0), sweep_of(noisy_arc(z, x, 200, 0.01), 1)}, 2));
  }
  SECTION("circles that meet nowhere") {
    auto far = noisy_arc(z, x, 200, 0.01);
    for (Sample& sample : far) sample.position_mm += Vector3d(0, 0, 5000);
    const auto result =
        found({sweep_of(noisy_arc(Vector3d::UnitY(), x, 200, 0.01), 0), sweep_of(far, 1)}, 2);
    check_finite(result);
    // Two strokes that tell 5 m apart are the edge of what the size of an effect can be told from;
    // which of the two is said hangs on the last bit of the fit.
    CHECK((says(result, "home_not_shared") || result.status == Status::doubtful));
  }
  SECTION("angles that have nothing to do with the points") {
    auto samples = noisy_arc(z, x, 400, 0.01);
    std::mt19937 random(9);
    std::uniform_real_distribution<> any(-3, 3);
    for (Sample& sample : samples) {
      sample.joints = 1;
      sample.angles_rad[0] = any(random);
    }
    const auto result = found({sweep_of(samples)});
    check_finite(result);
    REQUIRE(result.chain);
    CHECK(result.chain->angles[0].trust == AngleTrust::free);
    REQUIRE(result.joints[0].axis);
    CHECK(result.joints[0].axis->direction.cross(z).norm() < 1e-3);
  }
}
