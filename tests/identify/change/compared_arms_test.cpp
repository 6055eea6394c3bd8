#include "identify/change/compared_arms.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Cholesky>

#include "identify/dh/placed_axes.hpp"
#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/change/measured_arms.hpp"

using namespace identify;
using Eigen::Vector3d;
using identify::test::measured;
using identify::test::Measuring;
using simulation::Robot;

namespace {

Robot built_kr5() {
  return simulation::built(simulation::kr5(), 3);
}

std::string names(const ComparedArms& arms) {
  std::string all;
  for (const ArmNumber& number : arms.numbers)
    all += std::string(text(number.kind)) + std::to_string(number.joint + 1) + ' ';
  return all;
}

/// Of the number, in mm or rad.
double difference(const ComparedArms& arms, ArmNumberKind kind, std::size_t joint) {
  for (std::size_t k = 0; k < arms.numbers.size(); ++k)
    if (arms.numbers[k].kind == kind && arms.numbers[k].joint == joint)
      return arms.difference(static_cast<Eigen::Index>(k));
  FAIL("the number is not compared");
  return 0;
}

/// What differentiating and rounding leave, in mm and rad.
constexpr double kNothingLeft = 1e-8;

Eigen::Isometry3d other_base() {
  return Eigen::Translation3d(1500, -2500, 300) *
         Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
}

/// A SCARA whose upright axes are some hundredths of a degree off parallel. Its linear joint is
/// seen by a target that is so high at home, at which it has gone so far.
MeasuredArm scara(double target_height_mm, double base_height_mm = 0, double gone_mm = 0,
                  double leans_deg = 0, const std::vector<DhRow>& specified = {}) {
  const auto upright = [&](double x, double y, double tilt_x, double tilt_y) {
    const Vector3d along = Vector3d(tilt_x * kDegree, tilt_y * kDegree, 1).normalized();
    return Axis{along, Vector3d(x, y, -base_height_mm)};
  };
  std::vector<std::optional<Axis>> axes = {upright(0, 0, 0, 0), upright(350, 40, 0.03, -0.02),
                                           upright(0, 0, -0.04, 0.05 + leans_deg),
                                           upright(500, 320, 0.02, 0.03)};
  axes[2]->linear = true;
  axes[2]->point_mm = {480, 300, target_height_mm - base_height_mm};
  for (const std::size_t k : {2UL, 3UL}) axes[k]->point_mm += gone_mm * axes[2]->direction;
  for (auto& axis : axes) axis->covariance = 1e-10 * Eigen::Matrix<double, 6, 6>::Identity();
  MeasuredArm arm;
  arm.dh = placed_table(axes, specified, 1500);
  arm.covariance = Eigen::MatrixXd::Zero(20, 20);
  Eigen::Index at = 0;
  for (DhEstimate& row : arm.dh)
    for (const DhNumber* number : numbers_of(row)) {
      const bool length = at % 5 == 0 || at % 5 == 2;
      if (number->knowledge == Knowledge::identified)
        arm.covariance(at, at) = std::pow(length ? 0.02 : 1e-5, 2);
      ++at;
    }
  arm.positive.assign(4, 1);
  arm.home_rad.assign(4, 0);
  arm.home_rad[2] = gone_mm * kDegree;
  arm.gear.assign(4, 0);
  return arm;
}

}  // namespace

TEST_CASE("where convention puts a linear joint's axis changes no number of the arm",
          "[compared_arms]") {
  const auto first = scara(150), lower = scara(-250);
  REQUIRE(first.dh[2].linear);
  REQUIRE(std::abs(first.dh[1].theta_rad.value - lower.dh[1].theta_rad.value) > 0.05 * kDegree);
  const auto arms = compared(first, lower);
  CHECK(names(arms) == "a1 alpha1 beta1 zero2 a2 alpha2 beta2 alpha3 beta3 ");
  CHECK(arms.difference.cwiseAbs().maxCoeff() < kNothingLeft);
  CHECK_FALSE(arms.height_mm);
}

