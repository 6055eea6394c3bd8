#include "daemon/stream/joint_currents.hpp"

#include <cmath>
#include <functional>

#include "daemon/stream/session.hpp"
#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/telegrams.hpp"

using namespace sweepd;
using Catch::Matchers::ContainsSubstring;
using sweepd::test::from_controller;
using sweepd::test::telegram;

namespace {

/// Joint 2 moves back and forth at 10 deg/s between 0 and 20 degrees; the others stand.
class Drive {
 public:
  /// `current`: by angle and direction.
  void stroke(double from_deg, double to_deg, const std::function<double(double, int)>& current) {
    const int way = to_deg > from_deg ? 1 : -1;
    for (double at = from_deg; way * (to_deg - at) > 1e-9; at += way * 0.04)
      moment(at, current(at, way));
    for (int k = 0; k < 100; ++k) moment(to_deg, 99);  // at rest: not to be counted
  }
  void moment(double angle_deg, double current, double other_deg = 0) {
    identify::Sample sample;
    sample.time_s = time_s += 0.004;
    sample.joints = 6;
    sample.angles_rad[1] = radians(angle_deg);
    sample.angles_rad[4] = radians(other_deg);
    Currents currents{};
    currents[1] = current;
    seen.take(sample, currents);
  }

  JointCurrents seen;
  double time_s = 0;
};

double weight_and_friction(double angle_deg, int way) {
  return 0.1 * angle_deg + 1.5 * way;
}

}  // namespace

TEST_CASE("Half the difference of rising and falling is friction, whatever the weight",
          "[joint_currents]") {
  Drive drive;
  drive.stroke(0, 20, weight_and_friction);
  drive.stroke(20, 0, weight_and_friction);
  REQUIRE(drive.seen.joints().size() == 2);
  CHECK(drive.seen.joints()[0].places.empty());
  const auto& joint = drive.seen.joints()[1];
  const auto friction = joint.friction();
  CHECK(friction.places >= 17);
  CHECK(friction.mean == Approx(1.5).margin(0.02));
  CHECK(friction.scatter < 0.05);
  CHECK(joint.speed_deg_s.value() == Approx(10).margin(0.1));
  CHECK(joint.places.at(10).rising.value() == Approx(0.1 * 10.5 + 1.5).margin(0.05));
}

TEST_CASE("One direction alone tells no friction", "[joint_currents]") {
  Drive drive;
  drive.stroke(0, 20, weight_and_friction);
  CHECK(drive.seen.joints()[1].friction().places == 0);
  CHECK_FALSE(drive.seen.joints()[1].places.empty());
}

TEST_CASE(
    "Currents of two joints that move together, of unsteady motion and over a gap do not count",
    "[joint_currents]") {
  Drive drive;
  SECTION("two joints") {
    for (int k = 0; k < 500; ++k) drive.moment(0.04 * k, 1, 0.02 * k);
  }
  SECTION("speeding up") {
    for (int k = 0; k < 500; ++k) drive.moment(1e-4 * k * k, 1);
  }
  SECTION("gaps") {
    for (int k = 0; k < 500; ++k) {
      drive.moment(0.04 * k, 1);
      if (k % 20 == 0) drive.time_s += 1;
    }
  }
  for (const auto& joint : drive.seen.joints()) CHECK(joint.places.empty());
}

TEST_CASE("A stream whose first telegram has currents has them in its samples",
          "[joint_currents]") {
  StreamSink nobody;
  const Session with(RobotSetup{}, "trace", nobody, R"(<Rob Type="KUKA"><MACur A1="0.5"/>)");
  CHECK_THAT(with.csv_header(), ContainsSubstring(",a6_deg,a1_current_a,a2_current_a"));
  for (const char* first : {"", R"(<Rob Type="KUKA"><RIst X="0.5"/>)"}) {
    const Session without(RobotSetup{}, "trace", nobody, first);
    CHECK_THAT(without.csv_header(), !ContainsSubstring("current"));
  }
}

TEST_CASE("Currents are those of the telegram, empty where one is missing or no number",
          "[joint_currents]") {
  SampleReader reader(SignalNames{}, 3, true);
  rsi::Telegram parsed;
  const std::string text = telegram(4, R"(<MACur A1="0.5" A2="x" A3="-1.25"/>)");
  REQUIRE(parsed.parse(text) == rsi::Defect::none);
  static_cast<void>(reader.read(parsed));
  REQUIRE(reader.currents());
  CHECK(reader.currents()->at(0) == 0.5);
  CHECK(std::isnan(reader.currents()->at(1)));
  CHECK(reader.currents()->at(2) == -1.25);
  std::string row;
  reader.append_csv(row);
  CHECK(row == ",,,,,,,,,,0.5,,-1.25");
  const std::string none = telegram(8, "");
  REQUIRE(parsed.parse(none) == rsi::Defect::none);
  static_cast<void>(reader.read(parsed));
  CHECK_FALSE(reader.currents());
  // Nor are those of the telegram before told again.
  row.clear();
  reader.append_csv(row);
  CHECK(row == ",,,,,,,,,,,,");
}
