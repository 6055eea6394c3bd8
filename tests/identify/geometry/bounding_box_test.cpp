#include "identify/geometry/bounding_box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"

using Eigen::AngleAxisd;
using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using identify::BoundingBox;
using identify::minimum_bounding_box;

namespace {

using Engine = std::mt19937_64;

double normal(Engine& random) {
  return std::normal_distribution<double>()(random);
}
double uniform(Engine& random) {
  return std::uniform_real_distribution<double>(-1, 1)(random);
}

Matrix3d random_rotation(Engine& random) {
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

Matrix3Xd random_points(Index count, Engine& random) {
  return Matrix3Xd::NullaryExpr(3, count, [&] { return normal(random); });
}

double volume(const Matrix3Xd& points, const Matrix3d& axes) {
  const Matrix3Xd along = axes.transpose() * points;
  return (along.rowwise().maxCoeff() - along.rowwise().minCoeff()).prod();
}

// What holds for every box: it is a frame, sorted, with the promised signs, and contains the
// points; 1e-14 is the rounding of some ten operations.
BoundingBox box_of(const Matrix3Xd& points) {
  const auto found = minimum_bounding_box(points);
  REQUIRE(found.has_value());
  const BoundingBox& box = *found;
  const Matrix3d& axes = box.orientation;
  CHECK((axes.transpose() * axes - Matrix3d::Identity()).norm() < 1e-14);
  CHECK(axes.determinant() > 0);
  CHECK(box.lengths_mm(0) >= box.lengths_mm(1));
  CHECK(box.lengths_mm(1) >= box.lengths_mm(2));
  for (int i = 0; i < 2; ++i) CHECK(axes.col(i).maxCoeff() > -axes.col(i).minCoeff() - 1e-5);
  const double slack = 1e-14 * (box.lengths_mm(0) + box.center_mm.norm());
  const Matrix3Xd inside = axes.transpose() * (points.colwise() - box.center_mm);
  for (int i = 0; i < 3; ++i) {
    CHECK(inside.row(i).cwiseAbs().maxCoeff() <= box.lengths_mm(i) / 2 + slack);
  }
  return box;
}

// The corners of a cuboid and points in it, turned and moved.
Matrix3Xd cuboid(const Vector3d& lengths, Index inner, const Matrix3d& rotation,
                 const Vector3d& center, Engine& random) {
  Matrix3Xd points(3, 8 + inner);
  for (Index i = 0; i < 8; ++i) {
    points.col(i) << (i & 1 ? 1 : -1), (i & 2 ? 1 : -1), (i & 4 ? 1 : -1);
  }
  for (Index i = 8; i < points.cols(); ++i) {
    points.col(i) << uniform(random), uniform(random), uniform(random);
  }
  return (rotation * (lengths / 2).asDiagonal() * points).colwise() + center;
}

// O'Rourke: two adjacent sides of the smallest box each contain an edge of the hull. The oracle
// takes every pair of points as an edge, walks the one-parameter family of boxes flush with each
// two, and refines every local minimum that could matter by golden sections.
double smallest_volume_by_edge_pairs(const Matrix3Xd& points) {
  std::vector<Vector3d> edges;
  for (Index i = 0; i < points.cols(); ++i) {
    for (Index j = 0; j < i; ++j) edges.push_back((points.col(i) - points.col(j)).normalized());
  }
  double best = std::numeric_limits<double>::infinity();
  for (const Vector3d& first : edges) {
    const Vector3d a = first.unitOrthogonal();
    const Vector3d b = first.cross(a);
    for (const Vector3d& second : edges) {
      const auto at = [&](double angle) {
        Matrix3d axes;
        axes.col(0) = std::cos(angle) * a + std::sin(angle) * b;
        const Vector3d across = second.cross(axes.col(0));
        if (across.norm() < 1e-12) return std::numeric_limits<double>::infinity();
        axes.col(1) = across.normalized();
        axes.col(2) = axes.col(0).cross(axes.col(1));
        return volume(points, axes);
      };
      constexpr int kSteps = 90;
      constexpr double kStep = identify::kPi / kSteps;
      std::vector<double> walk;
      for (int i = 0; i <= kSteps + 1; ++i) walk.push_back(at(i * kStep));
      for (std::size_t i = 1; i + 1 < walk.size(); ++i) {
        if (walk[i] > walk[i - 1] || walk[i] > walk[i + 1] || walk[i] > 1.1 * best) continue;
        double low = (static_cast<double>(i) - 1) * kStep;
        double high = low + 2 * kStep;
        for (int round = 0; round < 60; ++round) {
          const double third = (high - low) * (2 - std::numbers::phi);
          if (at(low + third) < at(high - third)) {
            high -= third;
          } else {
            low += third;
          }
        }
        best = std::min(best, at((low + high) / 2));
      }
    }
  }
  return best;
}

// Six robot sweeps: arcs about six axes with the noise and the print of a controller.
Matrix3Xd six_arcs(double range_deg, unsigned seed) {
  Engine random(seed);
  const double radii[] = {900, 1000, 620, 160, 160, 60};
  constexpr Index kSamples = 1500;
  Matrix3Xd points(3, 6 * kSamples);
  const Vector3d shared(850, 120, 940);  // where the robot is at home, on every arc
  for (Index arc = 0; arc < 6; ++arc) {
    const Matrix3d frame = random_rotation(random);
    const double radius = radii[arc];
    for (Index i = 0; i < kSamples; ++i) {
      const double angle =
          range_deg * identify::kPi / 180 * (static_cast<double>(i) / (kSamples - 1) - 0.3);
      const Vector3d on_circle(std::cos(angle) - 1, std::sin(angle), 0);
      const Vector3d noise(normal(random), normal(random), normal(random));
      points.col(arc * kSamples + i) = shared + radius * (frame * on_circle) + 0.002 * noise;
    }
  }
  return (points * 1e4).array().round().matrix() / 1e4;
}

}  // namespace

TEST_CASE("a box is found again from its corners and points inside", "[bounding_box]") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Engine random(seed);
    const Vector3d lengths(500 + 50 * uniform(random), 300, 100 + 90 * uniform(random));
    const Matrix3d rotation = random_rotation(random);
    const Vector3d center = 1000 * random_points(1, random);
    const BoundingBox box = box_of(cuboid(lengths, 200, rotation, center, random));
    INFO("seed " << seed);
    CHECK((box.lengths_mm - lengths).norm() < 1e-9 * lengths.norm());
    CHECK((box.center_mm - center).norm() < 1e-9 * lengths.norm());
    const Matrix3d turn = rotation.transpose() * box.orientation;
    CHECK((turn.cwiseAbs() - Matrix3d::Identity()).norm() < 1e-9);
    CHECK(box.gap < 2e-12);
  }
}

