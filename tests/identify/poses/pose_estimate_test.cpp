#include "identify/poses/pose_estimate.hpp"

#include <algorithm>
#include <random>

#include "identify/identification.hpp"
#include "tests/catch.hpp"
#include "tests/identify/poses/simulated_poses.hpp"
#include "tests/simulation/truth.hpp"

using namespace identify;
using namespace simulation::robots;

namespace {

struct Judged {
  int inside = 0;
  int numbers = 0;
  double squares = 0;   ///< of errors in standard uncertainties
  double farthest = 0;  ///< the largest of them
};

void judge(const simulation::Simulation& of, const Identification& found, Judged& all) {
  const auto truth = simulation::true_table(of, found.dh, found.home_rad);
  for (std::size_t i = 0; i < found.dh.size(); ++i) {
    const DhRow& row = truth[i];
    const std::array<double, 5> values{row.b_mm, row.theta_rad, row.a_mm, row.alpha_rad,
                                       row.beta_rad};
    const auto numbers = numbers_of(found.dh[i]);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (numbers[k]->knowledge != Knowledge::identified) continue;
      double error = numbers[k]->value - values[k];
      if (k == 1 || k == 3) error = wrapped(error);
      const double z = error / numbers[k]->sigma;
      ++all.numbers;
      all.squares += z * z;
      all.farthest = std::max(all.farthest, std::abs(z));
      if (std::abs(z) < 1.96) ++all.inside;
    }
  }
}

double error_of(const simulation::Simulation& of, const Identification& found) {
  const auto truth = simulation::true_table(of, found.dh, found.home_rad);
  double squares = 0;
  for (std::size_t i = 1; i + 1 < found.dh.size(); ++i) {
    if (found.dh[i].relation == Relation::parallel ||
        found.dh[i - 1].relation == Relation::parallel)
      continue;
    squares += std::pow(found.dh[i].b_mm.value - truth[i].b_mm, 2) +
               std::pow(found.dh[i].a_mm.value - truth[i].a_mm, 2);
  }
  return squares;
}

simulation::World with_gears(double arcsec) {
  simulation::World world = simulation::robots::tracker();
  world.gears.first_arcsec = world.gears.second_arcsec = arcsec;
  return world;
}

/// Where a robot rests in a campaign of sweeps: at the ends of each, there twice, and at home.
std::vector<Pose> rests(const simulation::Simulation& of) {
  std::vector<std::vector<double>> angles_rad;
  for (std::size_t j = 0; j < of.robot().arm.joints(); ++j) {
    auto at = of.robot().arm.home_rad;
    angles_rad.push_back(at);
    for (const double turn_deg : {-40.0, 45.0, -40.0}) {
      at[j] = of.robot().arm.home_rad[j] + turn_deg * kDegree;
      angles_rad.push_back(at);
    }
  }
  return of.poses_at(angles_rad);
}

/// Each target at each of so many rests.
std::vector<Pose> seen_together(const simulation::Simulation& of, std::size_t rests,
                                std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<> turn(-80 * kDegree, 80 * kDegree);
  std::vector<std::vector<double>> angles_rad;
  for (std::size_t i = 0; i < rests; ++i) {
    auto at = of.robot().arm.home_rad;
    for (double& angle : at) angle += turn(random);
    angles_rad.insert(angles_rad.end(), of.robot().targets_mm.size(), at);
  }
  return of.poses_at(angles_rad);
}

/// Identifies and judges a result that is to be complete.
void judge_complete(const simulation::Simulation& of, const std::vector<Sweep>& sweeps,
                    std::size_t poses, Judged& all) {
  const auto found = identify::identify(sweeps, of.campaign(), of.poses(poses));
  INFO(found.reason);
  REQUIRE(found.status == Status::complete);
  judge(of, found, all);
}

/// But those of one joint.
std::vector<Sweep> sweeps_without(std::size_t joint, const simulation::Simulation& of) {
  auto sweeps = of.sweeps();
  std::erase_if(sweeps, [&](const Sweep& sweep) { return sweep.joint == joint; });
  return sweeps;
}

}  // namespace

