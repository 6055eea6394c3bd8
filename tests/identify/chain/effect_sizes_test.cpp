#include "identify/chain/effect_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"
#include "tests/catch.hpp"
#include "tests/identify/simulated_campaign.hpp"
#include "tests/simulation/simulation.hpp"
#include "tests/simulation/truth.hpp"

using namespace identify;
using simulation::Simulation;

namespace {

/// The estimates' errors in what is stated, all identified lengths and angles between axes.
std::vector<double> scores(const Identification& found, const Simulation& campaign) {
  std::vector<double> all;
  const auto truth = simulation::true_table(campaign, found.dh, found.home_rad);
  REQUIRE(found.estimator == Estimator::chain);
  for (std::size_t i = 0; i < found.dh.size(); ++i)
    for (const auto& [number, actual] :
         {std::pair(found.dh[i].a_mm, truth[i].a_mm), std::pair(found.dh[i].b_mm, truth[i].b_mm),
          std::pair(found.dh[i].alpha_rad, truth[i].alpha_rad)})
      if (number.knowledge == Knowledge::identified)
        all.push_back((number.value - actual) / number.sigma);
  return all;
}

std::vector<Identification> identified(const std::vector<Simulation>& campaigns) {
  std::vector<Identification> all;
  for (const Simulation& campaign : campaigns)
    all.push_back(identify::identify(campaign.sweeps(), campaign.campaign()));
  return all;
}

/// `found`: of each campaign.
double rms_z(const std::vector<Simulation>& campaigns, const std::vector<Identification>& found) {
  double squares = 0, count = 0;
  for (std::size_t k = 0; k < campaigns.size(); ++k)
    for (const double z : scores(found[k], campaigns[k])) {
      squares += z * z;
      ++count;
    }
  return std::sqrt(squares / count);
}

double rms_z(const std::vector<Simulation>& campaigns) {
  return rms_z(campaigns, identified(campaigns));
}

/// By a device of 0.02 mm some metres away.
simulation::World seen_without_angles() {
  simulation::World world;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  world.placed = true;
  return world;
}

simulation::World seen_with_angles() {
  simulation::World world = seen_without_angles();
  world.angles = true;
  world.decimals = 4;
  return world;
}

/// Of so many KR 5 as built, each from a home of its own.
std::vector<Simulation> campaigns_of(std::uint32_t count, const simulation::Strokes& how,
                                     const simulation::World& world) {
  std::vector<Simulation> all;
  for (std::uint32_t seed = 1; seed <= count; ++seed)
    all.emplace_back(simulation::at_random_home(simulation::built(simulation::kr5(), seed), seed),
                     how, world, seed);
  return all;
}

/// By a device that drifts so, each joint there and back.
std::vector<Simulation> there_and_back(std::uint32_t count, const simulation::Drift& drift,
                                       simulation::World world = seen_without_angles(),
                                       int homes = 1, int samples = 300) {
  world.drift = drift;
  simulation::Strokes how;
  how.samples = samples;
  how.there_and_back = true;
  how.ramp = 0.1;
  how.homes = homes;
  return campaigns_of(count, how, world);
}

std::vector<Simulation> sagging(bool told, int homes = 1) {
  simulation::World world = homes > 1 ? seen_with_angles() : seen_without_angles();
  world.sag_arcsec = 60;
  world.sag_told = told;
  simulation::Strokes how;
  how.arc_deg = 90;
  how.samples = 300;
  how.homes = homes;
  return campaigns_of(4, how, world);
}

}  // namespace

TEST_CASE("Uncertainties hold for an arm that sags as its description says",
          "[effect_sizes][long]") {
  CHECK(rms_z(sagging(false)) > 2);
  CHECK(rms_z(sagging(true)) < 1.3);
}

TEST_CASE("Uncertainties hold where a joint goes on by whole steps of its printed angle",
          "[effect_sizes][stroke_rounding][long]") {
  simulation::World world;
  world.controller = world.orientations = world.angles = true;
  world.decimals = 3;
  world.wobble_deg = GENERATE(0.0, 0.0001);
  simulation::Strokes how;
  how.arc_deg = 90;
  how.samples = 1126;  // 0.08 degrees from one to the next
  const double rms = rms_z(campaigns_of(4, how, world));
  CAPTURE(world.wobble_deg, rms);
  CHECK(rms < 1.2);
}

