#include "identify/dh/dh.hpp"

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"

using Eigen::Vector3d;
using identify::kDegree;

TEST_CASE("a DH row moves along Z and X and turns about them, in this order", "[dh]") {
  // Turning by 90 deg about Z puts X_i+1 on Y_i; the twist of 90 deg then puts Z_i+1 on X_i.
  const auto frame = identify::transform({400.0, 90 * kDegree, 180.0, 90 * kDegree});
  CHECK((frame.translation() - Vector3d(0, 180, 400)).norm() < 1e-12);
  CHECK((frame.linear() * Vector3d::UnitX() - Vector3d::UnitY()).norm() < 1e-12);
  CHECK((frame.linear() * Vector3d::UnitZ() - Vector3d::UnitX()).norm() < 1e-12);
}

TEST_CASE("the controller's angles turn a joint from its home in its own direction", "[dh]") {
  identify::Arm arm;
  arm.rows = {{0, 0, 100, 0}};
  arm.home_rad = {30 * kDegree};
  arm.positive = {-1};
  arm.tool_mm = Vector3d::Zero();
  const Vector3d at_home = forward_kinematics(arm, {30 * kDegree}) * arm.tool_mm;
  CHECK((at_home - Vector3d(100, 0, 0)).norm() < 1e-12);
  const Vector3d turned = forward_kinematics(arm, {120 * kDegree}) * arm.tool_mm;
  CHECK((turned - Vector3d(0, -100, 0)).norm() < 1e-12);
}