TEST_CASE("regular bodies have the boxes that are known for them", "[bounding_box]") {
  Engine random(7);
  const Matrix3d rotation = random_rotation(random);
  Matrix3Xd tetrahedron(3, 4);  // every other corner of the unit cube
  tetrahedron << 0, 1, 1, 0, 0, 1, 0, 1, 0, 0, 1, 1;
  CHECK(box_of(tetrahedron).volume_mm3() == Approx(1).epsilon(1e-10));
  CHECK(box_of(rotation * tetrahedron).volume_mm3() == Approx(1).epsilon(1e-10));

  // Three pairs of faces or edges hold each axis at (1, 2, 2) / 3 and its like: a cube of 4/3.
  Matrix3Xd octahedron(3, 6);
  octahedron << Matrix3d::Identity(), -Matrix3d::Identity();
  CHECK(box_of(octahedron).volume_mm3() == Approx(64.0 / 27).epsilon(1e-10));
  CHECK(box_of(rotation * octahedron).volume_mm3() == Approx(64.0 / 27).epsilon(1e-10));

  const Matrix3Xd cube = cuboid({2, 2, 2}, 0, rotation, {0, 0, 0}, random);
  CHECK(box_of(cube).volume_mm3() == Approx(8).epsilon(1e-10));
}

