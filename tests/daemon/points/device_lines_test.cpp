#include "daemon/points/device_lines.hpp"

#include <stdexcept>

#include "tests/catch.hpp"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using sweepd::DeviceLines;
using sweepd::Point;
using Line = sweepd::DeviceLines::Line;

TEST_CASE("Lines are read by their columns, whatever stands between the fields", "[device_lines]") {
  DeviceLines lines("t_s,x_mm,y_m,z_mm,-");
  for (const char* line : {"1.5,10.25,0.02,-30,OK", "1.5;10.25;0.02;-30;OK\r",
                           "1.5\t10.25\t0.02\t-30\t", " 1.5  10.25 0.02   -30 OK "}) {
    Point point;
    INFO(line);
    REQUIRE(lines.read(line, point) == Line::point);
    CHECK(point.sample.time_s == 1.5);
    CHECK(point.sample.position_mm == Eigen::Vector3d(10.25, 20, -30));
  }
}

TEST_CASE("What is no point says what it is", "[device_lines]") {
  DeviceLines lines("t_s,x_mm,y_mm,z_mm");
  Point point;
  CHECK(lines.read("", point) == Line::empty);
  CHECK(lines.read("# t, x, y, z", point) == Line::empty);
  CHECK(lines.read("1,2,3", point) == Line::other_fields);
  CHECK(lines.read("1,2,3,4,5", point) == Line::other_fields);
  CHECK(lines.read("now,2,3,4", point) == Line::no_number);
  CHECK(lines.read("1,2,nan,4", point) == Line::no_number);
  CHECK(lines.read("1,2,1e300,4", point) == Line::no_number);
  CHECK(lines.read("1,,,", point) == Line::not_seen);
}

TEST_CASE("Targets are told apart by name, and a flood of names is none", "[device_lines]") {
  DeviceLines lines("target,x_mm,y_mm,z_mm");
  Point point;
  point.sample.time_s = 7;
  REQUIRE(lines.read("SMR 1,1,2,3", point) == Line::point);
  CHECK(point.sample.time_s == 7);  // there is no column for it
  REQUIRE(lines.read("SMR 2,1,2,3", point) == Line::point);
  CHECK(point.target == 1);
  CHECK(lines.read(",1,2,3", point) == Line::no_number);
  for (int i = 0; i < 1000; ++i) static_cast<void>(lines.read(std::to_string(i) + ",1,2,3", point));
  CHECK(lines.targets().size() == 64);
}

TEST_CASE("Columns that a device cannot have are refused", "[device_lines]") {
  CHECK_THROWS_AS(DeviceLines("t_s,x_mm"), std::invalid_argument);
  CHECK_THROWS_WITH(DeviceLines("joint,x_mm,y_mm,z_mm"), ContainsSubstring("controller tells"));
  CHECK_THROWS_WITH(DeviceLines("t_s,x_mm,y_mm,z_mm,a1_deg"), ContainsSubstring("controller"));
  CHECK_THROWS_AS(DeviceLines(""), std::invalid_argument);
  // They may stand in the settings: no option of the command line is named.
  CHECK_THROWS_WITH(DeviceLines("t_s,x,y_mm,z_mm"),
                    StartsWith("columns, column 2 (x): expected a known column") &&
                        ContainsSubstring("write - to skip it") && !ContainsSubstring("--"));
}

TEST_CASE("Numbers may have decimal commas where no commas stand between", "[device_lines]") {
  DeviceLines lines("t_s,x_mm,y_m,z_mm,-");
  for (const char* line : {"1,5;10,25;0,02;-30,0;OK", "1,5\t10,25\t0,02\t-30\t",
                           "1,5 10,25 0,02 -30 OK", "1.5; 10.25; 0.02; -30.0; OK, seen"}) {
    Point point;
    INFO(line);
    REQUIRE(lines.read(line, point) == Line::point);
    CHECK(point.sample.time_s == 1.5);
    CHECK(point.sample.position_mm == Eigen::Vector3d(10.25, 20, -30));
  }
  CHECK(lines.step_mm() == Approx(0.01));
  Point point;
  for (const char* line : {"1,5;1.010,25;0,02;-30,0;OK", "1,5;1,010,25;0,02;-30,0;OK",
                           "1,5;0,0000000000000000000000000000000001;0,02;-30,0;OK"}) {
    INFO(line);
    CHECK(lines.read(line, point) == Line::no_number);
  }
}

TEST_CASE("A comma that may stand between thousands is no decimal one until a line shows it",
          "[device_lines]") {
  DeviceLines lines("x_mm,y_mm,z_mm");
  Point point;
  // 1.234 mm, or 1234 mm?
  for (const char* line : {"1,234;567;-890", "1,234;567.5;-890.25", "1,234\t-2,345\t0"}) {
    INFO(line);
    CHECK(lines.read(line, point) == Line::thousands);
  }
  CHECK(lines.read("1,234;;", point) == Line::not_seen);
  // All alike to three decimals, as programs print them.
  REQUIRE(lines.read("1,234;567,000;-890,125", point) == Line::point);
  CHECK(point.sample.position_mm == Eigen::Vector3d(1.234, 567, -890.125));
  CHECK(lines.read("1,234;567;-890", point) == Line::thousands);
  REQUIRE(lines.read("0,234;567;-890,1", point) == Line::point);
  REQUIRE(lines.read("1,234;567;-890", point) == Line::point);
  CHECK(point.sample.position_mm == Eigen::Vector3d(1.234, 567, -890));
}
