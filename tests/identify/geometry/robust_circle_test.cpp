#include "identify/geometry/robust_circle.hpp"

#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"

using namespace identify;
using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using identify::test::Random;

namespace {

constexpr double kRadius = 400;

struct Arc {
  Vector3d normal, center;
  Matrix3Xd points;
};

/// An arc of 80 degrees, with noise.
Arc random_arc(Index count, double noise_mm, Random& random) {
  Arc arc{random.direction(), random.vector(500), Matrix3Xd(3, count)};
  const Vector3d first = arc.normal.unitOrthogonal();
  const Vector3d second = arc.normal.cross(first);
  for (Index i = 0; i < count; ++i) {
    const double angle = 1.4 * static_cast<double>(i) / static_cast<double>(count - 1);
    arc.points.col(i) = arc.center +
                        kRadius * (std::cos(angle) * first + std::sin(angle) * second) +
                        random.vector(noise_mm);
  }
  return arc;
}

}  // namespace

TEST_CASE("With 45 % of its points anywhere a circle is found as from the good ones",
          "[robust_circle]") {
  Random random(11);
  constexpr double kNoise = 0.02;
  constexpr Index kCount = 600;
  for (int round = 0; round < 20; ++round) {
    CAPTURE(round);
    Arc arc = random_arc(kCount, kNoise, random);
    for (Index i = 0; i < kCount; ++i)
      if (random.uniform(0, 1) < 0.45) arc.points.col(i) = random.vector(1000);
    const auto circle = fit_robust_circle(arc.points);
    REQUIRE(circle.has_value());
    // 330 points over 80 degrees: the direction is uncertain by about 0.02 mm / (400 mm * 0.09 *
    // sqrt(330)) = 3e-5, the radius by a few times 0.02 mm / (0.04 * sqrt(330)) = 0.03 mm.
    CHECK(circle->normal.cross(arc.normal).norm() < 3e-4);
    CHECK(std::abs(circle->radius_mm - kRadius) < 0.2);
    CHECK((circle->center_mm - arc.center).norm() < 0.3);
  }
}

TEST_CASE("Without outliers the robust circle is the plain one, with the motion's direction",
          "[robust_circle]") {
  Random random(12);
  const Arc arc = random_arc(300, 0.02, random);
  const auto robust = fit_robust_circle(arc.points);
  const auto plain = fit_circle(arc.points);
  REQUIRE(robust.has_value());
  CHECK(robust->points == plain->points);
  CHECK(robust->radius_mm == plain->radius_mm);
  CHECK(robust->normal.dot(arc.normal) > 0.999);
}

TEST_CASE("Points that make no circle have no robust one either", "[robust_circle]") {
  CHECK_FALSE(fit_robust_circle(Matrix3Xd(3, 0)));
  CHECK_FALSE(fit_robust_circle(Matrix3Xd::Zero(3, 50)));
  Matrix3Xd line(3, 50);
  for (Index i = 0; i < 50; ++i) line.col(i) = static_cast<double>(i) * Vector3d(1, 2, 3);
  CHECK_FALSE(fit_robust_circle(line));
  line(1, 7) = std::nan("");
  CHECK_FALSE(fit_robust_circle(line));
}

TEST_CASE("Exact points give the exact circle", "[robust_circle]") {
  Random random(13);
  const Arc arc = random_arc(100, 0, random);
  const auto circle = fit_robust_circle(arc.points);
  REQUIRE(circle.has_value());
  // The coordinates are rounded at 1000 mm: 1e-13, times the arc's amplification of some hundred.
  CHECK((circle->center_mm - arc.center).norm() < 1e-9);
  CHECK(circle->points >= 50);
}