TEST_CASE("the box is the one that a search over all pairs of edges finds", "[bounding_box]") {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    Engine random(seed);
    const Index count = 4 + static_cast<Index>(seed % 4);
    const Matrix3Xd points = Vector3d(3, 2, 1).asDiagonal() * random_points(count, random);
    const BoundingBox box = box_of(points);
    INFO("seed " << seed);
    // Golden sections end within 1e-9 of a kink.
    CHECK(box.volume_mm3() == Approx(smallest_volume_by_edge_pairs(points)).epsilon(1e-7));
    CHECK(box.gap < 1e-10);
  }
}

TEST_CASE("no other orientation gives a smaller box", "[bounding_box]") {
  Engine random(11);
  const Matrix3Xd points = Vector3d(3, 2, 1).asDiagonal() * random_points(2000, random);
  const BoundingBox box = box_of(points);
  const double least = box.volume_mm3() * (1 - 1e-11);
  for (int i = 0; i < 2000; ++i) {
    CHECK(volume(points, random_rotation(random)) >= least);
    const double angle = std::pow(10.0, -i % 8);
    const Matrix3d near =
        AngleAxisd(angle, random_rotation(random).col(0)).toRotationMatrix() * box.orientation;
    CHECK(volume(points, near) >= least);
  }
}

TEST_CASE("no points and numbers that are not finite have no box", "[bounding_box]") {
  CHECK_FALSE(minimum_bounding_box(Matrix3Xd(3, 0)).has_value());
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Matrix3Xd points = Matrix3Xd::Random(3, 5);
    points(1, 3) = bad;
    CHECK_FALSE(minimum_bounding_box(points).has_value());
  }
}

TEST_CASE("equal points have a box without size at the point", "[bounding_box]") {
  const Vector3d point(1234.5678, -0.1, 1e6);
  for (const Index count : {1, 2, 1000}) {
    const BoundingBox box = box_of(point.replicate(1, count));
    CHECK(box.lengths_mm == Vector3d::Zero());
    CHECK(box.center_mm == point);
    CHECK(box.gap == 0);
  }
}

TEST_CASE("points on a line have their segment as box", "[bounding_box]") {
  Engine random(3);
  const Vector3d direction = random_rotation(random).col(0);
  Matrix3Xd points(3, 500);
  for (Index i = 0; i < points.cols(); ++i) points.col(i) = 40 * uniform(random) * direction;
  points.col(17) = -50 * direction;
  points.col(400) = 50 * direction;
  const BoundingBox box = box_of(points.colwise() + Vector3d(100, 200, 300));
  CHECK(box.lengths_mm(0) == Approx(100).epsilon(1e-14));
  CHECK(box.lengths_mm(1) < 1e-11);  // the rounding of coordinates of some hundred
  CHECK(std::abs(box.orientation.col(0).dot(direction)) == Approx(1).epsilon(1e-14));
  CHECK((box.center_mm - Vector3d(100, 200, 300)).norm() < 1e-11);
}

TEST_CASE("points in a plane have the rectangle of least area as box", "[bounding_box]") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Engine random(seed);
    Matrix3Xd flat = random_points(30, random);
    flat.row(2).setZero();
    // One side of the least rectangle contains an edge of the hull.
    double least = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < flat.cols(); ++i) {
      for (Index j = 0; j < i; ++j) {
        const Vector3d edge = (flat.col(i) - flat.col(j)).normalized();
        const Vector3d across = Vector3d::UnitZ().cross(edge);
        const auto extent = [&](const Vector3d& direction) {
          const Eigen::RowVectorXd along = direction.transpose() * flat;
          return along.maxCoeff() - along.minCoeff();
        };
        least = std::min(least, extent(edge) * extent(across));
      }
    }
    const Matrix3d rotation = random_rotation(random);
    const BoundingBox box = box_of(rotation * flat);
    INFO("seed " << seed);
    CHECK(box.lengths_mm(0) * box.lengths_mm(1) == Approx(least).epsilon(1e-11));
    CHECK(box.lengths_mm(2) < 1e-14);
    CHECK(std::abs(box.orientation.col(2).dot(rotation.col(2))) == Approx(1).epsilon(1e-12));
  }
}

