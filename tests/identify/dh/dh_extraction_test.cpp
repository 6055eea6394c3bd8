#include "identify/dh/dh_extraction.hpp"

#include <cmath>
#include <random>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/simulated_campaign.hpp"

using namespace identify;
using Eigen::Vector3d;

namespace {

/// The Z axes of a table's frames, exactly.
std::vector<std::optional<Axis>> axes_of(const std::vector<DhRow>& rows) {
  std::vector<std::optional<Axis>> axes;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (const DhRow& row : rows) {
    axes.push_back(Axis{frame.linear() * Vector3d::UnitZ(), frame.translation()});
    frame = frame * transform(row);
  }
  return axes;
}

void check_row(const DhEstimate& found, const DhRow& expected) {
  CHECK(found.b_mm.value == Approx(expected.b_mm).margin(1e-8));
  CHECK(std::abs(wrapped(found.theta_rad.value - expected.theta_rad)) < 1e-9);
  CHECK(found.a_mm.value == Approx(expected.a_mm).margin(1e-8));
  CHECK(std::abs(wrapped(found.alpha_rad.value - expected.alpha_rad)) < 1e-9);
}

}  // namespace

TEST_CASE("the paper's table comes back from its own axes", "[dh_extraction]") {
  const auto rows = test::kr5_arc().rows;
  const auto table = extract_dh(axes_of(rows), 2000, rows);
  REQUIRE(table.size() == 6);
  for (std::size_t i = 0; i < 5; ++i) {
    CAPTURE(i);
    check_row(table[i], rows[i]);
  }
  CHECK(table[0].relation == Relation::skew);
  CHECK(table[1].relation == Relation::parallel);
  CHECK(table[2].relation == Relation::skew);
  CHECK(table[3].relation == Relation::intersecting);
  CHECK(table[4].relation == Relation::intersecting);
  CHECK(table[5].relation == Relation::last);
  CHECK(table[1].b_mm.knowledge == Knowledge::by_convention);
  CHECK(table[2].b_mm.knowledge == Knowledge::identified);
  CHECK(table[5].a_mm.knowledge == Knowledge::by_convention);
}

TEST_CASE("angles are within half a turn of the specified ones", "[dh_extraction]") {
  const std::vector<DhRow> rows{{0, 0.1, 180, 1.5}, {620, 3.141, 90, -1.2}, {100, 9, 50, 3}, {}};
  auto built = rows;
  built[1].theta_rad += 1e-3;  // beyond half a turn
  const auto table = extract_dh(axes_of(built), 2000, rows);
  CHECK(table[1].theta_rad.value == Approx(3.142).epsilon(1e-9));
  CHECK(table[2].theta_rad.value == Approx(9).epsilon(1e-9));
}

TEST_CASE("random arms of two to twelve joints come back from their axes", "[dh_extraction]") {
  std::mt19937 random(11);
  std::uniform_real_distribution<> uniform(-1, 1);
  for (int run = 0; run < 100; ++run) {
    std::vector<DhRow> rows(2 + static_cast<std::size_t>(run) % 11);
    for (auto& row : rows) {
      row = {500 * uniform(random), 3 * uniform(random), 100 + 400 * std::abs(uniform(random)),
             3 * uniform(random)};
      // Twists of less than 0.2 rad put the common normals far away: another test's matter.
      if (std::abs(std::sin(row.alpha_rad)) < 0.2) row.alpha_rad = 1;
    }
    // The first frame's origin and X are conventions of the extraction.
    rows.front().b_mm = 0;
    const auto axes = axes_of(rows);
    for (const auto& specified : {rows, std::vector<DhRow>{}}) {
      const auto table = extract_dh(axes, 5000, specified);
      for (std::size_t i = 0; i + 1 < rows.size(); ++i)
        if (i > 0 || !specified.empty()) {
          CAPTURE(run, i);
          CHECK(table[i].a_mm.value == Approx(rows[i].a_mm).epsilon(1e-9));
          CHECK(std::abs(wrapped(table[i].alpha_rad.value - rows[i].alpha_rad)) < 1e-9);
          CHECK(table[i].b_mm.value == Approx(rows[i].b_mm).margin(1e-6));
          CHECK(std::abs(wrapped(table[i].theta_rad.value - rows[i].theta_rad)) < 1e-9);
        }
    }
  }
}

