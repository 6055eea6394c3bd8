// Points that were measured on a positioning table with one rotary joint.

#include <iostream>

#include "daemon/text/units.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/sweeps/sample.hpp"
#include "tests/acceptance/acceptance.hpp"
#include "tests/catch.hpp"

using namespace acceptance;

TEST_CASE("The circle of a measured rotary table has the published figures",
          "[positioning_table]") {
  const auto folder = real_data("positioning-table");
  if (!folder) return;
  // joint, x, y, z (mm), encoder, type, home
  std::vector<identify::Sample> samples;
  for (const auto& line : lines_of(*folder / "sscanss2-table.txt")) {
    const auto row = fields(line, '\t');
    REQUIRE(row.size() == 7);
    if (row[5] != "revolute") continue;
    CHECK(row[0] == "2");
    identify::Sample sample;
    sample.position_mm = {number(row[1]), number(row[2]), number(row[3])};
    sample.has_position = true;
    samples.push_back(sample);
  }
  REQUIRE(samples.size() == 11);
  const auto circle = identify::fit_circle(identify::positions(samples));
  REQUIRE(circle);
  std::cout << "rotary joint, 11 points: radius " << right(circle->radius_mm, 3, 0) << " mm, arc "
            << right(sweepd::degrees(circle->arc_rad), 1, 0) << " deg, plane "
            << right(1000 * circle->plane_rms_mm, 1, 0) << " um rms, radial "
            << right(1000 * circle->radial_rms_mm, 1, 0) << " um rms\n";
  // The figures are published to their last digit.
  CHECK(circle->radius_mm == Approx(53.606).margin(0.0005));
  CHECK(1000 * circle->plane_rms_mm == Approx(4.9).margin(0.05));
  CHECK(1000 * circle->radial_rms_mm == Approx(16.9).margin(0.05));
  CHECK(sweepd::degrees(circle->arc_rad) == Approx(360).margin(0.2));
}