TEST_CASE("thin sets keep their thickness", "[bounding_box]") {
  // A thickness of 1e-9 carries 1e-7 of itself as rounding of the coordinates.
  const Vector3d shapes[] = {{1000, 800, 1e-6},
                             {1000, 1e-6, 1e-6},
                             {1000, 1, 1e-6},
                             {1000, 1000, 1e-3},
                             {1000, 1e-3, 1e-6}};
  for (const Vector3d& lengths : shapes) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      Engine random(seed);
      const Matrix3Xd points =
          cuboid(lengths, 300, random_rotation(random), Vector3d::Zero(), random);
      const BoundingBox box = box_of(points);
      INFO(lengths.transpose() << " seed " << seed);
      for (int i = 0; i < 3; ++i) CHECK(box.lengths_mm(i) == Approx(lengths(i)).epsilon(2e-6));
      CHECK(box.gap < 2e-6);
    }
  }
}

TEST_CASE("below the tolerance a thin set is flat, and its thickness is measured",
          "[bounding_box]") {
  Engine random(2);
  const Matrix3d rotation = random_rotation(random);
  const BoundingBox box = box_of(cuboid({1, 0.5, 1e-12}, 100, rotation, {0, 0, 0}, random));
  CHECK(box.lengths_mm(0) * box.lengths_mm(1) == Approx(0.5).epsilon(1e-11));
  CHECK(box.lengths_mm(2) >= 0.99e-12);
  CHECK(box.lengths_mm(2) < 1e-11);  // the plane is laid through three points, not the middle
}

TEST_CASE("order and repetition of the points do not change a bit", "[bounding_box]") {
  Engine random(5);
  const Matrix3Xd points = random_points(400, random);
  const BoundingBox box = box_of(points);
  Matrix3Xd shuffled(3, 1000);
  std::vector<Index> from(1000);
  for (std::size_t i = 0; i < from.size(); ++i) from[i] = static_cast<Index>(i % 400);
  std::shuffle(from.begin(), from.end(), random);
  for (Index i = 0; i < 1000; ++i) shuffled.col(i) = points.col(from[static_cast<std::size_t>(i)]);
  const BoundingBox again = box_of(shuffled);
  CHECK(again.lengths_mm == box.lengths_mm);
  CHECK(again.center_mm == box.center_mm);
  CHECK(again.orientation == box.orientation);
  CHECK(again.gap == box.gap);
}

TEST_CASE("turning, moving and scaling the points does so to the box", "[bounding_box]") {
  Engine random(6);
  const Matrix3Xd points = Vector3d(3, 2, 1).asDiagonal() * random_points(500, random);
  const BoundingBox box = box_of(points);
  for (const double scale : {1.0, 1e-300, 1e300}) {
    const Matrix3d rotation = random_rotation(random);
    const Vector3d shift = scale * Vector3d(3, -7, 5);
    const BoundingBox turned = box_of((scale * rotation * points).colwise() + shift);
    CHECK((turned.lengths_mm / scale - box.lengths_mm).norm() < 1e-9);
    CHECK(((turned.center_mm - shift) / scale - rotation * box.center_mm).norm() < 1e-9);
  }
}

TEST_CASE("the points of six sweeps have a box proven to be the smallest", "[bounding_box]") {
  for (const double range_deg : {90.0, 30.0}) {
    const Matrix3Xd points = six_arcs(range_deg, 4);
    const BoundingBox box = box_of(points);
    CHECK(box.gap < 1e-11);
    Engine random(8);
    for (int i = 0; i < 200; ++i) {
      const Matrix3d near =
          AngleAxisd(1e-3 * normal(random), random_rotation(random).col(0)) * box.orientation;
      CHECK(volume(points, near) >= box.volume_mm3() * (1 - 1e-11));
    }
  }
}

TEST_CASE("the noise of one sweep alone gives a thin box, not a failure", "[bounding_box]") {
  const BoundingBox box = box_of(six_arcs(90, 9).leftCols(1500));
  // Chord and sagitta of the arc; the thickness is the noise of 2 um, four sigma to each side.
  CHECK(box.lengths_mm(0) == Approx(900 * std::numbers::sqrt2).epsilon(1e-4));
  CHECK(box.lengths_mm(1) == Approx(900 * (1 - std::numbers::sqrt2 / 2)).epsilon(1e-4));
  CHECK(box.lengths_mm(2) > 0.010);
  CHECK(box.lengths_mm(2) < 0.020);
}
