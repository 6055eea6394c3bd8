#include "identify/poses/pose_drift.hpp"

#include <algorithm>
#include <cmath>

#include "identify/identification.hpp"
#include "tests/catch.hpp"
#include "tests/identify/poses/simulated_poses.hpp"

using namespace identify;
using namespace simulation::robots;

namespace {

/// As an arm that warms up: joint 2 comes to stand off by more and more.
std::vector<Pose> warming(std::vector<Pose> poses, double last_deg) {
  for (std::size_t i = 0; i < poses.size(); ++i)
    poses[i].sample.angles_rad[1] +=
        last_deg * kDegree * static_cast<double>(i) / static_cast<double>(poses.size());
  return poses;
}

}  // namespace

TEST_CASE("Poses of an arm that warms up are told, and by how much it moved",
          "[pose_drift][long]") {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const auto built = arm_with(tracker(0.001), seed);
    const auto poses = warming(built.poses(120), 0.02);
    const auto found = estimated(poses, built.campaign());
    REQUIRE(found);
    CHECK(found->drift.seen);
    // The middles of the halves are 0.01 deg apart, at a metre or so.
    CHECK(found->drift.moved_mm == Approx(0.01 * kDegree * 1100).epsilon(0.5));
  }
  const auto built = arm_with(tracker(0.001), 5);
  const auto whole = identify::identify({}, built.campaign(), warming(built.poses(120), 0.02));
  CHECK(std::any_of(whole.warnings.begin(), whole.warnings.end(),
                    [](const Warning& one) { return one.code == "poses_drift"; }));
}

TEST_CASE("Poses of an arm that stays as it is are not said to drift", "[pose_drift][long]") {
  int seen = 0;
  double sum = 0, numbers = 0;
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    const auto built = arm_with(tracker(seed % 2 == 0 ? 0.002 : 0), seed);
    const auto found = estimated(built.poses(80), built.campaign());
    REQUIRE(found);
    seen += found->drift.seen;
    sum += found->drift.chi_squared;
    numbers += found->drift.numbers;
  }
  CHECK(seen == 0);
  // Chi squared, three standard deviations of the sum; the sizes of the noise are found, too.
  CHECK(std::abs(sum - numbers) < 3 * std::sqrt(2 * numbers) + 0.05 * numbers);
}

TEST_CASE("Of few poses nobody can tell whether they drift", "[pose_drift]") {
  const auto built = arm_with(tracker(), 7);
  const auto found = estimated(warming(built.poses(20), 0.1), built.campaign());
  REQUIRE(found);
  CHECK_FALSE(found->drift.seen);
}
