#include <utility>

#include "daemon/devices/maker_formats.hpp"
#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/devices/read_text.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd;
using namespace sweepd::test;

namespace {

std::string motive_head(const std::string& unit, const std::string& more = "") {
  return "Format Version,1.23,Take Name,t,Export Frame Rate,100.000000" + more + ",Length Units," +
         unit + "\n\n";
}

}  // namespace

TEST_CASE("Motive's units are millimetres, centimetres, metres, inches or feet", "[motive_csv]") {
  for (const auto& [unit, mm] :
       {std::pair("Millimeters", 1.0), std::pair("Centimeters", 10.0), std::pair("Meters", 1000.0),
        std::pair("Inches", 25.4), std::pair("Feet", 304.8)}) {
    const auto file = read_text(motive_head(unit) +
                                ",,Marker,Marker,Marker\n,,a,a,a\n,,1,1,1\n,,Position,Position,"
                                "Position\nFrame,Time (Seconds),X,Y,Z\n0,0.0,1.0,2.0,3.0\n");
    CHECK((file.points.at(0).sample.position_mm - mm * Eigen::Vector3d(1, 2, 3)).norm() < 1e-9);
  }
}

TEST_CASE("Motive 3 has a column of what the rows are, parents and a time code", "[motive_csv]") {
  const auto file = read_text(
      "Format Version,1.25,Take Name,t,Export Frame Rate,120,Length Units,Millimeters,Coordinate "
      "Space,Global\n\n,Type,,Marker,Marker,Marker\n,Name,,\"a, left\",\"a, left\",\"a, left\"\n"
      ",ID,,\"4C\",\"4C\",\"4C\"\n,Parent,,x,x,x\n,,,Position,Position,Position\n"
      "Frame,Time (Seconds),TimeCode,X,Y,Z\n0,0.000000,15:26:46:12.02,1.0,2.0,3.0\n"
      "1,0.008333,15:26:46:12.03,1.5,2.0,3.0\n");
  REQUIRE(file.points.size() == 2);
  CHECK(file.points[1].sample.time_s == Approx(0.008333));
  CHECK(file.points[1].sample.position_mm.x() == 1.5);
}

TEST_CASE("Motive's Euler angles turn about the body's own axes, in the order that is named",
          "[motive_csv]") {
  const auto file = read_text(
      motive_head("Meters", ",Rotation Type,YZX") +
      ",,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n,,b,b,b,b,b,b\n"
      ",,1,1,1,1,1,1\n,,Rotation,Rotation,Rotation,Position,Position,Position\n"
      "Frame,Time (Seconds),Y,Z,X,X,Y,Z\n0,0.0,10.0,20.0,30.0,0.1,0.2,0.3\n");
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  const Eigen::Matrix3d turned =
      (AngleAxisd(radians(10), Vector3d::UnitY()) * AngleAxisd(radians(20), Vector3d::UnitZ()) *
       AngleAxisd(radians(30), Vector3d::UnitX()))
          .toRotationMatrix();
  REQUIRE(file.points.at(0).sample.has_orientation);
  CHECK((identify::orientation(file.points[0].sample) - turned).norm() < 1e-12);
}

TEST_CASE("a body with three of its markers gives way to them, and one with fewer does not",
          "[motive_csv]") {
  const auto text = [](int markers) {
    std::string type = ",", name = ",", id = ",", kind = ",", axes = "Frame,Time (Seconds)",
                line = "0,0.0";
    const auto add = [&](const std::string& what, const std::string& called) {
      for (const char axis : {'X', 'Y', 'Z'}) {
        type += "," + what;
        name += "," + called;
        id += ",1";
        kind += ",Position";
        axes += std::string(",") + axis;
        line += ",1.0";
      }
    };
    add("Rigid Body", "Tool");
    add("Rigid Body Marker", "Tool:Marker1");
    for (int k = 1; k <= markers; ++k) add("Marker", "Tool:Marker" + std::to_string(k));
    add("Marker", "Unlabeled 7");
    return motive_head("Meters") + type + "\n" + name + "\n" + id + "\n" + kind + "\n" + axes +
           "\n" + line + "\n";
  };
  const auto three = read_text(text(3));
  CHECK(three.points.size() == 3);
  CHECK_THAT(notes_of(three),
             ContainsSubstring("left out: Tool (its pose is made of its markers)") &&
                 ContainsSubstring("each Rigid Body Marker") &&
                 ContainsSubstring("markers without a label"));
  const auto two = read_text(text(2));
  CHECK(two.points.size() == 1);
  CHECK_THAT(notes_of(two), ContainsSubstring("left out: Tool:Marker1, Tool:Marker2 (the pose of "
                                              "its body is made of it)"));
}

