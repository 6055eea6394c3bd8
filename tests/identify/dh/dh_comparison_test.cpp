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
  CHECK(differing_numbers(table, {{row(400, 20), row(1, -25)}}) == "the table would be the same");
  CHECK(differing_numbers(table, {{row(400, 20), row(1, 155)},
                                  {row(-400, 20), row(1, 155)},
                                  {row(400, 20), row(1, 35)}}) ==
        "the other way, b1 would be -400.00 instead of 400.00 mm, theta2 would be 155.00 or 35.00 "
        "instead of -25.00 deg");
}