TEST_CASE("a linear joint that leans shows in where it points", "[compared_arms]") {
  std::vector<DhRow> specified(4);
  specified[0].a_mm = specified[1].a_mm = 300;
  std::optional<double> alpha;
  for (const double theta3_deg : {0.0, 90.0}) {  // whatever convention its table has
    CAPTURE(theta3_deg);
    specified[2].theta_rad = theta3_deg * kDegree;
    const auto leaning = scara(150, 0, 0, 0.3, specified);
    CHECK(std::abs(wrapped(leaning.dh[2].theta_rad.value - specified[2].theta_rad)) < kDegree);
    const auto arms = compared(scara(150), leaning);
    const double by_alpha = difference(arms, ArmNumberKind::alpha, 2);
    if (alpha) CHECK(by_alpha == Approx(*alpha).epsilon(1e-3));
    alpha = by_alpha;
    CHECK(std::hypot(by_alpha, difference(arms, ArmNumberKind::beta, 2)) ==
          Approx(0.3 * kDegree).epsilon(0.01));
    for (const ArmNumberKind kind : {ArmNumberKind::a, ArmNumberKind::alpha, ArmNumberKind::beta})
      CHECK(std::abs(difference(arms, kind, 0)) < kNothingLeft);
  }
}

TEST_CASE("a linear joint's row stays as it is where its alpha passes zero", "[compared_arms]") {
  std::vector<DhRow> specified(4);
  specified[0].a_mm = specified[1].a_mm = 300;
  constexpr double kBy_deg = 0.002;
  int signs = 0;
  for (const double theta3_deg : {0.0, 90.0}) {
    specified[2].theta_rad = theta3_deg * kDegree;
    for (double leans_deg = -0.1; leans_deg < 0.1; leans_deg += kBy_deg) {
      CAPTURE(theta3_deg, leans_deg);
      const auto first = scara(150, 0, 0, leans_deg, specified);
      const auto arms = compared(first, scara(150, 0, 0, leans_deg + kBy_deg, specified));
      CHECK(std::hypot(difference(arms, ArmNumberKind::alpha, 2),
                       difference(arms, ArmNumberKind::beta, 2)) ==
            Approx(kBy_deg * kDegree).epsilon(0.01));
      const auto alpha = static_cast<Eigen::Index>(arms.numbers.size()) - 2;
      if (arms.first(alpha) * arms.second(alpha) < 0) ++signs;
    }
  }
  CHECK(signs > 0);
}

TEST_CASE("a linear joint that stands elsewhere at home changes no number of the arm",
          "[compared_arms]") {
  const auto first = scara(150), lower = scara(150, 0, -80);
  for (const auto& arms : {compared(first, lower), compared(lower, first)})
    CHECK(arms.difference.cwiseAbs().maxCoeff() < kNothingLeft);
}

TEST_CASE("a base that may stand anywhere along parallel axes is taken where the arms agree",
          "[compared_arms]") {
  auto first = scara(150), higher = scara(150, 1200);
  CHECK(std::abs(difference(compared(first, higher), ArmNumberKind::a, 0)) > 0.5);
  higher.height_known = false;
  const auto arms = compared(first, higher);
  REQUIRE(arms.height_mm);
  CHECK(*arms.height_mm == Approx(-1200).epsilon(0.01));
  CHECK(arms.difference.cwiseAbs().maxCoeff() < 0.01);
  const auto sigmas = [](const ComparedArms& of) {
    return std::sqrt(of.difference.dot(of.covariance().ldlt().solve(of.difference)));
  };
  CHECK(sigmas(arms) < 0.1);
  SECTION("and by one description, as high as that says, but for where the target is") {
    auto longer = scara(150, 80);
    longer.height_known = false;
    longer.specified = first.specified = std::vector<DhRow>(4);
    CHECK(sigmas(compared(first, longer)) < 0.5);
    longer.dh[1].a_mm.value -= 1.4;
    for (MeasuredArm* arm : {&first, &longer})  // so that angles do not tell the height
      for (const Eigen::Index theta : {6, 11}) arm->covariance(theta, theta) = 1e-6;
    const auto changed = compared(first, longer);
    CHECK_FALSE(changed.height_mm);
    for (std::size_t k = 0; k < changed.numbers.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      const double sigma = std::sqrt(changed.covariance()(at, at));
      const bool is_changed =
          changed.numbers[k].kind == ArmNumberKind::a && changed.numbers[k].joint == 1;
      CHECK((std::abs(changed.difference(at)) > 3 * sigma) == is_changed);
    }
  }
  SECTION("but not where one of them has changed") {
    higher.dh[1].theta_rad.value += 0.2 * kDegree;
    CHECK(sigmas(compared(first, higher)) > 10);
  }
}