TEST_CASE("a marker that was never seen is left out, and said to be", "[motive_csv]") {
  const auto file =
      read_text(motive_head("Meters") +
                ",,Marker,Marker,Marker,Marker,Marker,Marker\n,,a,a,a,b,b,b\n,,1,1,1,2,2,2\n"
                ",,Position,Position,Position,Position,Position,Position\n"
                "Frame,Time (Seconds),X,Y,Z,X,Y,Z\n0,0.0,,,,1,2,3\n1,0.1,,,,1,2,3\n");
  CHECK(file.points.size() == 2);
  CHECK_THAT(notes_of(file), ContainsSubstring("left out: \"a\" (it was never seen)"));
}

TEST_CASE("Motive tells how many frames it has exported", "[motive_csv]") {
  const std::string rows =
      ",,Marker,Marker,Marker\n,,a,a,a\n,,1,1,1\n,,Position,Position,Position\n"
      "Frame,Time (Seconds),X,Y,Z\n0,0.0,1,2,3\n1,0.1,1,2,3\n";
  CHECK_THAT(notes_of(read_text(motive_head("Meters", ",Total Exported Frames,3") + rows)),
             ContainsSubstring("2 of the 3 frames that it tells of"));
  CHECK(notes_of(read_text(motive_head("Meters", ",Total Exported Frames,2") + rows)).empty());
}

TEST_CASE("what is wrong in a file of Motive is told with its place", "[motive_csv]") {
  const std::string rows =
      ",,Marker,Marker,Marker\n,,a,a,a\n,,1,1,1\n,,Position,Position,Position\n";
  const std::string axes = "Frame,Time (Seconds),X,Y,Z\n";
  check_text_error(motive_head("Furlongs") + rows + axes,
                   "line 1: expected Length Units, in millimeters or another unit of length, found "
                   "\"Furlongs\"");
  check_text_error("Format Version,1.23,Take Name,t\n\n" + rows + axes,
                   "line 1: expected Length Units");
  check_text_error(motive_head("Meters", ",Coordinate Space,Local") + rows + axes,
                   "line 1: expected Coordinate Space Global, found \"Local\"");
  check_text_error(motive_head("Meters") + rows, "expected rows of type, name, ID and axis");
  check_text_error(motive_head("Meters") + rows + axes,
                   "line 7: expected measured positions below this line, found none in 0 lines");
  check_text_error(motive_head("Meters") + rows + axes + "0,0.0,,,\n",
                   "line 7: expected measured positions below this line, found none in 1 line");
  check_text_error(motive_head("Meters") + rows + axes + "0,0.0,1,2\n",
                   "line 8: expected 5 columns, as line 7 tells, found 4");
  check_text_error(motive_head("Meters") + rows + axes + "0,0.0,1,abc,3\n",
                   "line 8: column 4 (a Y): expected a number, found \"abc\"");
  check_text_error(motive_head("Meters") + rows + axes + "0,0.0,1,2e12,3\n",
                   "line 8: column 4 (a Y): expected a measured number, found \"2e12\"");
  check_text_error(motive_head("Meters") + rows + axes + "0,,1,2,3\n",
                   "line 8: column 2 (Time (Seconds)): expected a time, found nothing");
  check_text_error(motive_head("Meters") + rows + axes + "0,0.5,1,2,3\n1,0.4,1,2,3\n",
                   "line 9: column 2 (Time (Seconds)): expected a time no earlier");
  check_text_error(motive_head("Meters") +
                       ",,Marker,Marker,Marker,Marker,Marker,Marker\n,,a,a,a,a,a,a\n,,1,1,1,2,2,2\n"
                       ",,Position,Position,Position,Position,Position,Position\n"
                       "Frame,Time (Seconds),X,Y,Z,X,Y,Z\n",
                   "line 7: expected each target once, found \"a\" a second time");
  check_text_error(motive_head("Meters") +
                       ",,Marker,Marker\n,,a,a\n,,1,1\n,,Position,Position\n"
                       "Frame,Time (Seconds),X,Y\n",
                   "line 7: expected columns X, Y and Z of \"a\"");
}
