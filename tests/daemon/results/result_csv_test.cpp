#include <algorithm>
#include <cmath>
#include <sstream>

#include "daemon/results/result_formats.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/outcomes.hpp"
#include "tests/daemon/texts.hpp"

using namespace sweepd::test;
using sweepd::dh_csv;
using sweepd::sweeps_csv;

namespace {

using Row = std::vector<std::string>;

std::vector<Row> table(const std::string& csv) {
  std::vector<Row> rows;
  std::istringstream stream(csv);
  for (std::string line; std::getline(stream, line);) {
    Row row(1);
    for (const char c : line)
      if (c == ',')
        row.emplace_back();
      else
        row.back() += c;
    rows.push_back(row);
  }
  return rows;
}

std::size_t column(const std::vector<Row>& rows, const std::string& name) {
  const auto at = std::find(rows[0].begin(), rows[0].end(), name);
  INFO(name);
  REQUIRE(at != rows[0].end());
  return static_cast<std::size_t>(at - rows[0].begin());
}

}  // namespace

TEST_CASE("dh.csv has a row a joint: identified, uncertainty, specified, difference",
          "[result_csv]") {
  const auto rows = table(dh_csv(complete_outcome()));
  CHECK(rows.at(0) == Row{"joint",
                          "b_mm",
                          "b_sigma_mm",
                          "b_specified_mm",
                          "b_difference_mm",
                          "theta_deg",
                          "theta_sigma_deg",
                          "theta_specified_deg",
                          "theta_difference_deg",
                          "a_mm",
                          "a_sigma_mm",
                          "a_specified_mm",
                          "a_difference_mm",
                          "alpha_deg",
                          "alpha_sigma_deg",
                          "alpha_specified_deg",
                          "alpha_difference_deg",
                          "relation",
                          "by_convention",
                          "beta_deg",
                          "beta_sigma_deg",
                          "b_low_mm",
                          "b_high_mm",
                          "theta_low_deg",
                          "theta_high_deg",
                          "a_low_mm",
                          "a_high_mm",
                          "alpha_low_deg",
                          "alpha_high_deg",
                          "beta_low_deg",
                          "beta_high_deg",
                          "positive",
                          "home_deg",
                          "variable"});
  REQUIRE(rows.size() == 7);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    REQUIRE(rows[i].size() == rows[0].size());
    CHECK(rows[i][0] == std::to_string(i));
  }
  CHECK(number_in(rows[1][1]) == Approx(400).margin(0.02));
  CHECK(number_in(rows[1][3]) == 400);
  CHECK(number_in(rows[1][4]) == Approx(number_in(rows[1][1]) - 400).margin(1e-6));
  CHECK(rows[1][17] == "skew");
  CHECK(rows[1][18].empty());
  CHECK(rows[1][column(rows, "beta_deg")].empty());
  CHECK(std::abs(number_in(rows[2][column(rows, "beta_deg")])) < 1e-3);
  CHECK(number_in(rows[1][column(rows, "b_high_mm")]) - number_in(rows[1][1]) ==
        Approx(1.96 * number_in(rows[1][2])).margin(3e-6));  // each is rounded to 1e-6
}

TEST_CASE("dh.csv tells which way joints count, and the home that theta belongs to",
          "[result_csv]") {
  auto outcome = complete_outcome();
  outcome.positive = {-1, -1, -1, 1, 1, 1};
  outcome.identification.home_rad[4].reset();
  const auto rows = table(dh_csv(outcome));
  const auto positive = column(rows, "positive");
  const auto home = column(rows, "home_deg");
  CHECK(rows[1][positive] == "-1");
  CHECK(rows[4][positive] == "1");
  CHECK(number_in(rows[2][home]) == Approx(-90).margin(1e-3));
  CHECK(rows[5][home].empty());
}

TEST_CASE("dh.csv leaves empty what convention sets and what nobody knows", "[result_csv]") {
  const auto complete = table(dh_csv(complete_outcome()));
  CHECK(number_in(complete.at(2)[1]) == 0);  // b of parallel axes
  CHECK(complete[2][2].empty());
  CHECK(complete[2][4].empty());
  CHECK(complete[2][18] == "b_mm");
  CHECK(complete[6][18] == "b_mm theta_deg a_mm alpha_deg");

  const auto partial = table(dh_csv(partial_outcome()));
  const auto a = column(partial, "a_mm");
  CHECK(partial.at(2)[a].empty());
  CHECK(partial[2][a + 1].empty());
  CHECK(number_in(partial[2][a + 2]) == 600);
  CHECK(partial[2][a + 3].empty());

  const auto unspecified = table(dh_csv(unspecified_outcome()));
  CHECK(unspecified.at(1)[column(unspecified, "b_specified_mm")].empty());
  CHECK(unspecified[1][column(unspecified, "b_difference_mm")].empty());
  CHECK_FALSE(unspecified[1][column(unspecified, "b_mm")].empty());
}

