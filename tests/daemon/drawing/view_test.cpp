#include "daemon/drawing/view.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "tests/catch.hpp"

using namespace sweepd;
using Catch::Matchers::WithinAbs;
using Eigen::Vector3d;

TEST_CASE("views show the axes that they are named after", "[view]") {
  const auto way = [](View view, const Vector3d& axis) -> Spot {
    return view.spot(axis) - view.spot(Vector3d::Zero());
  };
  const Spot right(1, 0);
  const Spot up(0, -1);
  CHECK(way(View::top(), Vector3d::UnitX()).isApprox(right));
  CHECK(way(View::top(), Vector3d::UnitY()).isApprox(up));
  CHECK(way(View::front(), Vector3d::UnitX()).isApprox(right));
  CHECK(way(View::front(), Vector3d::UnitZ()).isApprox(up));
  CHECK(way(View::side(), Vector3d::UnitY()).isApprox(right));
  CHECK(way(View::side(), Vector3d::UnitZ()).isApprox(up));
  // Z is up, X to the right and down, Y to the right and up: as robots are drawn.
  CHECK_THAT(way(View::oblique(), Vector3d::UnitZ()).x(), WithinAbs(0, 1e-12));
  CHECK(way(View::oblique(), Vector3d::UnitZ()).y() < 0);
  CHECK(way(View::oblique(), Vector3d::UnitX()).x() > 0);
  CHECK(way(View::oblique(), Vector3d::UnitX()).y() > 0);
  CHECK(way(View::oblique(), Vector3d::UnitY()).x() > 0);
  CHECK(way(View::oblique(), Vector3d::UnitY()).y() < 0);
}

TEST_CASE("what is fitted fills the frame and keeps its shape", "[view]") {
  std::vector<Vector3d> points;
  for (int k = 0; k < 100; ++k) {
    const double angle = 2 * std::numbers::pi * k / 100;
    points.emplace_back(500 + 300 * std::cos(angle), 300 * std::sin(angle), 77);
  }
  View view = View::top();
  view.fit(points, {10, 20, 400, 200});
  double most = 0;
  for (const Vector3d& point : points) {
    const Spot spot = view.spot(point);
    CHECK(Frame{9.9, 19.9, 400.2, 200.2}.holds(spot));
    CHECK_THAT((spot - Spot(210, 120)).norm(), WithinAbs(100, 0.5));  // still a circle
    most = std::max(most, std::abs(spot.y() - 120));
  }
  CHECK(most > 99.5);
  CHECK_THAT((view.place(view.spot({500, 100, 0})) - Eigen::Vector2d(500, 100)).norm(),
             WithinAbs(0, 1e-9));
}

TEST_CASE("in perspective the near is larger than the far", "[view]") {
  View view = View::perspective(Vector3d::Zero(), 100);
  const Vector3d towards = Vector3d(0.75, -1, 0.55).normalized();
  const auto size = [&](double depth) {
    return (view.spot(depth * towards + Vector3d(0, 0, 10)) -
            view.spot(depth * towards - Vector3d(0, 0, 10)))
        .norm();
  };
  CHECK(size(80) > 1.1 * size(0));
  CHECK(size(0) > 1.1 * size(-80));
}

TEST_CASE("one point, and none, can be seen", "[view]") {
  View view = View::top();
  view.fit(std::vector<Vector3d>{}, {0, 0, 100, 100});
  CHECK(view.spot(Vector3d::Zero()).allFinite());
  view.fit(std::vector<Vector3d>{{1, 2, 3}}, {0, 0, 100, 100});
  CHECK_THAT((view.spot({1, 2, 3}) - Spot(50, 50)).norm(), WithinAbs(0, 1e-6));
}
