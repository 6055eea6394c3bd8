#include "daemon/given_axes.hpp"

#include "daemon/units.hpp"
#include "identify/dh_comparison.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/arm_axes.hpp"

using identify::Axis;
using identify::Knowledge;
using sweepd::identify_given_axes;
using namespace sweepd::test;

namespace {

identify::Campaign kr5_campaign() {
  identify::Campaign campaign;
  campaign.specified = identify::test::kr5_arc();
  return campaign;
}

/// Rounding alone is left: the axes are exact.
constexpr double kExact_mm = 1e-9;
constexpr double kExact_rad = 1e-12;

void check_specified(const identify::Identification& found) {
  const auto arm = identify::test::kr5_arc();
  REQUIRE(found.dh.size() == 6);
  for (std::size_t j = 0; j < 5; ++j) {
    INFO("joint " << j + 1);
    CHECK(found.dh[j].b_mm.value == Approx(arm.rows[j].b_mm).margin(kExact_mm));
    CHECK(found.dh[j].a_mm.value == Approx(arm.rows[j].a_mm).margin(kExact_mm));
    CHECK(identify::wrapped(found.dh[j].alpha_rad.value - arm.rows[j].alpha_rad) ==
          Approx(0).margin(kExact_rad));
    CHECK(identify::wrapped(found.dh[j].theta_rad.value - arm.rows[j].theta_rad) ==
          Approx(0).margin(kExact_rad));
  }
  CHECK(found.dh[1].b_mm.knowledge == Knowledge::by_convention);
  CHECK(found.dh[1].relation == identify::Relation::parallel);
  CHECK(found.dh[4].relation == identify::Relation::intersecting);
  CHECK(found.dh[4].a_mm.knowledge == Knowledge::identified);
  CHECK(found.dh[4].a_mm.sigma == 0);
}

}  // namespace

TEST_CASE("the axes of a KR 5 give its table, whichever way round they are and wherever on them") {
  auto axes = axes_of(identify::test::kr5_arc());
  SECTION("as the table has them") {}
  SECTION("all the other way round") {
    for (Axis& axis : axes) axis = axis.reversed();
  }
  SECTION("some the other way round, with points far along them") {
    for (const std::size_t j : {1U, 4U}) {
      axes[j].direction = -axes[j].direction;
      axes[j].point_mm += 5000 * axes[j].direction;
    }
  }
  const auto found = identify_given_axes(axes, kr5_campaign());
  CHECK(found.status == identify::Status::complete);
  check_specified(found);
  // Positive rotation of a KUKA is about -Z of the paper's table.
  for (std::size_t j = 0; j < 6; ++j)
    CHECK(
        (found.joints[j].axis->direction + axes_of(identify::test::kr5_arc())[j].direction).norm() <
        1e-12);
}

TEST_CASE("the pose in which axes were given is known only if it is declared") {
  const auto arm = identify::test::kr5_arc();
  auto campaign = kr5_campaign();
  const auto unknown = identify_given_axes(axes_of(arm), campaign);
  for (const auto& home_rad : unknown.home_rad) CHECK_FALSE(home_rad);
  for (const auto& row : compare_with_specified(unknown)) CHECK_FALSE(row.theta_rad);

  // The arm stood elsewhere: joint 2 at -90 + 30 degrees.
  auto elsewhere = arm;
  elsewhere.rows[1].theta_rad -= sweepd::radians(30);
  campaign.declared_home_rad = arm.home_rad;
  campaign.declared_home_rad[1] += sweepd::radians(30);
  const auto known = identify_given_axes(axes_of(elsewhere), campaign);
  CHECK(*known.home_rad[1] == campaign.declared_home_rad[1]);
  const auto differences = compare_with_specified(known);
  for (std::size_t j = 0; j < 5; ++j) CHECK(std::abs(*differences[j].theta_rad) < kExact_rad);
}

TEST_CASE("without a specified table axes point as given, and a is not negative") {
  const auto found = identify_given_axes(axes_of(identify::test::kr5_arc()), {});
  CHECK(found.specified.empty());
  CHECK(found.dh[0].a_mm.value == Approx(180));
  CHECK(found.dh[1].a_mm.value == Approx(600));
  CHECK(found.dh[2].a_mm.value == Approx(120));
}

TEST_CASE("uncertainties of given axes end in those of the numbers") {
  auto axes = axes_of(identify::test::kr5_arc());
  constexpr double kSigma_mm = 0.1;
  for (Axis& axis : axes)
    axis.covariance.bottomRightCorner<3, 3>() = kSigma_mm * kSigma_mm * Eigen::Matrix3d::Identity();
  const auto found = identify_given_axes(axes, kr5_campaign());
  // A distance between two axes whose points are uncertain, each on its own.
  CHECK(found.dh[1].a_mm.sigma == Approx(std::sqrt(2.0) * kSigma_mm).epsilon(1e-6));
}

TEST_CASE("axes that all coincide are no arm but no trouble either") {
  const auto found = identify_given_axes(std::vector<Axis>(3), [] {
    identify::Campaign campaign;
    campaign.joints = 3;
    return campaign;
  }());
  CHECK(found.dh[0].relation == identify::Relation::coincident);
  CHECK(found.dh[0].a_mm.value == 0);
}
