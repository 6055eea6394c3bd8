#include "identify/geometry/line.hpp"

#include <cmath>
#include <random>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"

using Eigen::Vector3d;
using identify::across;
using identify::Line;

TEST_CASE("a line is the same whatever point of it is given", "[line]") {
  const Vector3d direction(1, -2, 0.5);
  const Vector3d point(100, 200, -300);
  const auto one = Line::through(point, direction);
  const auto other = Line::through(point + 7.5 * direction, 3 * direction);
  CHECK((one.direction - other.direction).norm() < 1e-14);
  CHECK((one.moment_mm - other.moment_mm).norm() < 1e-10);
  CHECK(std::abs(one.point_mm().dot(one.direction)) < 1e-10);
  CHECK((one.closest_mm(point) - point).norm() < 1e-10);
  CHECK((one.reversed().point_mm() - one.point_mm()).norm() < 1e-12);
}

TEST_CASE("twist, distance and feet of two skew lines, for any placing of them", "[line]") {
  std::mt19937 random(3);
  std::uniform_real_distribution<> uniform(-1, 1);
  const auto vector = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  for (int run = 0; run < 200; ++run) {
    const Eigen::AngleAxisd turn(3 * uniform(random), vector().normalized());
    const Vector3d shift = 1000 * vector();
    const double twist = 0.01 + 1.5 * std::abs(uniform(random));
    const double distance = 500 * uniform(random);
    // The first along Z, the second `distance` along X of it, turned by `twist` about X.
    const auto first = Line::through(shift + turn * Vector3d(0, 0, 77), turn * Vector3d::UnitZ());
    const Vector3d second_direction =
        Eigen::AngleAxisd(twist, Vector3d::UnitX()) * Vector3d::UnitZ();
    const auto second = Line::through(
        shift + turn * (Vector3d(distance, 0, 0) + 50 * second_direction), turn * second_direction);
    const auto pair = relate(first, second);
    CHECK(pair.angle_rad == Approx(twist).margin(1e-12));
    CHECK(pair.distance_mm == Approx(distance).margin(1e-8));
    CHECK((pair.first_foot_mm - shift).norm() < 1e-6);
    CHECK((pair.second_foot_mm - (shift + turn * Vector3d(distance, 0, 0))).norm() < 1e-6);
    const auto product = dot(first, second);
    CHECK(product.real == Approx(std::cos(twist)).margin(1e-12));
    CHECK(product.dual == Approx(-distance * std::sin(twist)).margin(1e-8));
  }
}

TEST_CASE("parallel lines have a distance and no feet", "[line]") {
  const auto pair =
      relate(Line::through({0, 0, 0}, {0, 0, 1}), Line::through({3, 4, 9}, {0, 0, -2}));
  CHECK(pair.sine == 0);
  CHECK(pair.angle_rad == Approx(identify::kPi));
  CHECK(pair.distance_mm == Approx(5));
}

TEST_CASE("a small twist is not lost, as it would be by acos", "[line]") {
  const auto pair =
      relate(Line::through({0, 0, 0}, {0, 0, 1}), Line::through({1, 0, 0}, {0, 1e-9, 1}));
  CHECK(pair.angle_rad == Approx(1e-9).epsilon(1e-6));
}

TEST_CASE("directions across an axis change as little as it does, near Z, too", "[line]") {
  std::mt19937 random(27);
  std::normal_distribution<> normal;
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0, -1),
                                      Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0)})
    for (int k = 0; k < 20; ++k) {
      const double little = 1e-6;
      const Eigen::Vector3d other =
          (axis + little * Eigen::Vector3d(normal(random), normal(random), normal(random)))
              .normalized();
      CHECK((across(other) - across(axis)).norm() < 10 * little);
      CHECK((across(other).transpose() * other).norm() < 1e-12);
      CHECK(across(other).col(0).cross(across(other).col(1)).dot(other) == Approx(1));
    }
}