TEST_CASE("Poses alone tell the table, and their uncertainties hold", "[pose_estimate][long]") {
  Judged all;
  for (std::uint32_t seed = 1; seed <= 25; ++seed) {
    const auto built = arm_with(tracker(seed % 2 == 0 ? 0.002 : 0), seed);
    const auto found = identify::identify({}, built.campaign(), built.poses(40));
    INFO("seed " << seed << ": " << found.reason);
    REQUIRE(found.status == Status::complete);
    REQUIRE(found.estimator == Estimator::poses);
    judge(built, found, all);
  }
  const double share = static_cast<double>(all.inside) / all.numbers;
  CHECK(all.numbers > 400);
  CHECK(share > 0.92);
  CHECK(share < 0.98);
  CHECK(std::sqrt(all.squares / all.numbers) == Approx(1).margin(0.1));
}

TEST_CASE(
    "Uncertainties hold of arms that give way to weights that nobody knows, also where they swept",
    "[pose_estimate][pose_effects][pose_sag][long]") {
  const bool swept = GENERATE(false, true);
  Judged all;
  auto world = tracker();
  world.sag_arcsec = 60;
  for (std::uint32_t seed = 1; seed <= (swept ? 10U : 25U); ++seed) {
    const auto built = arm_with(world, seed);
    const auto sweeps = swept ? built.sweeps() : std::vector<Sweep>();
    INFO("seed " << seed);
    judge_complete(built, sweeps, 40, all);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.92);
  CHECK(all.farthest < 5);
}

TEST_CASE("Uncertainties hold of sweeps beside so few poses that these do not show what gives way",
          "[pose_estimate][pose_sag][long]") {
  Judged all;
  auto world = tracker();
  world.sag_arcsec = 60;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const auto robot =
        simulation::at_random_home(simulation::built(simulation::iiwa(), seed), seed);
    const simulation::Simulation built(robot, simulation::Strokes(), world, seed);
    INFO("seed " << seed);
    judge_complete(built, built.sweeps(), 8, all);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.9);
  CHECK(all.farthest < 6);
}

TEST_CASE("Many poses show that nothing gives way, few do not", "[pose_estimate][pose_sag]") {
  const auto built = arm_with(tracker(), 3);
  const auto unsure_rad = [&](std::size_t count) {
    const auto found = identify::identify(built.sweeps(), built.campaign(), built.poses(count));
    REQUIRE(found.poses);
    return found.poses->weights_unsure_rad;
  };
  CHECK(unsure_rad(6) > 4 * kArcsec);
  CHECK(unsure_rad(6) <= 10 * kArcsec);
  CHECK(unsure_rad(100) < unsure_rad(6) / 2);
}

TEST_CASE("Sweeps of some joints, and poses of all, tell the table",
          "[pose_estimate][pose_start]") {
  Judged all;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const auto built = arm_with(tracker(), seed);
    INFO("seed " << seed);
    judge_complete(built, sweeps_without(seed % 6, built), 20, all);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.92);
  CHECK(all.farthest < 4.5);
}

TEST_CASE("A joint that never turned has no axis", "[pose_estimate][pose_start]") {
  const std::size_t joint = GENERATE(2U, 4U, 5U);
  const auto built = arm_with(tracker(), 1);
  std::vector<std::vector<double>> angles_rad;
  for (const Pose& pose : built.poses(15)) {
    angles_rad.emplace_back(pose.sample.angles_rad.begin(), pose.sample.angles_rad.begin() + 6);
    angles_rad.back()[joint] = built.robot().arm.home_rad[joint];
  }
  const auto found = identify::identify(sweeps_without(joint, built), built.campaign(),
                                        built.poses_at(angles_rad));
  CHECK(found.status == Status::partial);
  CHECK(found.reason == "no axis for joint " + std::to_string(joint + 1));
  for (std::size_t j = 0; j < 6; ++j) CHECK(found.joints[j].axis.has_value() == (j != joint));
}

TEST_CASE("A device that drifted between sweeps and poses accuses no joint",
          "[pose_estimate][pose_start][long]") {
  Judged all;
  auto drifting = tracker();
  drifting.drift.linear_mm = 0.5;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const auto sweeps = arm_with(drifting, seed).sweeps();
    const auto built = arm_with(tracker(), seed);  // before it drifted
    const auto found = identify::identify(sweeps, built.campaign(), built.poses(30));
    INFO("seed " << seed << ": " << found.reason);
    REQUIRE(found.status == Status::complete);
    REQUIRE(found.poses);
    CHECK(found.poses->effects.empty());
    REQUIRE(found.chain);
    CHECK(found.chain->steady_drift);
    judge(built, found, all);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.92);
}

