#include "identify/correction/wrist_arm.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/simulation/robot.hpp"

using namespace identify;

namespace {

/// With an offset of the forearm, and axes 2 and 3 beside axis 1.
Arm with_offsets() {
  Arm arm = simulation::kr5().specified;
  arm.rows[1].a_mm = 680;
  arm.rows[2].a_mm = -41;
  arm.rows[2].b_mm = 30;
  arm.rows[5].b_mm = 158;
  return arm;
}

Eigen::Isometry3d last_frame(const Arm& arm, const WristArm::Angles& angles) {
  return forward_kinematics(arm, {angles.begin(), angles.end()});
}

}  // namespace

TEST_CASE("Pose and posture give the joints back, in each of the eight", "[wrist_arm]") {
  std::mt19937 random(1);
  std::uniform_real_distribution<> anywhere(-kPi, kPi);
  for (const Arm& arm : {simulation::kr5().specified, with_offsets()}) {
    const auto wrist_arm = WristArm::of(arm);
    REQUIRE(wrist_arm);
    std::array<int, 8> seen{};
    double most_mm = 0, most_rad = 0, most_joint = 0;
    for (int i = 0; i < 4000; ++i) {
      WristArm::Angles angles;
      for (double& angle : angles) angle = anywhere(random);
      const auto pose = last_frame(arm, angles);
      const Posture posture = wrist_arm->posture(angles);
      ++seen[static_cast<std::size_t>(posture.overhead + 2 * posture.bent_up +
                                      4 * posture.flipped)];
      const auto found = wrist_arm->angles_at(pose, posture);
      REQUIRE(found);
      CHECK(wrist_arm->posture(*found) == posture);
      const auto again = last_frame(arm, *found);
      // Of a point that is 300 mm off the last frame's origin.
      const Eigen::Vector3d tool(200, 0, 224);
      most_mm = std::max(most_mm, (again * tool - pose * tool).norm());
      most_rad = std::max(most_rad, (again.linear() - pose.linear()).norm());
      if (wrist_arm->from_singular_rad(angles) > 0.02)
        for (std::size_t j = 0; j < 6; ++j)
          most_joint =
              std::max(most_joint, std::abs(std::remainder((*found)[j] - angles[j], 2 * kPi)));
    }
    CHECK(most_mm < 1e-6);
    CHECK(most_rad < 1e-8);
    CHECK(most_joint < 1e-5);  // near the stretched arm joints are known to the root of rounding
    for (const int count : seen) CHECK(count > 50);
  }
}

TEST_CASE("The postures are those of KUKA's status", "[wrist_arm]") {
  const auto arm = WristArm::of(simulation::kr5().specified);
  REQUIRE(arm);
  const auto at = [&](double a1, double a2, double a3, double a5) {
    return arm->posture({a1 * kDegree, a2 * kDegree, a3 * kDegree, 0, a5 * kDegree, 0});
  };
  CHECK(at(30, -90, 90, 20) == Posture{false, true, false});
  CHECK(at(30, -90, 90, -20) == Posture{false, true, true});
  CHECK(at(30, -170, 60, 20).overhead);  // leans back over axis 1
  CHECK_FALSE(at(30, -60, -15, 20).bent_up);
}

TEST_CASE("Out of reach there are no joints, and another kind of arm is none", "[wrist_arm]") {
  const Arm kr5 = simulation::kr5().specified;
  const auto arm = WristArm::of(kr5);
  REQUIRE(arm);
  Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
  far.translation() << 3000, 0, 500;
  CHECK_FALSE(arm->angles_at(far, {}));
  Arm skew = kr5;
  skew.rows[1].alpha_rad = 1e-3;
  CHECK_FALSE(WristArm::of(skew));
  Arm no_wrist = kr5;
  no_wrist.rows[4].b_mm = 80;
  CHECK_FALSE(WristArm::of(no_wrist));
  CHECK_FALSE(WristArm::of(simulation::iiwa().specified));
}