TEST_CASE("A device's positions beside angles of few decimals are not taken for the controller's",
          "[effect_sizes][long]") {
  simulation::World world = seen_with_angles();
  world.decimals = GENERATE(1, 2);
  world.home.sigma_deg = 0.005;
  simulation::Strokes how;
  how.samples = 300;
  how.there_and_back = true;
  const auto campaigns = campaigns_of(4, how, world);
  const auto all = identified(campaigns);
  CHECK(rms_z(campaigns, all) < 1.3);
  const Identification& found = all.front();
  for (const AngleEvidence& angles : found.chain->angles)
    CHECK(angles.trust != AngleTrust::trusted);
  CHECK(test::find_warning(found, "transmission_error") == nullptr);
}

TEST_CASE("Perfect gears show no pattern where a figure may hide what is seen across the motion",
          "[effect_sizes][angle_trust][long]") {
  simulation::Strokes how;
  how.samples = 300;
  how.there_and_back = GENERATE(false, true);
  double sum = 0;
  int count = 0;
  for (const Simulation& campaign : campaigns_of(6, how, seen_with_angles())) {
    const auto found = identify::identify(campaign.sweeps(), campaign.campaign());
    REQUIRE(found.chain);
    for (const AngleEvidence& angles : found.chain->angles) {
      CHECK(angles.trust == AngleTrust::smooth);
      sum += angles.remainder_coherence;
      ++count;
    }
  }
  CHECK(sum / count == Approx(1).margin(0.25));
}

TEST_CASE("Uncertainties hold where one joint alone does not stay where it was locked",
          "[effect_sizes][uneven_joints][long]") {
  simulation::World world = seen_without_angles();
  world.home.sigma_deg = 0.03;
  world.home.joint = 0;
  simulation::Strokes how;
  how.samples = 100;
  how.repeats = 3;
  CHECK(rms_z(campaigns_of(8, how, world)) < 1.1);
}

TEST_CASE("Joints are off alike in as many sweeps as they stand still through",
          "[effect_sizes][long]") {
  simulation::World world = seen_without_angles();
  world.home.sigma_deg = 0.01;
  world.home.lasts = GENERATE(HomeLasts::stroke, HomeLasts::stand, HomeLasts::rest);
  simulation::Strokes how;
  how.samples = 100;
  how.ramp = 0.1;
  how.there_and_back = true;
  how.rounds = world.home.lasts == HomeLasts::rest ? 2 : 1;
  const auto campaigns = campaigns_of(16, how, world);
  CAPTURE(text(world.home.lasts));
  const auto all = identified(campaigns);
  CHECK(rms_z(campaigns, all) == Approx(1).margin(0.15));
  const Identification& found = all.front();
  REQUIRE(found.chain);
  CHECK(found.chain->effects.home_lasts == world.home.lasts);
  CHECK_FALSE(test::find_warning(found, "joints_creep"));
}

TEST_CASE("Joints rest however often they sweep", "[effect_sizes][long]") {
  simulation::World world = seen_without_angles();
  world.home.sigma_deg = 0.01;
  world.home.lasts = HomeLasts::rest;
  simulation::Strokes how;
  how.samples = 100;
  how.rounds = 12;
  const auto campaigns = campaigns_of(1, how, world);
  const auto found = identify::identify(campaigns.front().sweeps(), campaigns.front().campaign());
  REQUIRE(found.chain);
  CHECK(found.chain->effects.home_lasts == HomeLasts::rest);
}

TEST_CASE("Uncertainties hold where locked joints go on while another one sweeps",
          "[effect_sizes][long]") {
  simulation::World world = seen_without_angles();
  world.home.creep_deg = GENERATE(0.002, 0.01);
  const auto campaigns = there_and_back(12, {}, world, 1, 100);
  CAPTURE(world.home.creep_deg);
  const auto all = identified(campaigns);
  CHECK(rms_z(campaigns, all) == Approx(1).margin(0.15));
  const Identification& found = all.front();
  REQUIRE(found.chain);
  const double from_the_middle_rad = world.home.creep_deg / 2 * kDegree;
  CHECK(found.chain->effects.creep_rad > 0.2 * from_the_middle_rad);
  CHECK(found.chain->effects.creep_rad < 1.5 * from_the_middle_rad);
  if (world.home.creep_deg > 0.005) CHECK(test::find_warning(found, "joints_creep"));
}

