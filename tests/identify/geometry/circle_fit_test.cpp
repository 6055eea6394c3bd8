#include "identify/geometry/circle_fit.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using identify::fit_circle;
using identify::kDegree;
using namespace identify;
using Eigen::Index;
using identify::test::Random;

namespace {

/// Points of a circle about `axis` through `center`, from angle 0 on, with isotropic noise.
Matrix3Xd arc(const Vector3d& center, const Vector3d& axis, double radius, double degrees,
              int count, double sigma = 0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<> normal(0, 1);
  const Vector3d x = axis.unitOrthogonal();
  Matrix3Xd points(3, count);
  for (int i = 0; i < count; ++i) {
    const double angle = degrees * kDegree * i / (count - 1);
    points.col(i) = center + radius * (Eigen::AngleAxisd(angle, axis.normalized()) * x);
    for (int k = 0; k < 3; ++k) points(k, i) += sigma * normal(random);
  }
  return points;
}

const Vector3d kCenter(812.3, -40, 1000);
const Vector3d kAxis = Vector3d(1, 2, -3).normalized();

}  // namespace

TEST_CASE("a circle without noise is found exactly, for any arc and radius", "[circle_fit]") {
  for (const double degrees : {15.0, 30.0, 90.0, 360.0})
    for (const double radius : {1.0, 800.0}) {
      const auto fit = fit_circle(arc(kCenter, kAxis, radius, degrees, 200));
      REQUIRE(fit);
      CHECK((fit->center_mm - kCenter).norm() < 1e-8);
      CHECK((fit->normal - kAxis).norm() < 1e-9);
      CHECK(fit->radius_mm == Approx(radius).epsilon(1e-9));
      CHECK(fit->arc_rad == Approx(degrees * kDegree).epsilon(1e-6));
      CHECK(fit->plane_rms_mm < 1e-9);
      CHECK(fit->radial_rms_mm < 1e-9);
    }
}

TEST_CASE("the normal follows the motion, also where first and last point tell nothing",
          "[circle_fit]") {
  Matrix3Xd there = arc(kCenter, kAxis, 500, 60, 61);
  CHECK(fit_circle(there)->normal.dot(kAxis) == Approx(1));
  CHECK(fit_circle(there.rowwise().reverse())->normal.dot(kAxis) == Approx(-1));
  // More than half a turn: the chord from first to last points backwards.
  CHECK(fit_circle(arc(kCenter, kAxis, 500, 300, 301))->normal.dot(kAxis) == Approx(1));
  // There by 60 degrees and back by 20.
  Matrix3Xd both(3, 81);
  both << there, there.middleCols(40, 20).rowwise().reverse();
  CHECK(fit_circle(both)->normal.dot(kAxis) == Approx(1));
}

TEST_CASE("what is no circle gives none", "[circle_fit]") {
  CHECK_FALSE(fit_circle(Matrix3Xd(3, 0)));
  CHECK_FALSE(fit_circle(arc(kCenter, kAxis, 500, 60, 3)));
  CHECK_FALSE(fit_circle(Matrix3Xd::Zero(3, 50)));
  Matrix3Xd line(3, 50);
  for (int i = 0; i < 50; ++i) line.col(i) = Vector3d(1, 2, 3) * i;
  CHECK_FALSE(fit_circle(line));
  Matrix3Xd bad = arc(kCenter, kAxis, 500, 60, 50);
  bad(1, 7) = std::nan("");
  CHECK_FALSE(fit_circle(bad));
}

TEST_CASE("the predicted covariance is the scatter that noise causes", "[circle_fit]") {
  // 400 fits at sigma = 0.02 mm: a sample variance is then within +-7 % (1 sigma) of the truth, and
  // the mean of the six ratios is within 15 %.
  constexpr double kSigma = 0.02;
  constexpr int kRuns = 400;
  for (const double degrees : {90.0, 30.0}) {
    const auto clean = arc(kCenter, kAxis, 600, degrees, 300);
    const auto truth = fit_circle(clean);
    const auto predicted = identify::axis_covariance(*truth, clean, kSigma, kSigma);
    identify::Matrix6d scatter = identify::Matrix6d::Zero();
    for (int run = 0; run < kRuns; ++run) {
      const auto fit = fit_circle(
          arc(kCenter, kAxis, 600, degrees, 300, kSigma, 1000U + static_cast<unsigned>(run)));
      Eigen::Matrix<double, 6, 1> error;
      error << fit->normal - kAxis, fit->center_mm - kCenter;
      scatter += error * error.transpose() / kRuns;
    }
    CHECK(scatter.topLeftCorner<3, 3>().trace() / predicted.topLeftCorner<3, 3>().trace() ==
          Approx(1).margin(0.15));
    CHECK(scatter.bottomRightCorner<3, 3>().trace() / predicted.bottomRightCorner<3, 3>().trace() ==
          Approx(1).margin(0.15));
  }
}

