#include "daemon/points/wrapped_angles.hpp"

#include "daemon/text/units.hpp"
#include "tests/catch.hpp"

using sweepd::degrees;
using sweepd::radians;

namespace {

/// The angles of joint 1 in degrees, one a line, after the turns were taken out.
std::vector<double> without_turns(const std::vector<double>& told_deg, bool linear = false) {
  std::vector<sweepd::PointsFile> files(1);
  files[0].linear = {linear};
  for (const double deg : told_deg) {
    auto& point = files[0].points.emplace_back();
    point.sample.joints = 1;
    point.sample.angles_rad[0] = radians(deg);
  }
  sweepd::take_out_turns(files);
  std::vector<double> deg;
  for (const auto& point : files[0].points) deg.push_back(degrees(point.sample.angles_rad[0]));
  return deg;
}

void check_angles(const std::vector<double>& found, const std::vector<double>& wanted) {
  REQUIRE(found.size() == wanted.size());
  for (std::size_t k = 0; k < found.size(); ++k) CHECK(found[k] == Approx(wanted[k]).margin(1e-9));
}

}  // namespace

TEST_CASE("an angle that jumps at the circle's end goes on", "[wrapped_angles]") {
  check_angles(without_turns({350, 355, 0, 5, 10}), {-10, -5, 0, 5, 10});
  check_angles(without_turns({10, 0, 350, 340}), {10, 0, -10, -20});
  check_angles(without_turns({170, 175, -180, -175}), {170, 175, 180, 185});
}

TEST_CASE("angles that do not jump by a turn stay as they are", "[wrapped_angles]") {
  for (const auto& told : std::vector<std::vector<double>>{
           {-170, -90, 0, 90, 170},
           {0, 90, 180, 270},
           {350, 10, 350, 10, 200, -10},  // beyond the circle: there is no end to pass
           {0, 30, 60, 90, 120, 150, 180, 210, 240, 270, 300, 330, 355, 0}})  // once round
    check_angles(without_turns(told), told);
}

TEST_CASE("a linear joint has no turns", "[wrapped_angles]") {
  check_angles(without_turns({355, 0, 5}, true), {355, 0, 5});
}