TEST_CASE("numbers of an arm do not change with base, home and table", "[compared_arms]") {
  const Robot robot = built_kr5();
  const auto first = measured(robot);
  const auto other = GENERATE(0, 1, 2, 3);
  Robot elsewhere = robot;
  Measuring how;
  if (other == 0 || other == 3) how.base = other_base();
  if (other == 1 || other == 3) elsewhere = simulation::at_random_home(robot, 5);
  if (other == 2 || other == 3) how.specified = false;
  CAPTURE(other);
  const auto arms = compared(first, measured(elsewhere, how));
  CHECK(names(arms) ==
        "a1 alpha1 zero2 a2 alpha2 beta2 b3 zero3 a3 alpha3 b4 zero4 a4 alpha4 b5 zero5 a5 "
        "alpha5 ");
  CHECK(arms.difference.cwiseAbs().maxCoeff() < kNothingLeft);
  // The axes are as uncertain in whatever form they are written; from other homes they are not.
  if (other == 0 || other == 2) CHECK(arms.second_covariance.isApprox(arms.first_covariance, 1e-3));
  CHECK(arms.other_homes.empty());  // gears are perfect
}

TEST_CASE("a joint that lost its zero shows in that zero alone", "[compared_arms]") {
  const Robot robot = built_kr5();
  Robot crashed = robot;
  crashed.arm.rows[3].theta_rad += 0.02 * kDegree;
  const auto arms = compared(measured(robot), measured(crashed, {other_base(), false}));
  // Angles along positive rotation, which is about -Z of the table.
  CHECK(difference(arms, ArmNumberKind::zero, 3) == Approx(-0.02 * kDegree).epsilon(1e-6));
  auto others = arms.difference;
  for (std::size_t k = 0; k < arms.numbers.size(); ++k)
    if (arms.numbers[k].kind == ArmNumberKind::zero && arms.numbers[k].joint == 3)
      others(static_cast<Eigen::Index>(k)) = 0;
  CHECK(others.cwiseAbs().maxCoeff() < kNothingLeft);
}

TEST_CASE("axes that only one of two takes for parallel are compared as parallel ones",
          "[compared_arms]") {
  Robot robot = built_kr5();
  robot.arm.rows[1].alpha_rad = 1.2 * kDegree;  // well beyond what passes for parallel
  Robot closer = robot;
  closer.arm.rows[1].alpha_rad = 0.5 * kDegree;
  const auto first = measured(robot), second = measured(closer);
  REQUIRE(first.dh[1].relation == Relation::skew);
  REQUIRE(second.dh[1].relation == Relation::parallel);
  const auto arms = compared(first, second);
  CHECK(names(arms).find("beta2") != std::string::npos);
  CHECK(difference(arms, ArmNumberKind::alpha, 1) == Approx(-0.7 * kDegree).epsilon(0.01));
  CHECK(std::abs(difference(arms, ArmNumberKind::a, 1)) < 0.01);
  CHECK(std::abs(difference(arms, ArmNumberKind::b, 2)) <
        0.5);  // it was some 100 mm along skew axes
  const auto same = compared(second, measured(closer, {other_base(), true}));
  CHECK(same.difference.cwiseAbs().maxCoeff() < kNothingLeft);
}

TEST_CASE("what the homes do not tell is left out, and what gears do there counts",
          "[compared_arms]") {
  const Robot robot = built_kr5();
  const auto first = measured(robot);
  auto second = measured(simulation::at_random_home(robot, 5));
  const auto without = compared(first, second);
  const auto more = [&] {
    return (compared(first, second).second_covariance - without.second_covariance).eval();
  };
  // One joint's gear: as much as all show on average; its own where it shows more.
  second.gear[3] = 1e-3;
  const double usual = 1e-6 / 12;
  double expected = 0;
  for (const std::size_t j : {1U, 2U, 3U, 4U})
    expected += (j == 3 ? 1e-6 : usual) * std::pow(*second.home_rad[j] - *first.home_rad[j], 2);
  CHECK(more().sum() == Approx(expected));
  CHECK(more().trace() == Approx(expected));

  CHECK(compared(first, second).other_homes.size() == 4);

  second.gear[1].reset();
  second.home_rad[2].reset();
  const auto arms = compared(first, second);
  CHECK(names(arms).find("zero2") == std::string::npos);
  CHECK(names(arms).find("zero3") == std::string::npos);
  REQUIRE(arms.left_out.size() == 4);  // b1 and zero1 as ever
  CHECK(arms.left_out[2].because == LeftOutBecause::other_home);
  CHECK(arms.left_out[3].because == LeftOutBecause::no_home);
  second.home_rad[1] = *first.home_rad[1] + 0.4 * kDegree;
  CHECK(names(compared(first, second)).find("zero2") != std::string::npos);
}