TEST_CASE("sweeps.csv has each sample that was used, and its distance from plane and circle",
          "[result_csv]") {
  const auto outcome = complete_outcome();
  const auto rows = table(sweeps_csv(outcome));
  CHECK(rows.at(0) == Row{"joint", "sweep", "t_s", "x_mm", "y_mm", "z_mm", "a1_deg", "a2_deg",
                          "a3_deg", "a4_deg", "a5_deg", "a6_deg", "plane_residual_mm",
                          "radial_residual_mm", "chain_axial_residual_mm",
                          "chain_radial_residual_mm", "angle_error_arcsec", "curve_error_arcsec",
                          "target"});
  std::size_t used = 0;
  const auto& joints = outcome.identification.joints;
  for (const auto& joint : joints)
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s)
      if (joint.used[s]) used += joint.sweeps[s].samples->size();
  CHECK(rows.size() == used + 1);

  double squares = 0;
  std::size_t of_joint_1 = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    REQUIRE(rows[i].size() == rows[0].size());
    if (rows[i][0] != "1") continue;
    CHECK(rows[i][1] == "2");  // the first is the way from home to the sweep's start
    const double residual = number_in(rows[i][12]);
    squares += residual * residual;
    ++of_joint_1;
  }
  // As result.json has it; residuals are rounded to 1e-6.
  CHECK(std::sqrt(squares / static_cast<double>(of_joint_1)) ==
        Approx(joints[0].circle->plane_rms_mm).margin(2e-6));
}

TEST_CASE("sweeps.csv has no columns of angles where there are none, and no rows without a circle",
          "[result_csv]") {
  CHECK(sweeps_csv(failed_outcome()) ==
        "joint,sweep,t_s,x_mm,y_mm,z_mm,plane_residual_mm,radial_residual_mm,"
        "chain_axial_residual_mm,chain_radial_residual_mm,angle_error_arcsec,curve_error_arcsec,"
        "target\n");
}

TEST_CASE("sweeps.csv has the sweeps from a second home too, which the chain uses",
          "[result_csv]") {
  identify::test::Campaign campaign(identify::test::kr5_arc(), {.wobble_deg = 1e-4});
  campaign.sweep_all_90();
  campaign.move(2, 70).rest().sweep(0, -45, 45);
  const auto outcome = outcome_of(campaign.samples(), sweepd::test::kr5_campaign());
  const auto rows = table(sweeps_csv(outcome));
  const auto& joint = outcome.identification.joints[0];
  std::size_t elsewhere = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    CHECK(rows[i][column(rows, "target")] == "1");
    if (rows[i][0] != "1" || joint.used.at(std::stoul(rows[i][1]) - 1)) continue;
    ++elsewhere;
    CHECK(rows[i][column(rows, "plane_residual_mm")].empty());
    CHECK(std::abs(number_in(rows[i][column(rows, "chain_radial_residual_mm")])) < 4e-3);
  }
  CHECK(elsewhere > 100);
}

TEST_CASE("sweeps.csv has where each sample lies to the chain, and the error of its angle",
          "[result_csv]") {
  auto outcome = complete_outcome();
  const auto rows = table(sweeps_csv(outcome));
  const auto axial = column(rows, "chain_axial_residual_mm");
  const auto radial = column(rows, "chain_radial_residual_mm");
  const auto error = column(rows, "angle_error_arcsec");
  for (std::size_t i = 1; i < rows.size(); ++i) {
    // At most half a step of six angles, with levers of 2 m in all, and of a position: 1.8e-3 mm,
    // and that at 200 mm from the axis.
    CHECK(std::abs(number_in(rows[i][axial])) < 2e-3);
    CHECK(std::abs(number_in(rows[i][radial])) < 2e-3);
    CHECK(std::abs(number_in(rows[i][error])) < 2);
  }
  outcome.identification.chain.reset();
  const auto without = table(sweeps_csv(outcome));
  CHECK(without.at(1).size() == rows[1].size());
  CHECK(without[1][axial].empty());
  CHECK(without[1][error].empty());
}

TEST_CASE("sweeps.csv keeps the decimals that were measured, so that its reader knows the step",
          "[result_csv]") {
  const auto rows = table(sweeps_csv(complete_outcome()));
  std::size_t most = 0;
  for (std::size_t i = 1; i < rows.size(); ++i)
    for (std::size_t k = 3; k < 12; ++k) {
      const auto point = rows[i][k].find('.');
      if (point != std::string::npos) most = std::max(most, rows[i][k].size() - point - 1);
    }
  CHECK(most == 4);
}