TEST_CASE("without a specified table a is not negative, and the twist of meeting axes positive",
          "[dh_extraction]") {
  const std::vector<DhRow> rows = {{0, 0, -100, 1}, {0, 0, 0, -1}, {0, 0, 0, 0}};
  const auto table = extract_dh(axes_of(rows), 500);
  CHECK(table[0].a_mm.value == Approx(100));
  CHECK(table[0].alpha_rad.value == Approx(-1));
  CHECK(table[1].relation == Relation::intersecting);
  CHECK(table[1].alpha_rad.value == Approx(1));
}

TEST_CASE("the specified table decides the sign of a common normal", "[dh_extraction]") {
  const std::vector<DhRow> rows = {
      {0, 0, 260, 90 * kDegree}, {0, 0, -35, 90 * kDegree}, {0, 0, 0, 0}};
  const auto with = extract_dh(axes_of(rows), 500, rows);
  CHECK(with[1].a_mm.value == Approx(-35));
  CHECK(with[1].alpha_rad.value == Approx(90 * kDegree));
  const auto without = extract_dh(axes_of(rows), 500);
  CHECK(without[1].a_mm.value == Approx(35));
  CHECK(without[1].alpha_rad.value == Approx(-90 * kDegree));
}

TEST_CASE("a missing axis leaves undetermined what needs it, and no more", "[dh_extraction]") {
  const auto rows = test::kr5_arc().rows;
  auto axes = axes_of(rows);
  axes[2].reset();
  const auto table = extract_dh(axes, 2000, rows);
  check_row(table[0], rows[0]);
  for (const std::size_t i : {1u, 2u}) {
    CHECK(table[i].a_mm.knowledge == Knowledge::undetermined);
    CHECK(table[i].b_mm.knowledge == Knowledge::undetermined);
  }
  CHECK(table[3].alpha_rad.knowledge == Knowledge::identified);
  CHECK(table[3].b_mm.knowledge == Knowledge::undetermined);
  CHECK(table[3].theta_rad.knowledge == Knowledge::undetermined);
  CHECK(table[4].b_mm.knowledge == Knowledge::identified);
}

TEST_CASE("what a linear joint's X would tell is undetermined where nothing tells that X",
          "[dh_extraction]") {
  Axis linear{{0.001, -0.002, 1}, {300, 0, 0}};
  linear.direction.normalize();
  linear.linear = true;
  std::vector<std::optional<Axis>> axes = {Axis{{0, 0, 1}, {0, 0, 0}}, Axis{{0, 0, 1}, {200, 0, 0}},
                                           linear, Axis{{0, 0, 1}, {300, 0, 0}},
                                           Axis{{1, 0, 0}, {300, 0, 700}}};
  const auto whole = extract_dh(axes, 1000);
  CHECK(whole[2].alpha_rad.knowledge == Knowledge::identified);
  CHECK(whole[2].beta_rad.knowledge == Knowledge::identified);
  CHECK(whole[3].theta_rad.knowledge == Knowledge::identified);
  axes[1].reset();
  const auto table = extract_dh(axes, 1000);
  CHECK(has_beta(table[2]));
  CHECK(table[2].alpha_rad.knowledge == Knowledge::undetermined);
  CHECK(table[2].beta_rad.knowledge == Knowledge::undetermined);
  CHECK(table[3].theta_rad.knowledge == Knowledge::undetermined);
  CHECK(table[3].alpha_rad.knowledge == Knowledge::identified);
}

TEST_CASE("coincident axes leave everything between them to convention", "[dh_extraction]") {
  const std::vector<std::optional<Axis>> axes = {
      Axis{{0, 0, 1}, {0, 0, 0}}, Axis{{0, 0, -1}, {0, 0, 500}}, Axis{{1, 0, 0}, {0, 0, 700}}};
  const auto table = extract_dh(axes, 1000);
  CHECK(table[0].relation == Relation::coincident);
  for (const auto& number : {table[0].b_mm, table[0].theta_rad, table[0].a_mm, table[0].alpha_rad,
                             table[0].beta_rad, table[1].theta_rad})
    CHECK(number.knowledge == Knowledge::by_convention);
  CHECK(table[0].a_mm.value == Approx(0).margin(1e-12));
  CHECK(std::abs(table[0].alpha_rad.value) == Approx(180 * kDegree));
  CHECK(table[1].relation == Relation::intersecting);
}

