#include "identify/geometry/box_search.hpp"

#include <cmath>
#include <random>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using identify::BoxSearch;
using identify::search_box;
using PointRows = Eigen::Matrix<double, Eigen::Dynamic, 3>;

namespace {

PointRows random_points(Index count, const Vector3d& scale, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  return PointRows::NullaryExpr(count, 3, [&] { return normal(random); }) * scale.asDiagonal();
}

// A cylinder: thousands of boxes about it are all but equally small.
PointRows cylinder(Index count) {
  PointRows points(2 * count, 3);
  for (Index i = 0; i < count; ++i) {
    const double angle = 2 * identify::kPi * static_cast<double>(i) / static_cast<double>(count);
    points.row(2 * i) << std::cos(angle), std::sin(angle), 0.1;
    points.row(2 * i + 1) << std::cos(angle), std::sin(angle), -0.1;
  }
  return points;
}

double volume(const PointRows& points, const Matrix3d& axes) {
  const PointRows along = points * axes;
  return (along.colwise().maxCoeff() - along.colwise().minCoeff()).prod();
}

}  // namespace

TEST_CASE("a poor bound on the least width changes the length of the search, not its result",
          "[box_search]") {
  const PointRows points = random_points(300, {1, 0.5, 0.2}, 1);
  const BoxSearch good = search_box(points, 3, 0.3, 1e-12);
  const BoxSearch poor = search_box(points, 3, 1e-4, 1e-12);
  CHECK(volume(points, good.axes) == Approx(volume(points, poor.axes)).epsilon(1e-11));
  CHECK(good.gap <= 1e-12);
  CHECK(poor.gap <= 2e-12);
}

TEST_CASE("the volume found does not depend on the axes that the search starts from",
          "[box_search][long]") {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const PointRows points = random_points(6, {1, 0.8, 0.6}, seed);
    const Matrix3d turn =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
            .normalized()
            .toRotationMatrix();
    const PointRows turned = points * turn;
    INFO("seed " << seed);
    CHECK(volume(turned, search_box(turned, 3, 0.01, 1e-10).axes) ==
          Approx(volume(points, search_box(points, 3, 0.01, 1e-10).axes)).epsilon(1e-9));
  }
}

TEST_CASE("a search for points along the axes looks at few sets of orientations", "[box_search]") {
  // Seen: 1,800 to 7,000. All orientations in steps as fine as the result would be 1e30.
  for (unsigned seed = 1; seed <= 20; ++seed) {
    PointRows points = random_points(1000, {1, 0.5, 0.2}, seed);
    points *= search_box(points, 3, 0.3, 0.01).axes;
    const BoxSearch search = search_box(points, 3, 0.3, 1e-12);
    INFO("seed " << seed);
    CHECK(search.gap <= 1e-12);
    CHECK(search.cells < 20000);
  }
}

TEST_CASE("a search that ends early says how far the box may be from the smallest",
          "[box_search]") {
  const PointRows points = cylinder(400);
  const BoxSearch early = search_box(points, 3, 0.05, 1e-12, 1e6);
  const BoxSearch later = search_box(points, 3, 0.05, 1e-12, 2e7);
  CHECK(early.gap > 1e-12);
  CHECK(later.gap < early.gap);
  CHECK(later.cells > early.cells);
  // Nor can any box be smaller than the gap says: the body's volume is some 0.63, its box 0.8.
  CHECK(std::log(volume(points, early.axes)) - early.gap <= std::log(volume(points, later.axes)));
  CHECK(volume(points, later.axes) == Approx(0.8).epsilon(0.001));
}

TEST_CASE("for points in a plane only rotations in the plane are searched", "[box_search]") {
  PointRows points = random_points(200, {1, 0.5, 0}, 3);
  points *= Eigen::AngleAxisd(0.3, Vector3d::UnitZ()).toRotationMatrix();
  const BoxSearch search = search_box(points, 2, 0.3, 1e-12);
  CHECK(search.axes.col(2) == Vector3d::UnitZ());
  CHECK(search.gap <= 1e-12);
}
