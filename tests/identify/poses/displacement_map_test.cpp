#include "identify/poses/displacement_map.hpp"

#include <algorithm>
#include <cmath>

#include "tests/catch.hpp"
#include "tests/identify/poses/simulated_poses.hpp"

using namespace identify;
using namespace simulation::robots;

namespace {

JointRanges wide(const Arm& arm) {
  JointRanges ranges;
  for (const double home : arm.home_rad) ranges.push_back({home - 1.5, home + 1.5});
  return ranges;
}

/// A fit that knows the arm as it is.
PoseFit exact(const PlacedArm& arm) {
  PoseFit fit;
  fit.model.chain = arm.chain();
  fit.model.home_rad = arm.arm.home_rad;
  fit.covariance = Eigen::MatrixXd::Zero(fit.model.parameters(), fit.model.parameters());
  return fit;
}

PlacedArm placed(const Arm& arm) {
  return {arm, Eigen::Isometry3d::Identity(), {arm.tool_mm}};
}

}  // namespace

TEST_CASE("An arm reaches what it is asked for, within its ranges", "[displacement_map]") {
  const Arm arm = simulation::kr5().arm;
  const ArmReach reach(arm, wide(arm));
  int reached = 0;
  for (double x = -1000; x <= 1000; x += 250)
    for (double z = 0; z <= 1500; z += 250) {
      const Eigen::Vector3d at(x, -500, z);
      const auto angles = reach.angles_at(at);
      if (!angles) continue;
      ++reached;
      CHECK((forward_kinematics(arm, *angles) * arm.tool_mm - at).norm() < 1e-3);
      for (std::size_t j = 0; j < 6; ++j)
        CHECK(std::abs((*angles)[j] - arm.home_rad[j]) <= 1.5 + 1e-12);
    }
  CHECK(reached > 20);
  CHECK_FALSE(reach.angles_at({5000, 0, 0}));
}

TEST_CASE("What base and tool can take up is no displacement", "[displacement_map]") {
  const Arm arm = simulation::kr5().arm;
  PlacedArm other = placed(arm);
  other.base = Eigen::Translation3d(3, -2, 5) *
               Eigen::AngleAxisd(0.01, Eigen::Vector3d(1, 2, 3).normalized());
  other.targets_mm.front() += Eigen::Vector3d(2, 1, -3);
  const auto map = displacement_map(exact(other), placed(arm), wide(arm));
  REQUIRE(map.grid.size() > 100);
  for (const auto& point : map.grid) CHECK(point.by_mm.norm() < 1e-4);
  for (const auto& slice : map.slices) CHECK(slice.points.size() > 20);
}

TEST_CASE("A longer forearm displaces the target, where as a plain fit has it",
          "[displacement_map]") {
  const Arm arm = simulation::kr5().arm;
  PlacedArm other = placed(arm);
  other.arm.rows[2].a_mm += 1;
  const PoseFit fit = exact(other);
  const auto map = displacement_map(fit, placed(arm), wide(arm));
  double most = 0;
  for (const auto& point : map.grid) most = std::max(most, point.by_mm.norm());
  CHECK(most > 0.1);
  CHECK(most < 2);
  // Base and tool of the specified arm fitted to the same poses by the level's own fit.
  const ArmReach reach(arm, wide(arm));
  std::vector<Pose> poses;
  for (const auto& point : map.grid) {
    Pose pose;
    const auto angles = reach.angles_at(point.at_mm);
    std::copy(angles->begin(), angles->end(), pose.sample.angles_rad.begin());
    pose.sample.joints = 6;
    pose.sample.position_mm = other.position_mm(0, pose.sample);
    poses.push_back(pose);
  }
  const PlacedArm fitted_arm =
      fitted(placed(arm), Freedom::frames, poses,
             Eigen::VectorXd::Ones(static_cast<Eigen::Index>(poses.size())));
  for (std::size_t k = 0; k < poses.size(); k += 17) {
    const Eigen::Vector3d by =
        poses[k].sample.position_mm - fitted_arm.position_mm(0, poses[k].sample);
    CHECK((fitted_arm.base.linear().transpose() * by - map.grid[k].by_mm).norm() < 1e-4);
  }
}

TEST_CASE("The band holds the true displacement", "[displacement_map][long]") {
  int inside = 0, count = 0;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const auto built = arm_with(tracker(), seed);
    const auto found = estimated(built.poses(40), built.campaign());
    REQUIRE(found);
    const PlacedArm& specified = found->levels.front().arm;
    const JointRanges ranges = wide(specified.arm);
    const auto map = displacement_map(found->fit, specified, ranges);
    PlacedArm truth{built.robot().arm, built.base(), built.robot().targets_mm};
    const auto true_map = displacement_map(exact(truth), specified, ranges);
    REQUIRE(map.grid.size() == true_map.grid.size());
    for (std::size_t k = 0; k < map.grid.size(); k += 7) {
      ++count;
      const double off = map.grid[k].by_mm.norm() - true_map.grid[k].by_mm.norm();
      if (std::abs(off) < map.grid[k].band_mm) ++inside;
    }
  }
  const double share = static_cast<double>(inside) / count;  // points of one arm go together
  CHECK(share > 0.85);
  CHECK(share < 0.995);
}
