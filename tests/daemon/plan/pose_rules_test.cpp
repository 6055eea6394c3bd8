#include "daemon/plan/pose_rules.hpp"

#include "daemon/settings/robot_description.hpp"
#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"

using namespace sweepd;
using sweepd::test::kConfig;

namespace {

identify::Arm kr5_arm() {
  return *load_robot(kConfig / "robots/kr5_arc.toml").arm;
}

std::vector<double> angles(std::vector<double> angles_deg) {
  for (double& angle : angles_deg) angle = radians(angle);
  return angles_deg;
}

Eigen::Vector3d target_at(const std::vector<double>& angles_rad) {
  const identify::Arm arm = kr5_arm();
  return forward_kinematics(arm, angles_rad) * arm.tool_mm;
}

Box box_about(const Eigen::Vector3d& middle, double half) {
  return {middle.array() - half, middle.array() + half};
}

const std::vector<double> kHome = angles({90, -90, 90, 0, 90, 0});
const std::vector<double> kAside = angles({20, -80, 80, 10, 60, 20});

}  // namespace

TEST_CASE("Without limits every pose is allowed", "[pose_rules]") {
  const PoseRules rules(kr5_arm(), {});
  CHECK_FALSE(rules.broken(kHome));
  CHECK_FALSE(rules.broken(kAside));
}

TEST_CASE("A box forbids poses whose target or forearm is in it, and no others", "[pose_rules]") {
  PoseLimits limits;
  limits.keep_out = {box_about(target_at(kAside), 30)};
  CHECK(PoseRules(kr5_arm(), limits).broken(kAside) == PoseRule::keep_out);
  CHECK_FALSE(PoseRules(kr5_arm(), limits).broken(kHome));
  // Between elbow and wrist: in the middle of the 620 mm behind the third axis.
  const identify::Arm arm = kr5_arm();
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (std::size_t j = 0; j < 3; ++j) frame = frame * transform(arm.row_at(j, kAside[j]));
  limits.keep_out = {box_about(frame * Eigen::Vector3d(0, 0, 310), 3)};
  CHECK(PoseRules(kr5_arm(), limits).broken(kAside) == PoseRule::keep_out);
}

TEST_CASE("Floor and column forbid what lies in them", "[pose_rules]") {
  PoseLimits limits;
  limits.floor_mm = target_at(kAside).z() + 1;
  CHECK(PoseRules(kr5_arm(), limits).in_the_way(kAside) == PoseRule::floor);
  limits.floor_mm = -2000;
  CHECK_FALSE(PoseRules(kr5_arm(), limits).in_the_way(kAside));
  // The arm folded back onto itself: the forearm hangs down beside axis 1.
  const auto folded = angles({90, -40, 150, 0, 90, 0});
  limits = {};
  limits.column_mm = 700;
  CHECK(PoseRules(kr5_arm(), limits).in_the_way(folded) == PoseRule::column);
  limits.column_mm = 1;
  CHECK_FALSE(PoseRules(kr5_arm(), limits).in_the_way(folded));
}

TEST_CASE("The reflector has to look at the device", "[pose_rules]") {
  PoseLimits limits;
  limits.arm_radius_mm = 0;
  limits.cone_deg = 20;
  const Eigen::Vector3d looks =
      forward_kinematics(kr5_arm(), kHome).linear() * Eigen::Vector3d::UnitZ();
  limits.device_mm = target_at(kHome) + 3000 * looks;
  CHECK_FALSE(PoseRules(kr5_arm(), limits).broken(kHome));
  limits.facing = -Eigen::Vector3d::UnitZ();
  CHECK(PoseRules(kr5_arm(), limits).broken(kHome) == PoseRule::cone);
  limits.cone_deg = 180;
  CHECK_FALSE(PoseRules(kr5_arm(), limits).broken(kHome));
}

TEST_CASE("The arm must not be between target and device", "[pose_rules]") {
  const Eigen::Vector3d target = target_at(kHome);
  PoseLimits limits;
  // Behind the base, at the height of the shoulder: the sight passes the upper arm.
  const Eigen::Vector3d shoulder(0, 0, 400);
  limits.device_mm = target + 3 * (shoulder - target);
  CHECK(PoseRules(kr5_arm(), limits).broken(kHome) == PoseRule::arm_between);
  limits.arm_radius_mm = 0;
  CHECK_FALSE(PoseRules(kr5_arm(), limits).broken(kHome));
}

TEST_CASE("A box on the way forbids the way, and a pose that home cannot reach", "[pose_rules]") {
  PoseLimits limits;
  std::vector<double> middle = kHome, far = kHome;
  middle[0] = radians(45);
  far[0] = 0;
  limits.keep_out = {box_about(target_at(middle), 40)};
  const PoseRules rules(kr5_arm(), limits);
  CHECK_FALSE(rules.in_the_way(kHome));
  CHECK_FALSE(rules.in_the_way(far));
  CHECK_FALSE(rules.free_way(kHome, far));
  CHECK(rules.broken(far) == PoseRule::way);
  std::vector<double> other = kHome;
  other[0] = radians(150);
  CHECK(rules.free_way(kHome, other));
}