TEST_CASE("Few poses of a device that was moved are told to scatter", "[pose_estimate][advice]") {
  const bool moved = GENERATE(false, true);
  CAPTURE(moved);
  int noisy = 0;
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const auto built = arm_with(tracker(), seed);
    auto poses = built.poses(8);
    for (Pose& pose : poses)
      if (moved) pose.sample.position_mm.x() += 0.4;
    const auto found = identify::identify(built.sweeps(), built.campaign(), poses);
    const bool scatter =
        std::any_of(found.warnings.begin(), found.warnings.end(),
                    [](const Warning& warning) { return warning.code == "poses_noisy"; });
    CHECK((scatter || !found.doubts.empty()) == moved);
    if (scatter) ++noisy;
  }
  CHECK((noisy > 0) == moved);
}

TEST_CASE("Gears do not take up all noise of a few poses", "[pose_estimate][long]") {
  Judged all;
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    const auto built = arm_with(tracker(), seed);
    const auto poses = built.poses(12);
    const auto found = identify::identify({}, built.campaign(), poses);
    INFO("seed " << seed << ": " << found.reason);
    REQUIRE(found.estimator == Estimator::poses);
    judge(built, found, all);
    const PoseFit& fit = found.poses->fit;
    double square = 0;  // of the noise in each coordinate, on average
    for (const PoseRow& row : fit.rows)
      square += fit.noise.covariance(row.by_own).trace() / 3 / static_cast<double>(poses.size());
    CHECK(std::sqrt(square) > 0.005);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.92);
  CHECK(all.farthest < 6);
}

TEST_CASE("Ellipsoids hold what was not fitted", "[pose_estimate][long]") {
  int inside = 0, count = 0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const auto built = arm_with(tracker(0.002), seed);
    auto poses = built.poses(90);
    const std::vector<Pose> held(poses.begin() + 40, poses.end());
    poses.resize(40);
    const auto found = estimated(poses, built.campaign());
    REQUIRE(found);
    for (const Pose& pose : held) {
      const Eigen::Vector3d off = pose.sample.position_mm - found->fit.model.position_mm(pose);
      ++count;
      if (off.dot(found->covariance_at(pose).inverse() * off) < 7.815) ++inside;
    }
  }
  const double share = static_cast<double>(inside) / count;
  CHECK(share > 0.92);
  CHECK(share < 0.98);
}

TEST_CASE("Sweeps and poses together are no worse than either", "[pose_estimate][long]") {
  double sweeps = 0, poses = 0, both = 0;
  Judged all;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const auto built = arm_with(tracker(), seed);
    const auto static_ones = built.poses(30);
    sweeps += error_of(built, identify::identify(built.sweeps(), built.campaign()));
    poses += error_of(built, identify::identify({}, built.campaign(), static_ones));
    const auto together = identify::identify(built.sweeps(), built.campaign(), static_ones);
    REQUIRE(together.estimator == Estimator::poses);
    REQUIRE(together.poses->with_sweeps);
    both += error_of(built, together);
    judge(built, together, all);
  }
  CHECK(both < 1.05 * sweeps);
  CHECK(both < 1.05 * poses);
  CHECK(std::sqrt(all.squares / all.numbers) == Approx(1).margin(0.15));
}

TEST_CASE("What gears are off at a place is told once, however often the arm rests there",
          "[pose_estimate][long]") {
  Judged all;
  for (std::uint32_t seed = 1; seed <= 16; ++seed) {
    const auto built = arm_with(with_gears(10), seed);
    const auto found = identify::identify(built.sweeps(), built.campaign(), rests(built));
    INFO("seed " << seed << ": " << found.reason);
    REQUIRE(found.status == Status::complete);
    REQUIRE(found.estimator == Estimator::poses);
    judge(built, found, all);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.92);
  CHECK(std::sqrt(all.squares / all.numbers) == Approx(1).margin(0.15));
}

TEST_CASE("What joints are off at a rest is told once, however many targets are seen there",
          "[pose_estimate][pose_stands][long]") {
  Judged all;
  auto world = tracker();
  world.decimals = 2;  // what rounding takes of the angles, all targets of a rest share
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const auto built = arm_with(world, seed, 3);
    const auto found = identify::identify({}, built.campaign(), seen_together(built, 100, seed));
    INFO("seed " << seed << ": " << found.reason);
    REQUIRE(found.status == Status::complete);
    CHECK_FALSE(found.poses->drift.seen);
    judge(built, found, all);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.9);
  CHECK(all.farthest < 4);
  CHECK(std::sqrt(all.squares / all.numbers) == Approx(1).margin(0.15));
}

