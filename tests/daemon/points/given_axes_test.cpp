#include "identify/given_axes.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <regex>
#include <string>

#include <nlohmann/json.hpp>

#include "daemon/results/report.hpp"
#include "daemon/results/result_formats.hpp"
#include "daemon/text/units.hpp"
#include "identify/dh/dh_comparison.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/arm_axes.hpp"

using identify::Axis;
using identify::identify_given_axes;
using identify::Knowledge;
using namespace sweepd::test;

namespace {

identify::Campaign given_campaign() {
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

TEST_CASE("the axes of a KR 5 give its table, whichever way round they are and wherever on them",
          "[given_axes]") {
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
  const auto found = identify_given_axes(axes, given_campaign());
  CHECK(found.status == identify::Status::complete);
  check_specified(found);
  // Positive rotation of a KUKA is about -Z of the paper's table.
  for (std::size_t j = 0; j < 6; ++j)
    CHECK(
        (found.joints[j].axis->direction + axes_of(identify::test::kr5_arc())[j].direction).norm() <
        1e-12);
}

TEST_CASE("axes in a device's frame are met wherever it stands, and the base is nobody's number",
          "[given_axes]") {
  auto campaign = given_campaign();
  campaign.device_frame = true;
  std::mt19937 random(5);
  std::uniform_real_distribution<> any(-3000, 3000);
  for (int place = 0; place < 20; ++place) {
    const Eigen::AngleAxisd turn(
        any(random) / 1000, Eigen::Vector3d(any(random), any(random), any(random)).normalized());
    const Eigen::Vector3d by(any(random), any(random), any(random));
    auto axes = axes_of(identify::test::kr5_arc());
    for (Axis& axis : axes) {
      axis.direction = turn * axis.direction;
      axis.point_mm = turn * axis.point_mm + by;
    }
    const auto found = identify_given_axes(axes, campaign);
    CHECK(found.dh[0].b_mm.knowledge == identify::Knowledge::by_convention);
    CHECK(found.dh[0].theta_rad.knowledge == identify::Knowledge::by_convention);
    for (std::size_t j = 0; j + 1 < 6; ++j) {
      CHECK(std::abs(found.dh[j].a_mm.value - found.specified[j].a_mm) < 1e-6);
      CHECK(std::abs(identify::wrapped(found.dh[j].alpha_rad.value -
                                       found.specified[j].alpha_rad)) < 1e-9);
      CHECK(std::abs(found.dh[j].b_mm.value - found.specified[j].b_mm) < 1e-6);
    }
  }
}

TEST_CASE("axes that are not the described arm's are doubted", "[given_axes]") {
  auto axes = axes_of(identify::test::kr5_arc());
  auto campaign = given_campaign();
  std::string code;
  SECTION("of two joints in each other's place") {
    std::swap(axes[1], axes[2]);
    code = "joints_exchanged";
  }
  SECTION("in metres") {
    for (Axis& axis : axes) axis.point_mm /= 1000;
    code = "unit_factor";
  }
  SECTION("of another robot") {
    campaign.specified->rows[1].a_mm += 50;
    code = "specified_contradicted";
  }
  const auto found = identify_given_axes(axes, campaign);
  CHECK(found.status == identify::Status::doubtful);
  REQUIRE(found.doubts.size() == 1);
  CHECK(found.doubts.front().code == code);
}

TEST_CASE("the pose in which axes were given is known only if it is declared", "[given_axes]") {
  const auto arm = identify::test::kr5_arc();
  auto campaign = given_campaign();
  const auto unknown = identify_given_axes(axes_of(arm), campaign);
  for (const auto& home_rad : unknown.home_rad) CHECK_FALSE(home_rad);
  for (const auto& row : compare_with_specified(unknown.dh, unknown.specified, unknown.home_rad))
    CHECK_FALSE(row.theta_rad);

  // The arm stood elsewhere: joint 2 at -90 + 30 degrees.
  auto elsewhere = arm;
  elsewhere.rows[1].theta_rad -= sweepd::radians(30);
  campaign.declared_home_rad = arm.home_rad;
  campaign.declared_home_rad[1] += sweepd::radians(30);
  const auto known = identify_given_axes(axes_of(elsewhere), campaign);
  CHECK(*known.home_rad[1] == campaign.declared_home_rad[1]);
  const auto differences = compare_with_specified(known.dh, known.specified, known.home_rad);
  for (std::size_t j = 0; j < 5; ++j) CHECK(std::abs(*differences[j].theta_rad) < kExact_rad);
}

TEST_CASE("without a specified table axes point as given, and a is not negative", "[given_axes]") {
  const auto found = identify_given_axes(axes_of(identify::test::kr5_arc()), {});
  CHECK(found.specified.empty());
  CHECK(found.dh[0].a_mm.value == Approx(180));
  CHECK(found.dh[1].a_mm.value == Approx(600));
  CHECK(found.dh[2].a_mm.value == Approx(120));
}

TEST_CASE("uncertainties of given axes end in those of the numbers", "[given_axes]") {
  auto axes = axes_of(identify::test::kr5_arc());
  constexpr double kSigma_mm = 0.1;
  for (Axis& axis : axes)
    axis.covariance.bottomRightCorner<3, 3>() = kSigma_mm * kSigma_mm * Eigen::Matrix3d::Identity();
  const auto found = identify_given_axes(axes, given_campaign());
  // A distance between two axes whose points are uncertain, each on its own.
  CHECK(found.dh[1].a_mm.sigma == Approx(std::sqrt(2.0) * kSigma_mm).epsilon(1e-6));
}

TEST_CASE("axes that all coincide are no arm but no trouble either", "[given_axes]") {
  const auto found = identify_given_axes(std::vector<Axis>(3), [] {
    identify::Campaign campaign;
    campaign.joints = 3;
    return campaign;
  }());
  CHECK(found.dh[0].relation == identify::Relation::coincident);
  CHECK(found.dh[0].a_mm.value == 0);
}

namespace {

/// Texts of all files of a result.
std::string files_of(const identify::Identification& found) {
  sweepd::Outcome outcome;
  outcome.robot = "arm";
  outcome.source_kind = "axes";
  outcome.identification = found;
  return sweepd::result_json(outcome) + sweepd::dh_csv(outcome) + sweepd::dh_latex(outcome) +
         sweepd::report(outcome);
}

bool has_word_for_not_finite(const std::string& text) {
  static const std::regex word("(^|[^a-z])-?(nan|inf)([^a-z]|$)");
  return std::regex_search(text, word);
}

Axis with_sigmas(Axis axis, double direction_rad, double point_mm) {
  const Eigen::Matrix3d across =
      Eigen::Matrix3d::Identity() - axis.direction * axis.direction.transpose();
  axis.covariance.topLeftCorner<3, 3>() = direction_rad * direction_rad * across;
  axis.covariance.bottomRightCorner<3, 3>() = point_mm * point_mm * across;
  return axis;
}

/// Two in three lie in a special way to the one before.
std::vector<Axis> random_axes(std::mt19937& random) {
  const auto pick = [&](std::size_t choices) {
    return std::uniform_int_distribution<std::size_t>(0, choices - 1)(random);
  };
  std::normal_distribution<> normal;
  const auto vector = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  constexpr std::array kTilts{0.0, 1e-300, 1e-12, 1e-8, 1e-5, 1e-3, 0.02};
  constexpr std::array kDirections_rad{0.0, 5e-324, 1e-200, 1e-12, 1e-6, 1e-3, 0.0175, 0.3, 1e8};
  constexpr std::array kPoints_mm{0.0, 5e-324, 1e-200, 1e-9, 0.01, 1.0, 1e4, 1e9};
  std::vector<Axis> axes(2 + pick(5));
  for (std::size_t j = 0; j < axes.size(); ++j) {
    Axis& axis = axes[j];
    axis.direction = vector().normalized();
    axis.point_mm = 500 * vector();
    const std::size_t kind = pick(9);
    if (j > 0 && kind < 6) {
      const Axis& before = axes[j - 1];
      if (kind < 2)
        axis.direction =
            Eigen::Vector3d(before.direction + kTilts[pick(7)] * vector()).normalized();
      if (kind == 2) axis.direction = before.direction.unitOrthogonal();
      if (kind == 3) axis.direction = -before.direction;
      if (kind == 4) axis.direction = before.direction;
      if (kind >= 4 || pick(2) == 0) axis.point_mm = before.point_mm + 300 * before.direction;
    }
    if (kind == 8) axis.point_mm *= 1e5;
    axis = with_sigmas(axis, kDirections_rad[pick(9)], kPoints_mm[pick(8)]);
  }
  return axes;
}

}  // namespace

TEST_CASE("perpendicular axes with uncertainties of a degree and a millimetre are perpendicular",
          "[given_axes][issue11][point_21]") {
  auto axes = axes_of(identify::test::kr5_arc());
  for (Axis& axis : axes) axis = with_sigmas(axis, sweepd::radians(1), 1);
  const auto found = identify_given_axes(axes, given_campaign());
  CHECK(found.status == identify::Status::complete);
  CHECK(found.dh[0].relation == identify::Relation::skew);
  CHECK(found.dh[1].relation == identify::Relation::parallel);
  CHECK(found.dh[4].relation == identify::Relation::intersecting);
  const auto arm = identify::test::kr5_arc();
  for (std::size_t j = 0; j < 5; ++j) {
    INFO("row " << j + 1);
    CHECK(found.dh[j].a_mm.value == Approx(arm.rows[j].a_mm).margin(1e-6));
    CHECK(found.dh[j].a_mm.sigma > 1);
    CHECK(found.dh[j].alpha_rad.sigma == Approx(std::sqrt(2.0) * sweepd::radians(1)).epsilon(0.01));
  }
  CHECK_FALSE(has_word_for_not_finite(files_of(found)));
}

TEST_CASE("axes that come without uncertainties make a table without them", "[given_axes]") {
  auto axes = axes_of(identify::test::kr5_arc());
  const auto found = identify_given_axes(axes, given_campaign());
  const auto is_said = [](const identify::Identification& of) {
    return std::ranges::count(of.warnings, "no_uncertainties", &identify::Warning::code);
  };
  CHECK(is_said(found) == 1);
  const auto json = nlohmann::json::parse(sweepd::result_json({"arm", "axes", {}, found}));
  CHECK(json["dh"][1]["a_mm"].is_number());
  for (const char* unknown : {"a_sigma_mm", "a_low_mm", "a_high_mm", "theta_sigma_deg"})
    CHECK(json["dh"][1][unknown].is_null());
  for (Axis& axis : axes) axis = with_sigmas(axis, 1e-5, 0.01);
  CHECK(is_said(identify_given_axes(axes, given_campaign())) == 0);
}

TEST_CASE("axes whose directions are not known have no table, and the result says so",
          "[given_axes][issue11][point_21]") {
  auto axes = axes_of(identify::test::kr5_arc());
  axes[2] = with_sigmas(axes[2], sweepd::radians(30), 1);
  const auto found = identify_given_axes(axes, given_campaign());
  CHECK(found.status == identify::Status::partial);
  CHECK(found.reason.find("b, theta, a, alpha of row 2; b, theta, a, alpha of row 3") !=
        std::string::npos);
  REQUIRE(found.warnings.size() == 1);
  CHECK(found.warnings[0].code == "undetermined");
  const auto json = nlohmann::json::parse(sweepd::result_json({"arm", "axes", {}, found}));
  CHECK(json["status"] == "partial");
  CHECK(json["dh"][1]["a_mm"].is_null());
  CHECK(json["dh"][0]["a_mm"] == 180.0);
}

TEST_CASE(
    "whatever axes are given, no file holds a number that is none, and what is not known is "
    "not called complete",
    "[given_axes][issue11][point_21][long]") {
  std::mt19937 random(21);
  std::size_t complete = 0;
  constexpr std::size_t kRuns = 2000;
  for (std::size_t run = 0; run < kRuns; ++run) {
    INFO("run " << run);
    const auto axes = random_axes(random);
    identify::Campaign campaign;
    campaign.joints = axes.size();
    if (run % 2 == 0) {
      campaign.specified = identify::test::kr5_arc();
      campaign.specified->rows.resize(axes.size());
      campaign.specified->home_rad.resize(axes.size());
      campaign.specified->positive.resize(axes.size(), 1);
    }
    const auto found = identify_given_axes(axes, campaign);
    bool all_known = true;
    for (const auto& row : found.dh)
      for (const auto* number :
           {&row.b_mm, &row.theta_rad, &row.a_mm, &row.alpha_rad, &row.beta_rad}) {
        const bool beta = number == &row.beta_rad && row.relation == identify::Relation::unknown;
        if (number->knowledge == Knowledge::undetermined) {
          all_known = all_known && beta;
          continue;
        }
        REQUIRE(std::isfinite(number->value));
        REQUIRE(std::isfinite(number->sigma));
      }
    const bool without_doubt = all_known && found.doubts.empty();
    REQUIRE((found.status == identify::Status::complete) == without_doubt);
    REQUIRE(found.reason.empty() == without_doubt);
    if (all_known) ++complete;
    if (run % 10 == 0) REQUIRE_FALSE(has_word_for_not_finite(files_of(found)));
  }
  // Neither side of the question is empty.
  CHECK(complete > kRuns / 20);
  CHECK(complete < kRuns / 2);
}

TEST_CASE("a number that is none is null in result.json, and its place is named",
          "[given_axes][issue11][point_21]") {
  sweepd::Outcome outcome;
  outcome.identification.chain.emplace();
  outcome.identification.chain->summary.condition = std::numeric_limits<double>::infinity();
  const auto json = nlohmann::json::parse(sweepd::result_json(outcome));
  CHECK(json["estimates"]["chain"]["summary"]["condition"].is_null());
  CHECK(json["not_finite"] == nlohmann::json{"/estimates/chain/summary/condition"});
}
