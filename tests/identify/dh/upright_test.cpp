#include "identify/dh/upright.hpp"

#include "tests/catch.hpp"
#include "tests/simulation/robot.hpp"

using namespace identify;
using Eigen::Vector3d;

namespace {

/// The directions of an arm that a device sees, itself standing askew.
std::vector<std::optional<Vector3d>> seen(const Chain& chain, const Eigen::Matrix3d& device) {
  std::vector<std::optional<Vector3d>> directions;
  for (const ChainAxis& axis : chain.axes) directions.emplace_back(device * axis.direction);
  return directions;
}

const Eigen::Matrix3d kAskew =
    Eigen::AngleAxisd(1.1, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();

}  // namespace

TEST_CASE("Axes tell a device which way is up, however the robot is mounted", "[upright]") {
  const auto robot = simulation::built(simulation::kr5(), 1);
  auto directions = seen(simulation::chain_of(robot), kAskew);
  directions[0].reset();  // the others tell it, too
  for (const Vector3d& up : {Vector3d(0, 0, 1), Vector3d(0, 0, -1), Vector3d(0.6, -0.8, 0)}) {
    const auto found = up_among(directions, robot.specified, up);
    REQUIRE(found);
    CHECK(found->dot(kAskew * up) > 0.99999);  // 0.26 degrees: the arm is not as specified
  }
}

TEST_CASE("Parallel axes tell what lies along them, and no more", "[upright]") {
  const auto robot = simulation::kr5();
  auto directions = seen(simulation::chain_of(robot), kAskew);
  for (const std::size_t j : {0U, 3U, 4U, 5U}) directions[j].reset();
  const Vector3d axis = *directions[1] * robot.arm.positive[1];  // along Z of its row
  const Eigen::Matrix3d row = transform(robot.specified.rows[0]).linear();
  CHECK(up_among(directions, robot.specified, row.col(2)).value().isApprox(axis, 1e-6));
  CHECK(up_among(directions, robot.specified, -row.col(2)).value().isApprox(-axis, 1e-6));
  CHECK_FALSE(up_among(directions, robot.specified, Vector3d::UnitZ()));
  CHECK_FALSE(up_among(std::vector<std::optional<Vector3d>>(6), robot.specified, axis));
}