TEST_CASE("Uncertainties hold where a device walks and sweeps go there and back",
          "[effect_sizes][long]") {
  CHECK(rms_z(there_and_back(24, {0, 0.05})) == Approx(1).margin(0.15));
}

TEST_CASE("A device's steady drift is seen, and moves no axis", "[effect_sizes][long]") {
  double squares = 0;
  const auto campaigns = there_and_back(16, {0.2, 0});
  for (const Simulation& campaign : campaigns) {
    const auto found = identify::identify(campaign.sweeps(), campaign.campaign());
    REQUIRE(found.chain);
    REQUIRE(found.chain->steady_drift);
    const auto& drift = *found.chain->steady_drift;
    CHECK(drift.mm.norm() == Approx(0.2).margin(4 * std::sqrt(drift.covariance.trace())));
    CHECK(std::sqrt(drift.covariance.trace()) < 0.02);
    // Along parallel axes: what each of them has is far apart in time.
    const auto truth = simulation::true_table(campaign, found.dh, found.home_rad);
    const double z = (found.dh[2].b_mm.value - truth[2].b_mm) / found.dh[2].b_mm.sigma;
    squares += z * z;
  }
  CHECK(std::sqrt(squares / static_cast<double>(campaigns.size())) < 1.4);
}

TEST_CASE("A device that sways or warms up moves no axis", "[effect_search][long]") {
  const bool warms = GENERATE(false, true);
  simulation::Drift drift;
  (warms ? drift.warm_mm : drift.sway_mm) = 0.2;
  const auto campaigns = there_and_back(8, drift);
  CAPTURE(warms);
  const auto all = identified(campaigns);
  CHECK(rms_z(campaigns, all) == Approx(1).margin(0.2));
  const Identification& found = all.front();
  REQUIRE(found.chain);
  // A third and less of what a walk of this size would leave.
  for (const DhEstimate& row : found.dh)
    if (row.a_mm.knowledge == Knowledge::identified) CHECK(row.a_mm.sigma < 0.03);
  CHECK(found.chain->wander_mm == Approx(warms ? 0.03 : 0.08).epsilon(0.4));
  CHECK_FALSE(found.chain->steady_drift);
  const auto told =
      std::find_if(found.warnings.begin(), found.warnings.end(),
                   [](const Warning& warning) { return warning.code == "device_drifts"; });
  REQUIRE(told != found.warnings.end());
  CHECK_THAT(told->message,
             !Catch::Matchers::ContainsSubstring("there and back"));  // that was done
}

TEST_CASE("A device that was moved half way through moves no axis", "[effect_search][long]") {
  const bool back = GENERATE(false, true);
  CAPTURE(back);
  simulation::World world = seen_without_angles();
  world.drift.moved_mm = 0.05;
  simulation::Strokes how;
  how.there_and_back = back;
  const auto campaigns = campaigns_of(16, how, world);
  const auto all = identified(campaigns);
  const double rms = rms_z(campaigns, all);  // below one: the target might have been moved as well
  CHECK(rms < 1.2);
  CHECK(rms > 0.6);
  int seen = 0;
  for (const Identification& found : all) {
    REQUIRE(found.chain);
    // Joints that stay off home explain some as well.
    if (found.chain->move) {
      ++seen;
      CHECK(found.chain->move->joint == 3);
    } else if (!found.chain->others.empty()) {
      ++seen;
      CHECK(found.chain->others.front().moved);
    }
  }
  CHECK(seen >= 12);
}

