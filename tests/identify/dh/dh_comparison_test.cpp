#include "identify/dh/dh_comparison.hpp"

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"

using namespace identify;

namespace {

DhEstimate row(double b_mm, double theta_deg) {
  DhEstimate row;
  row.b_mm = {b_mm, 0.01, Knowledge::identified};
  row.theta_rad = {theta_deg * kDegree, 1e-5, Knowledge::identified};
  return row;
}

}  // namespace

TEST_CASE("Of several tables that may be each other value of a number is named, once",
          "[dh_comparison]") {
  const std::vector<DhEstimate> table{row(400, 20), row(1, -25)};
  const auto told = [&](const std::vector<std::vector<DhEstimate>>& others) {
    return differing_numbers(table, other_numbers(table, others));
  };
  CHECK(told({{row(400, 20), row(1, -25)}}) == "the table would be the same");
  CHECK(told({{row(400, 380), row(1, 335)}}) == "the table would be the same");
  CHECK(told({{row(400, 20), row(1, 155)},
              {row(-400, 20), row(1, 155)},
              {row(400, 20), row(1, 35)}}) ==
        "the other way, b1 would be -400.00 instead of 400.00 mm, theta2 would be 155.00 or 35.00 "
        "instead of -25.00 deg");
}

TEST_CASE("How far each of other tables has a number elsewhere is told, angles by the shorter way",
          "[dh_comparison]") {
  const std::vector<DhEstimate> table{row(400, 170), row(1, -25)};
  auto unknown = table;
  unknown[1].b_mm = {};
  const auto others = other_numbers(table, {{row(390, -170), row(1, -25)}, unknown, table});
  REQUIRE(others.size() == 2);
  CHECK(others[0].row == 0);
  CHECK(kDhNumbers[others[0].number].name == "b");
  CHECK_THAT(others[0].differences, Catch::Matchers::Approx(std::vector<double>{-10}));
  CHECK(kDhNumbers[others[1].number].name == "theta");
  REQUIRE(others[1].differences.size() == 1);
  CHECK(others[1].differences[0] == Approx(20 * kDegree));
}