TEST_CASE("a target close to the axis is seen in the covariance, not in the residuals",
          "[circle_fit]") {
  const auto far = arc(kCenter, kAxis, 200, 90, 1000, 0.003);
  const auto near = arc(kCenter, kAxis, 1.7, 90, 1000, 0.003);
  const auto far_fit = fit_circle(far);
  const auto near_fit = fit_circle(near);
  CHECK(near_fit->plane_rms_mm < 1.1 * far_fit->plane_rms_mm);
  const auto direction = [](const identify::CircleFit& fit, const Matrix3Xd& points) {
    const identify::Matrix6d covariance = identify::axis_covariance(fit, points, 0.003, 0.003);
    return std::sqrt(covariance.topLeftCorner<3, 3>().trace());
  };
  CHECK(direction(*near_fit, near) > 50 * direction(*far_fit, far));
}

TEST_CASE("residuals are heights over the plane and distances from the circle", "[circle_fit]") {
  const auto fit = fit_circle(arc({0, 0, 5}, Vector3d::UnitZ(), 100, 180, 50));
  const auto residual = identify::residual(*fit, {0, 103, 7});
  CHECK(std::abs(residual.plane_mm) == Approx(2));
  CHECK(residual.radial_mm == Approx(3));
}

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
          "[circle_fit]") {
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
          "[circle_fit]") {
  Random random(12);
  const double noise_mm = GENERATE(0.02, 0.2);  // sure at once, and after a search
  const Arc arc = random_arc(300, noise_mm, random);
  const auto robust = fit_robust_circle(arc.points);
  const auto plain = fit_circle(arc.points);
  REQUIRE(robust.has_value());
  CHECK(robust->points == plain->points);
  CHECK(robust->radius_mm == plain->radius_mm);
  CHECK(robust->normal.dot(arc.normal) > 0.999);
}

TEST_CASE("The usual circle is the plain one of all points but those far off", "[circle_fit]") {
  Random random(14);
  for (const Index count : {9, 60, 600}) {
    Arc arc = random_arc(count, 0.02, random);
    const auto plain = fit_circle(arc.points);
    const auto same = fit_usual_circle(arc.points);
    REQUIRE(same.has_value());
    CHECK(same->circle.points == plain->points);
    CHECK(same->circle.radius_mm == plain->radius_mm);
    CHECK(std::isinf(same->within_mm));
    arc.points.col(count / 3) += Vector3d(150, -60, 80);
    const auto usual = fit_usual_circle(arc.points);
    REQUIRE(usual.has_value());
    CHECK(static_cast<Index>(usual->circle.points) == count - 1);
    CHECK(std::abs(usual->circle.radius_mm - plain->radius_mm) < 3);
    CHECK(usual->circle.normal.dot(arc.normal) > 0.999);
  }
  CHECK_FALSE(fit_usual_circle(Matrix3Xd::Zero(3, 50)));
}

TEST_CASE("how certain a circle is beyond its arc is what arcs scatter by there", "[circle_fit]") {
  constexpr double kNoise = 0.02, kSmall_mm = 300;
  for (const double beyond_deg : {0.0, 60.0, 160.0}) {
    const Vector3d place =
        arc(kCenter, kAxis, kSmall_mm, 30 + beyond_deg, 2).col(1);  // as far from the arc's end
    double plane = 0, radial = 0, sigma = 0;
    constexpr unsigned kRuns = 300;
    for (unsigned seed = 1; seed <= kRuns; ++seed) {
      const Matrix3Xd points = arc(kCenter, kAxis, kSmall_mm, 30, 100, kNoise, seed);
      const auto fit = fit_circle(points);
      REQUIRE(fit);
      const CircleResidual off = residual(*fit, place);
      plane += off.plane_mm * off.plane_mm / kRuns;
      radial += off.radial_mm * off.radial_mm / kRuns;
      sigma += CircleCovariance(*fit, points, kNoise, kNoise).sigma_mm(place) / kRuns;
    }
    INFO(beyond_deg);
    CHECK(std::sqrt(std::max(plane, radial)) == Approx(sigma).epsilon(0.1));
  }
  // Of 3 degrees noise hides the bend.
  const Matrix3Xd points = arc(kCenter, kAxis, kSmall_mm, 3, 100, kNoise);
  const auto fit = fit_circle(points);
  REQUIRE(fit);
  CHECK(std::isinf(CircleCovariance(*fit, points, kNoise, kNoise).sigma_mm(kCenter)));
}

TEST_CASE("Points that make no circle have no robust one either", "[circle_fit]") {
  CHECK_FALSE(fit_robust_circle(Matrix3Xd(3, 0)));
  CHECK_FALSE(fit_robust_circle(Matrix3Xd::Zero(3, 50)));
  Matrix3Xd line(3, 50);
  for (Index i = 0; i < 50; ++i) line.col(i) = static_cast<double>(i) * Vector3d(1, 2, 3);
  CHECK_FALSE(fit_robust_circle(line));
  line(1, 7) = std::nan("");
  CHECK_FALSE(fit_robust_circle(line));
}

TEST_CASE("Exact points give the exact circle", "[circle_fit]") {
  Random random(13);
  const Arc arc = random_arc(100, 0, random);
  const auto circle = fit_robust_circle(arc.points);
  REQUIRE(circle.has_value());
  // The coordinates are rounded at 1000 mm: 1e-13, times the arc's amplification of some hundred.
  CHECK((circle->center_mm - arc.center).norm() < 1e-9);
  CHECK(circle->points >= 50);
}