TEST_CASE("One of three targets that slips on the tool moves no axis", "[effect_search][long]") {
  simulation::Strokes how;
  how.there_and_back = true;
  how.samples = 100;
  double squares = 0, count = 0;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    auto robot = simulation::at_random_home(simulation::built(simulation::kr5(3), seed), seed);
    const Simulation before(robot, how, seen_with_angles(), seed);
    robot.targets_mm[1] += Eigen::Vector3d(0.05, -0.05, 0.05);
    const Simulation after(robot, how, seen_with_angles(), seed);
    auto sweeps = before.sweeps();
    const auto later = after.sweeps();
    for (std::size_t s = 0; s < sweeps.size(); ++s)
      if (*sweeps[s].joint >= 3) sweeps[s] = later[s];
    const auto found = identify::identify(sweeps, before.campaign());
    CAPTURE(seed);
    REQUIRE(found.chain);
    REQUIRE(found.chain->move);
    CHECK(found.chain->move->joint == 3);
    CHECK(found.chain->move->mm.norm() == Approx(0.087).margin(0.01));
    for (const double z : scores(found, before)) {
      CHECK(std::abs(z) < 4);
      squares += z * z;
      ++count;
    }
  }
  CHECK(std::sqrt(squares / count) < 1.2);
}

TEST_CASE("A device that walks at random was not moved, nor was one whose robot comes home badly",
          "[effect_search][long]") {
  const bool walks = GENERATE(false, true);
  CAPTURE(walks);
  simulation::World world = seen_without_angles();
  (walks ? world.drift.walk_mm : world.home.sigma_deg) = walks ? 0.1 : 0.005;
  for (const Simulation& campaign : campaigns_of(16, {}, world)) {
    const auto found = identify::identify(campaign.sweeps(), campaign.campaign());
    REQUIRE(found.chain);
    CHECK_FALSE(found.chain->move);
  }
}

TEST_CASE("A device that sways accuses no gear", "[effect_search][chain_fit][long]") {
  simulation::Drift drift;
  drift.sway_mm = 0.2;
  for (const Simulation& campaign : there_and_back(8, drift, seen_with_angles())) {
    const auto found = identify::identify(campaign.sweeps(), campaign.campaign());
    REQUIRE(found.status == identify::Status::complete);
    for (const Warning& warning : found.warnings) CHECK(warning.code != "backlash");
  }
}

TEST_CASE("Where strokes repeat, joints that settle elsewhere each time do not play",
          "[effect_search][angle_trust][long]") {
  const auto told = [](const simulation::World& world, int rounds) {
    simulation::Strokes how;
    how.samples = 200;
    how.there_and_back = true;
    how.rounds = rounds;
    std::vector<std::string> all;
    for (const Identification& found : identified(campaigns_of(2, how, world))) {
      REQUIRE(found.status == Status::complete);
      for (const Warning& warning : found.warnings)
        if (warning.code == "backlash") all.push_back(warning.message);
    }
    return all;
  };
  simulation::World settles = seen_with_angles(), plays = settles;
  settles.gears.settles_deg = 0.003;
  plays.gears.backlash_arcsec = 30;
  CHECK(told(plays, 3).size() == 12);
  CHECK(told(settles, 3).empty());
  const auto once = told(settles, 1);  // nothing tells it from play
  REQUIRE_FALSE(once.empty());
  CHECK_THAT(once.front(), Catch::Matchers::ContainsSubstring("there and back once more"));
}

TEST_CASE("What gives way is told also where the device drifts",
          "[effect_sizes][effect_search][long]") {
  const bool sways = GENERATE(false, true);
  simulation::World world = seen_with_angles();
  world.sag_arcsec = 60;
  simulation::Drift drift;
  (sways ? drift.sway_mm : drift.linear_mm) = 0.2;
  const auto campaigns = there_and_back(3, drift, world, 2);
  CAPTURE(sways);
  const auto all = identified(campaigns);
  CHECK(rms_z(campaigns, all) < 1.4);
  const Identification& found = all.back();
  REQUIRE(found.chain);
  CHECK(found.chain->effects.sag_rad > 10 * kArcsec);
}

TEST_CASE("Of a device that walks at random no steady drift is told",
          "[effect_sizes][chain_fit][long]") {
  for (const Simulation& campaign : there_and_back(8, {0, 0.1})) {
    const auto found = identify::identify(campaign.sweeps(), campaign.campaign());
    REQUIRE(found.chain);
    CHECK_FALSE(found.chain->steady_drift);
  }
}

