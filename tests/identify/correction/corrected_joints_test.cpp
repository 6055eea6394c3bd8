#include "identify/correction/corrected_joints.hpp"

#include <cmath>

#include "tests/catch.hpp"
#include "tests/identify/poses/simulated_poses.hpp"

using namespace identify;
using namespace simulation::robots;

namespace {

struct Errors {
  double corrected = 0;
  double as_is = 0;
  double expected = 0;
  int count = 0;
  int refused = 0;

  [[nodiscard]] double rms(double squares) const { return std::sqrt(squares / count); }
};

/// How far the true arm's target is from where the controller believes it to be, squared, before
/// and after; by the poses of `asked`, each joint as told.
void add_errors(const simulation::Simulation& of, const PoseEstimate& found,
                const std::vector<Pose>& asked, Errors& errors) {
  const PlacedArm& controller = found.levels.front().arm;
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
  tool.translation() = controller.targets_mm.front();
  const CorrectedJoints corrected(found.fit, controller, tool);
  CHECK(corrected.from_target_mm() == Approx(0).margin(1e-9));
  const auto truly = [&](const std::vector<double>& angles) {
    return Eigen::Vector3d(
        of.base() *
        by_table({of.robot().specified, of.arm_at(angles), of.robot().targets_mm, {}, {}}, angles));
  };
  for (const Pose& pose : asked) {
    const auto angles = angles_of(pose.sample);
    const Eigen::Vector3d wanted = corrected.believed(angles).translation();
    const auto reached = corrected.reach(angles);
    if (!reached.converged) {  // near a singular pose
      ++errors.refused;
      continue;
    }
    errors.as_is += (truly(angles) - wanted).squaredNorm();
    errors.corrected += (truly(reached.angles_rad) - wanted).squaredNorm();
    errors.expected += reached.expected_mm * reached.expected_mm;
    ++errors.count;
  }
}

double noise_mm() {
  return std::sqrt(3.0) * 0.02;  // of the tracker's three coordinates
}

}  // namespace

TEST_CASE("Corrected joints put the tool where it is wanted", "[corrected_joints][long]") {
  Errors errors;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const auto built = arm_with(tracker(), seed);
    const auto found = estimated(built.poses(60), built.campaign());
    REQUIRE(found);
    add_errors(built, *found, built.poses(50, 60), errors);
  }
  INFO("as is " << errors.rms(errors.as_is) << ", corrected " << errors.rms(errors.corrected)
                << ", refused " << errors.refused);
  CHECK(errors.refused <= errors.count / 20);
  CHECK(errors.rms(errors.as_is) > 0.5);
  CHECK(errors.rms(errors.corrected) <= 1.2 * noise_mm());
  // What is expected holds the noise of a pose too.
  CHECK(errors.rms(errors.expected) ==
        Approx(std::hypot(errors.rms(errors.corrected), noise_mm())).epsilon(0.15));
}

TEST_CASE("A seven-axis arm's joints are corrected by the least motion",
          "[corrected_joints][long]") {
  Errors errors;
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const simulation::Simulation built(
        simulation::at_random_home(simulation::built(simulation::iiwa(), seed), seed), strokes(10),
        tracker(), seed);
    const auto found = estimated(built.poses(80), built.campaign());
    REQUIRE(found);
    add_errors(built, *found, built.poses(50, 60), errors);
  }
  INFO("as is " << errors.rms(errors.as_is) << ", corrected " << errors.rms(errors.corrected)
                << ", refused " << errors.refused);
  CHECK(errors.refused <= errors.count / 20);
  CHECK(errors.rms(errors.as_is) > 0.5);
  CHECK(errors.rms(errors.corrected) <= 1.2 * noise_mm());
}

TEST_CASE("What the joints do beside their angles is corrected", "[corrected_joints][long]") {
  auto world = tracker();
  world.gears = {60, 0, 0, {}, 3};
  const auto built = arm_with(world, 3);
  const auto asked = built.poses(50, 60);
  auto found = estimated(built.poses(100), built.campaign());
  REQUIRE(found);
  CHECK_FALSE(found->effects.empty());
  Errors with, without;
  add_errors(built, *found, asked, with);
  CHECK(with.rms(with.corrected) <= 1.2 * noise_mm());
  for (auto& effect : found->fit.model.effects) effect.size.setZero();
  add_errors(built, *found, asked, without);
  CHECK(without.corrected > 2 * with.corrected);
}

TEST_CASE("An arm as specified needs no correction, whatever the tool", "[corrected_joints]") {
  const Arm arm = simulation::kr5().specified;
  const PlacedArm placed{
      arm, Eigen::Isometry3d(Eigen::Translation3d(100, 200, 300)), {Eigen::Vector3d(200, 0, 215)}};
  PoseFit fit;
  fit.model.chain = placed.chain();
  fit.model.home_rad = arm.home_rad;
  fit.covariance = Eigen::MatrixXd::Zero(fit.model.parameters(), fit.model.parameters());
  fit.noise.position_mm = 0.01;
  Eigen::Isometry3d tool(Eigen::Translation3d(-30, 40, 300));
  tool.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const CorrectedJoints corrected(fit, placed, tool);
  std::vector<double> angles = arm.home_rad;
  angles[0] += 0.3;
  angles[4] -= 0.4;
  CHECK((corrected.identified(angles).matrix() - corrected.believed(angles).matrix()).norm() <
        1e-9);
  const auto reached = corrected.reach(angles);
  REQUIRE(reached.converged);
  for (std::size_t j = 0; j < 6; ++j)
    CHECK(reached.angles_rad[j] == Approx(angles[j]).margin(1e-10));
  CHECK(reached.expected_mm == Approx(0.01 * std::sqrt(3)));
}