TEST_CASE("axes are parallel when their uncertainty does not tell where they come closest",
          "[dh_extraction]") {
  Axis first{{0, 0, 1}, {0, 0, 0}};
  Axis second{{0, std::sin(0.01), std::cos(0.01)}, {600, 0, 0}};
  CHECK(relation_between(first, second, 2000) == Relation::skew);
  // 600 mm x 1e-5 rad / 0.01^2 = 60 mm: more than 2 % of 2 m.
  for (auto* axis : {&first, &second})
    axis->covariance.topLeftCorner<2, 2>() = Eigen::Matrix2d::Identity() * 1e-10;
  CHECK(relation_between(first, second, 2000) == Relation::parallel);
  // However exactly known: beyond twice the arm's size is no joint offset.
  const Axis far{{0, std::sin(1e-4), std::cos(1e-4)}, {600, 0.3, 0}};
  CHECK(relation_between(Axis{{0, 0, 1}, {0, 0, 0}}, far, 2000) == Relation::skew);
  const Axis beyond{{0, std::sin(1e-4), std::cos(1e-4)}, {600, 100, 0}};
  CHECK(relation_between(Axis{{0, 0, 1}, {0, 0, 0}}, beyond, 2000) == Relation::parallel);
}

TEST_CASE("the uncertainty of a DH number is the scatter that uncertain axes cause",
          "[dh_extraction]") {
  const auto rows = test::kr5_arc().rows;
  auto axes = axes_of(rows);
  std::mt19937 random(5);
  std::normal_distribution<> normal;
  constexpr double kDirection = 1e-4;
  constexpr double kPoint = 0.01;
  constexpr int kRuns = 500;
  for (auto& axis : axes) {
    axis->covariance.topLeftCorner<3, 3>() =
        kDirection * kDirection *
        (Eigen::Matrix3d::Identity() - axis->direction * axis->direction.transpose());
    axis->covariance.bottomRightCorner<3, 3>() = kPoint * kPoint * Eigen::Matrix3d::Identity();
  }
  const auto predicted = extract_dh(axes, 2000, rows);
  std::vector<Eigen::Vector4d> squares(rows.size(), Eigen::Vector4d::Zero());
  for (int run = 0; run < kRuns; ++run) {
    auto moved = axes;
    for (auto& axis : moved) {
      Vector3d tilt(normal(random), normal(random), normal(random));
      axis->direction = (axis->direction + kDirection * tilt.cross(axis->direction)).normalized();
      for (int k = 0; k < 3; ++k) axis->point_mm(k) += kPoint * normal(random);
    }
    const auto table = extract_dh(moved, 2000, rows);
    for (std::size_t i = 0; i + 1 < rows.size(); ++i)
      squares[i] += Eigen::Vector4d(table[i].b_mm.value - rows[i].b_mm,
                                    wrapped(table[i].theta_rad.value - rows[i].theta_rad),
                                    table[i].a_mm.value - rows[i].a_mm,
                                    wrapped(table[i].alpha_rad.value - rows[i].alpha_rad))
                        .cwiseAbs2() /
                    kRuns;
  }
  // 500 runs give a standard deviation to +-3 % (1 sigma).
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const auto check = [&](const DhNumber& number, double square) {
      if (number.knowledge == Knowledge::identified)
        CHECK(std::sqrt(square) / number.sigma == Approx(1).margin(0.12));
    };
    CAPTURE(i);
    check(predicted[i].b_mm, squares[i](0));
    check(predicted[i].theta_rad, squares[i](1));
    check(predicted[i].a_mm, squares[i](2));
    check(predicted[i].alpha_rad, squares[i](3));
  }
}

TEST_CASE("a specified half turn is on one side, whatever home is uncertain by",
          "[dh_extraction]") {
  Arm arm = test::kr5_arc();
  arm.rows[3].theta_rad = kPi;
  for (const double off : {-1e-6, 0.0, 1e-6})
    CHECK(specified_row(arm, 3, arm.home_rad[3] + off).theta_rad == Approx(kPi).margin(2e-6));
  CHECK(specified_row(arm, 3, arm.home_rad[3] + arm.positive[3] * kPi / 2).theta_rad ==
        Approx(-kPi / 2));
}

TEST_CASE("angles are wrapped to one turn", "[dh_extraction]") {
  CHECK(wrapped(190 * kDegree) == Approx(-170 * kDegree));
  CHECK(wrapped(-180 * kDegree) == Approx(180 * kDegree));
  CHECK(wrapped(720 * kDegree) == Approx(0).margin(1e-12));
}