TEST_CASE("Joints that play are told by the sense in which they came to rest",
          "[pose_estimate][long]") {
  Judged all;
  double told = 0, untold = 0;  // variances
  for (std::uint32_t seed = 1; seed <= 16; ++seed) {
    const auto built = arm_with(tracker(), seed);
    auto poses = played(rests(built), built.robot().arm.joints(), 15 * kArcsec, seed);
    const auto found = identify::identify(built.sweeps(), built.campaign(), poses);
    REQUIRE(found.estimator == Estimator::poses);
    CHECK(found.poses->fit.noise.play_rad == Approx(15 * kArcsec).margin(3 * kArcsec));
    judge(built, found, all);
    told += found.dh_covariance.trace();
    for (Pose& pose : poses) pose.senses = {};
    const auto blind = identify::identify(built.sweeps(), built.campaign(), poses);
    untold += blind.dh_covariance.trace();
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.92);
  CHECK(std::sqrt(all.squares / all.numbers) == Approx(1).margin(0.15));
  CHECK(told < 0.8 * untold);
}

TEST_CASE("Ellipsoids hold poses of which nobody knows how joints that play came to rest",
          "[pose_estimate]") {
  const auto built = arm_with(tracker(), 3);
  auto poses = played(built.poses(160), built.robot().arm.joints(), 15 * kArcsec, 3);
  const std::vector<Pose> fitted_ones(poses.begin(), poses.begin() + 60);
  const auto found = estimated(fitted_ones, built.campaign());
  REQUIRE(found);
  int inside = 0, known = 0;
  for (auto pose = poses.begin() + 60; pose != poses.end(); ++pose) {
    const auto holds = [&] {
      const Eigen::Vector3d off = pose->sample.position_mm - found->fit.model.position_mm(*pose);
      return off.dot(found->covariance_at(*pose).inverse() * off) < 7.815;
    };
    if (holds()) ++known;
    pose->senses = {};
    if (holds()) ++inside;
  }
  CHECK(known > 88);
  CHECK(inside > 88);
}

TEST_CASE("Gears whose errors no test finds are in the uncertainties of poses",
          "[pose_estimate][long]") {
  Judged all;
  for (std::uint32_t seed = 1; seed <= 25; ++seed) {
    const auto built = arm_with(with_gears(10), seed);
    const auto found = identify::identify({}, built.campaign(), built.poses(40));
    REQUIRE(found.estimator == Estimator::poses);
    judge(built, found, all);
  }
  CHECK(static_cast<double>(all.inside) / all.numbers > 0.92);
  CHECK(std::sqrt(all.squares / all.numbers) == Approx(1).margin(0.15));
}

TEST_CASE("What makes up the uncertainty adds up to it", "[pose_estimate]") {
  const auto built = arm_with(with_gears(10), 3);
  auto poses = built.poses(40);
  for (Pose& rest : rests(built)) poses.push_back(std::move(rest));
  const auto found = estimated(poses, built.campaign());
  REQUIRE(found);
  REQUIRE_FALSE(found->fit.model.places.empty());
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(found->chain.covariance.rows());
  for (const auto& part : found->chain.parts) sum += part.covariance.diagonal();
  for (Eigen::Index i = 0; i < 36; ++i)
    CHECK(sum(i) == Approx(found->chain.covariance(i, i)).epsilon(1e-3).margin(1e-15));
}

TEST_CASE("Poses that were computed leave no noise, and the fit comes to its end",
          "[pose_estimate]") {
  simulation::World world = simulation::robots::tracker();
  world.noise = {};
  world.decimals = 4;
  const auto built = arm_with(world, 2);
  auto poses = built.poses(40);
  for (Pose& rest : rests(built)) poses.push_back(std::move(rest));
  for (const auto& some : {poses, rests(built)}) {
    const auto found = estimated(some, built.campaign());
    REQUIRE(found);
    CHECK(found->fit.converged);
  }
}

TEST_CASE("Angles of few decimals do not make a device's poses the controller's own",
          "[pose_estimate]") {
  for (const bool device : {false, true})
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
      auto world = tracker(device ? 0.005 : 0);
      world.noise.range_mm = world.noise.across_mm = device ? 0.05 : 0;
      world.noise.decimals = 4;
      world.decimals = 2;
      const auto built = arm_with(world, seed);
      auto campaign = built.campaign();
      campaign.resolution = {1e-4, 0.01 * kDegree};
      const auto found = estimated(built.poses(40), campaign);
      REQUIRE(found);
      INFO("device " << device << ", seed " << seed);
      CHECK(found->computed == !device);
    }
}