TEST_CASE("Where each sweep's times begin anew, or there are none, nobody can tell a steady drift",
          "[effect_sizes]") {
  const bool none = GENERATE(false, true);
  simulation::World world = seen_without_angles();
  world.drift.linear_mm = 0.2;
  const auto campaign = campaigns_of(1, {}, world).front();
  const auto sweeps =
      test::changed(campaign.sweeps(), [none](const Sweep& sweep, std::vector<Sample>& samples) {
        for (Sample& sample : samples)
          sample.time_s = none ? 0 : sample.time_s - sweep.first().time_s;
      });
  const auto found = identify::identify(sweeps, campaign.campaign());
  REQUIRE(found.chain);
  CHECK_FALSE(found.chain->steady_drift);
  CHECK(found.status == Status::complete);
}

TEST_CASE("Sweeps from a second home show how far joints give way", "[effect_sizes][long]") {
  const auto campaigns = sagging(false, 2);
  const auto all = identified(campaigns);
  CHECK(rms_z(campaigns, all) < 1.3);
  const Identification& found = all.front();
  REQUIRE(found.chain);
  CHECK_FALSE(found.chain->effects.sag_told);
  CHECK(found.chain->effects.sag_rad > 20 * kArcsec);
  CHECK(found.chain->effects.sag_rad < 180 * kArcsec);
}

TEST_CASE("Uncertainties hold for arcs that show how far they are from circles",
          "[effect_sizes][long]") {
  simulation::World world = seen_without_angles();
  world.shape.rms_mm = 0.02;
  simulation::Strokes how;
  how.arc_deg = 90;
  how.samples = 1500;
  CHECK(rms_z(campaigns_of(8, how, world)) < 1.3);
}

TEST_CASE("There and back, an arc that is no circle is the same one", "[effect_sizes][long]") {
  simulation::World world = seen_without_angles();
  world.shape.rms_mm = 0.05;
  simulation::Strokes how;
  how.arc_deg = 90;
  how.samples = 300;
  how.there_and_back = true;
  world.angles = GENERATE(false, true);
  CHECK(rms_z(campaigns_of(8, how, world)) < 1.3);
}

TEST_CASE("The budget says what sag has of the uncertainties", "[effect_sizes]") {
  const auto campaign = sagging(true).front();
  const auto found = identify::identify(campaign.sweeps(), campaign.campaign());
  double sag = 0, all = found.dh_covariance.trace();
  for (const auto& share : found.dh_budget)
    if (share.cause == Cause::sag) sag = share.variances.sum();
  CHECK(found.chain->effects.sag_rad == Approx(60 * kArcsec));
  CHECK(sag > 0.1 * all);
  CHECK(sag < all);
}

TEST_CASE("An arc that is seen to be no circle is never taken for one, also where it has gaps",
          "[effect_sizes][long]") {
  simulation::World world;
  world.noise.range_mm = world.noise.across_mm = 0.05;
  world.shape.rms_mm = 0.3;
  simulation::Strokes how;
  how.arc_deg = 120;
  how.samples = 1200;
  Campaign alone;
  alone.joints = 1;
  std::size_t circles = 0, apart = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const Simulation campaign(
        simulation::at_random_home(simulation::built(simulation::kr5(), seed), seed), how, world,
        seed);
    std::vector<Axis> axes;
    for (const std::size_t half : {std::size_t{0}, std::size_t{1}}) {
      Sweep part = campaign.sweeps().front();
      const std::vector<Sample> all = *part.samples;
      std::vector<Sample> kept;
      for (std::size_t i = 0; i < all.size(); ++i)
        if (10 * i / all.size() % 2 == half) kept.push_back(all[i]);
      part.samples = std::make_shared<const std::vector<Sample>>(std::move(kept));
      part.joint = 0;
      part.direction = 1;
      const auto found = identify::identify({part}, alone);
      REQUIRE(found.joints[0].axis);
      axes.push_back(*found.joints[0].axis);
      circles += found.chain && found.chain->effects.figure_mm() == 0;
    }
    const auto basis = across(axes[0].direction);
    const Eigen::Vector2d off = basis.transpose() * (axes[1].direction - axes[0].direction);
    const Eigen::Matrix2d covariance =
        basis.transpose() * (axes[0].covariance + axes[1].covariance).topLeftCorner<3, 3>() * basis;
    const double squares = off.dot(covariance.inverse() * off);
    apart += squares > 13.8;  // by chance in a thousandth
  }
  CHECK(circles == 0);
  CHECK(apart <= 1);
}
