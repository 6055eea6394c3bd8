#include "identify/chain/chain.hpp"

#include <array>
#include <cmath>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"

using namespace identify;
using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using identify::test::Random;
using identify::test::random_chain;

namespace {

Turns random_turns(std::size_t joints, Random& random) {
  Turns turns{};
  // Also small ones, where sine and cosine come from a series, and none at all.
  for (std::size_t j = 0; j < joints; ++j)
    turns[j] = random.uniform(-3, 3) * std::array{1.0, 1e-2, 3e-3, 1e-5, 0.0}[(j + joints) % 5];
  return turns;
}

/// Position and rotation vector of one pose seen from another close by.
Eigen::Matrix<double, 6, 1> between(const Eigen::Isometry3d& from, const Vector3d& from_mm,
                                    const Eigen::Isometry3d& to, const Vector3d& to_mm,
                                    const Matrix3d& from_tool, const Matrix3d& to_tool) {
  const Matrix3d turned = to.linear() * to_tool * (from.linear() * from_tool).transpose();
  Eigen::Matrix<double, 6, 1> difference;
  difference << to_mm - from_mm, 0.5 * (turned(2, 1) - turned(1, 2)),
      0.5 * (turned(0, 2) - turned(2, 0)), 0.5 * (turned(1, 0) - turned(0, 1));
  return difference;
}

}  // namespace

TEST_CASE("A pose's derivatives are those of central differences, for arms of 1 to 12 joints",
          "[chain]") {
  Random random(7);
  // Differences of step h are off by h^2 / 6 third derivatives (2000 mm: 3e-8) and by the rounding
  // of 2000 mm over h (2000 * 2e-16 * some ten operations / 1e-5: 4e-7).
  constexpr double kStep = 1e-5;
  constexpr double kTolerance = 2e-6;
  for (std::size_t joints = 1; joints <= kMostJoints; ++joints) {
    CAPTURE(joints);
    const Chain chain = random_chain(joints, 2, random);
    const ChainParameters parameters{joints, 2};
    const Turns turns = random_turns(joints, random);
    ChainPose pose(chain);
    const std::size_t target = joints % 2;
    pose.set(target, turns, true);
    const Eigen::Isometry3d exact = chain.displacement(turns);
    // Products of up to twelve rotations of vectors of up to some thousand millimetres.
    CHECK((pose.position_mm - chain.target_mm(target, turns)).norm() < 1e-10);
    CHECK((pose.rotation - exact.linear()).norm() < 1e-14 * static_cast<double>(joints + 1));

    for (std::size_t j = 0; j < joints; ++j) {
      CAPTURE(j);
      Turns more = turns, less = turns;
      more[j] += kStep;
      less[j] -= kStep;
      const auto by =
          between(chain.displacement(less), chain.target_mm(target, less), chain.displacement(more),
                  chain.target_mm(target, more), chain.tool, chain.tool);
      CHECK((by / (2 * kStep) - pose.by_turn[j]).cwiseAbs().maxCoeff() < kTolerance);
    }
    for (Index p = 0; p < parameters.count(true); ++p) {
      CAPTURE(p);
      const bool other_target =
          p >= parameters.target(1 - target) && p < parameters.target(1 - target) + 3;
      if (other_target) continue;
      Eigen::VectorXd change = Eigen::VectorXd::Zero(parameters.count(true));
      change(p) = kStep;
      const Chain more = moved(chain, change);
      const Chain less = moved(chain, -change);
      const auto by =
          between(less.displacement(turns), less.target_mm(target, turns), more.displacement(turns),
                  more.target_mm(target, turns), less.tool, more.tool);
      CHECK((by / (2 * kStep) - pose.by_parameter.col(p)).cwiseAbs().maxCoeff() < kTolerance);
    }
  }
}

TEST_CASE("A chain that is moved there and back is the same to second order", "[chain]") {
  Random random(8);
  const Chain chain = random_chain(6, 2, random);
  const ChainParameters parameters{6, 2};
  constexpr double kSize = 1e-6;
  Eigen::VectorXd change(parameters.count(true));
  for (Index p = 0; p < change.size(); ++p) change(p) = random.normal(kSize);
  const Chain there = moved(chain, change);
  // `across` differs at the other end by the angle turned, so that what comes back is off by its
  // square, and for directions close to where `across` turns over by some of those.
  const Eigen::VectorXd left = test::difference(chain, moved(there, -change));
  CHECK(left.cwiseAbs().maxCoeff() < 100 * kSize * kSize);
  CHECK((test::difference(chain, there) - change).cwiseAbs().maxCoeff() < 100 * kSize * kSize);
  CHECK((change_between(chain, there) - change).cwiseAbs().maxCoeff() < 100 * kSize * kSize);
  for (const ChainAxis& axis : there.axes) CHECK(std::abs(axis.direction.norm() - 1) < 1e-15);
}

TEST_CASE("The two directions across an axis are a right-handed frame with it", "[chain]") {
  Random random(9);
  for (int k = 0; k < 100; ++k) {
    const Vector3d direction = random.direction();
    Matrix3d frame;
    frame << across(direction), direction;
    CHECK((frame.transpose() * frame - Matrix3d::Identity()).norm() < 1e-15 * 10);
    CHECK(frame.determinant() > 0);
  }
}
