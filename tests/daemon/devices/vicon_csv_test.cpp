#include "daemon/devices/maker_formats.hpp"
#include "tests/daemon/devices/read_text.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd;
using namespace sweepd::test;

TEST_CASE("Nexus' frames are times by the rate, and blanks at the end may be missing",
          "[vicon_csv]") {
  const auto file = read_text(
      "Trajectories;;;;;\n200\n;;a;;;b;;\nFrame;Sub Frame;X;Y;Z;X;Y;Z\n;;mm;mm;mm;mm;mm;mm\n"
      "11;0;-391.888;-6180.01;1734.43;-378.647;-6190.14;1713.82\n12;0;-391.9;-6180;1734.4\n"
      "13;0;;;;-378.7;-6190;1713.8\n\n");
  REQUIRE(file.points.size() == 4);
  CHECK(file.points[0].sample.time_s == 0);
  CHECK(file.points[2].sample.time_s == Approx(0.005));
  CHECK(file.points[3].sample.time_s == Approx(0.01));
  CHECK(file.points[3].target == 1);
  CHECK(file.points[3].sample.position_mm == Eigen::Vector3d(-378.7, -6190, 1713.8));
}

TEST_CASE("angles that may be Euler's or helical are left out, and so is what has no name",
          "[vicon_csv]") {
  const auto file = read_text(
      "Objects\n100\n,,Tool,,,,,\nFrame,Sub Frame,RX,RY,RZ,TX,TY,TZ\n,,deg,deg,deg,mm,mm,mm\n"
      "1,0,10,20,30,1,2,3\n");
  CHECK_FALSE(file.points.at(0).sample.has_orientation);
  CHECK(file.points[0].sample.position_mm == Eigen::Vector3d(1, 2, 3));
  CHECK_THAT(notes_of(file), ContainsSubstring("RX, RY, RZ (Euler angles or helical"));
  const auto markers = read_text(
      "Trajectories\n100\n,,*12,,,a,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,m,m,m,m,m,m\n"
      "1,0,9,9,9,1,2,3\n\nObjects\n100\n");
  REQUIRE(markers.points.size() == 1);
  CHECK(markers.points[0].sample.position_mm == Eigen::Vector3d(1000, 2000, 3000));
  CHECK_THAT(notes_of(markers), ContainsSubstring("markers without a name") &&
                                    ContainsSubstring("the section Objects"));
}

TEST_CASE("an object at zero was not seen", "[vicon_csv]") {
  const auto file = read_text(
      "Objects\n100\n,,Tool,,,,,,\nFrame,Sub Frame,RX,RY,RZ,RW,TX,TY,TZ\n,,,,,,mm,mm,mm\n"
      "1,0,0,0,0,0,0,0,0\n2,0,0,0,0,1,1.5,2.5,3.5\n3,0,0,0,0,0,1.5,2.5,3.5\n");
  REQUIRE(file.points.size() == 2);
  CHECK(file.points[0].sample.has_orientation);
  CHECK_FALSE(file.points[1].sample.has_orientation);
}

TEST_CASE("what is wrong in a file of Vicon is told with its place", "[vicon_csv]") {
  check_text_error("Devices\n1000\n,,a,\nFrame,Sub Frame,Fx,Fy\n,,N,N\n1,0,1,2\n",
                   "expected a section Trajectories, Objects or Segments, found none");
  check_text_error("Trajectories\n100\n,,a,,\n",
                   "line 1: expected a rate, names and a row that begins with Frame");
  check_text_error("Trajectories\nfast\n,,a,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n1,0,1,2,3\n",
                   "line 2: expected the rate in Hz, found \"fast\"");
  check_text_error("Trajectories\n100\n,,a,,\nFrame,Sub Frame,X,Y,Z\n,,N,N,N\n1,0,1,2,3\n",
                   "line 5: expected one unit of length, mm, in column 3, found \"N\"");
  check_text_error(
      "Trajectories\n100\n,,a,,,a,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n",
      "line 3: expected each target once, found \"a\" a second time");
  check_text_error("Trajectories\n100\n,,a,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n1,0,1,2,3,4\n",
                   "line 6: expected 5 columns, as line 4 tells, found 6");
  check_text_error(
      "Trajectories\n100\n,,a,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n1,0,1,2,3\n1,1,1,2,3\n",
      "line 7: expected Sub Frame 0, found \"1\"");
}