TEST_CASE("Distances between targets tell a device, however few decimals the angles have",
          "[pose_estimate]") {
  for (const bool device : {false, true})
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
      auto world = tracker();
      world.noise.range_mm = world.noise.across_mm = device ? 0.01 : 0;
      world.noise.decimals = 4;
      world.decimals = 2;
      const auto built = arm_with(world, seed, 3);
      auto campaign = built.campaign();
      campaign.resolution = {1e-4, 0.01 * kDegree};
      const auto found = estimated(seen_together(built, 20, seed), campaign);
      REQUIRE(found);
      INFO("device " << device << ", seed " << seed);
      CHECK(found->computed == !device);
    }
}

TEST_CASE("Poses that were visited again and again are counted once", "[pose_estimate]") {
  const auto built = arm_with(tracker(0.001), 1);
  std::vector<std::vector<double>> angles_rad;
  for (int visit = 0; visit < 7; ++visit)
    for (const Pose& pose : built.poses(8))
      angles_rad.emplace_back(pose.sample.angles_rad.begin(),
                              pose.sample.angles_rad.begin() + pose.sample.joints);
  const auto found = identify::identify({}, built.campaign(), built.poses_at(angles_rad));
  CHECK(found.status == Status::failed);
  CHECK_THAT(found.reason, Catch::Matchers::ContainsSubstring("8 different poses give 24 numbers"));
}

TEST_CASE("Uncertainties hold of poses amid which a joint slipped", "[pose_estimate][pose_drift]") {
  Judged all;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const auto built = arm_with(tracker(0.001), seed);
    auto poses = built.poses(60);
    for (std::size_t i = poses.size() / 2; i < poses.size(); ++i)
      poses[i].sample.angles_rad[3] += 0.02 * kDegree;
    const auto found = identify::identify({}, built.campaign(), poses);
    INFO("seed " << seed);
    REQUIRE(found.poses);
    CHECK(found.poses->drift.seen);
    double parts = 0;
    for (const auto& part : found.poses->chain.parts) parts += part.covariance.trace();
    CHECK(parts == Approx(found.poses->chain.covariance.trace()).epsilon(1e-6));
    judge(built, found, all);
  }
  CHECK(all.farthest < 4);
}

TEST_CASE("Thirty poses are not few, whatever their gears do", "[pose_estimate]") {
  const auto built = arm_with(with_gears(10), 4);
  const auto found = identify::identify({}, built.campaign(), built.poses(30));
  CHECK(std::none_of(found.warnings.begin(), found.warnings.end(),
                     [](const Warning& warning) { return warning.code == "few_poses"; }));
}

TEST_CASE("Too few poses, and poses without anything to start from, are refused with the reason",
          "[pose_estimate]") {
  const auto built = arm_with(tracker(), 1);
  auto found = identify::identify({}, built.campaign(), built.poses(8));
  CHECK(found.status == Status::failed);
  CHECK_THAT(found.reason, Catch::Matchers::ContainsSubstring("8 poses give 24 numbers"));
  auto campaign = built.campaign();
  campaign.specified.reset();
  found = identify::identify({}, campaign, built.poses(40));
  CHECK(found.status == Status::failed);
  CHECK_THAT(found.reason, Catch::Matchers::ContainsSubstring("description"));
}

TEST_CASE("Poses all alike leave the table open, and say so", "[pose_estimate]") {
  const auto built = arm_with(tracker(), 1);
  const auto found = identify::identify({}, built.campaign(), built.poses(40, 0.5));
  CHECK(found.status != Status::complete);
  for (const auto& row : found.dh)
    for (const auto* number : numbers_of(row))
      if (number->knowledge == Knowledge::identified) CHECK(number->sigma < 1000);
}

TEST_CASE("A target on the last axis leaves that axis open, and no other", "[pose_estimate]") {
  auto robot = simulation::built(simulation::kr5(), 2);
  robot.targets_mm = {{0.1, 0, 215}};
  const simulation::Simulation built(robot, strokes(10), tracker(), 2);
  const auto found = identify::identify({}, built.campaign(), built.poses(60));
  CHECK(found.status == Status::partial);
  for (std::size_t j = 0; j < 5; ++j) CHECK(found.joints[j].axis);
  CHECK_FALSE(found.joints[5].axis);
  const bool said = std::any_of(found.warnings.begin(), found.warnings.end(), [](const auto& one) {
    return one.code == "target_near_axis" && one.joint == 5;
  });
  CHECK(said);
}
