#include "daemon/devices/maker_formats.hpp"
#include "tests/daemon/devices/read_text.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd;
using namespace sweepd::test;

TEST_CASE("ToolBox without times has sixty frames a second, and says so", "[ndi_csv]") {
  const auto file = read_text(
      "Tools,Port 1,Frame,Face,State,Q0,Qx,Qy,Qz,Tx,Ty,Tz,Error,Port 2: "
      "b,Frame,Face,State,Q0,Qx,Qy,"
      "Qz,Tx,Ty,Tz,Error\n"
      "2,Port 1,600,1,OK,1,0,0,0,1.5,2.5,3.5,0.1,Port 2: b,600,1,Missing,,,,,,,,\n"
      "2,Port 1,603,1,Off Angle,-3.697314E28,-3.697314E28,-3.697314E28,-3.697314E28,-3.697314E28,"
      "-3.697314E28,-3.697314E28,0.1,Port 2: b,603,1,OK,0,1,0,0,4.5,5.5,6.5,0.1\n");
  REQUIRE(file.points.size() == 2);
  CHECK(file.points[0].sample.position_mm == Eigen::Vector3d(1.5, 2.5, 3.5));
  CHECK(identify::orientation(file.points[0].sample).isIdentity());
  CHECK(file.points[1].target == 1);
  CHECK(file.points[1].sample.time_s == Approx(0.05));
  CHECK(identify::orientation(file.points[1].sample)
            .isApprox(Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix()));
  CHECK_THAT(notes_of(file), ContainsSubstring("60 frames a second assumed"));
}

TEST_CASE("ToolBox' times are of the unit that their name tells, or else their size", "[ndi_csv]") {
  const auto second_time = [](const std::string& name, const std::string& first,
                              const std::string& second) {
    return read_text("Tools,Port 1: a," + name + ",State,Tx,Ty,Tz\n1,Port 1: a," + first +
                     ",OK,1,2,3\n1,Port 1: a," + second + ",OK,1,2,3\n")
        .points.at(1)
        .sample.time_s;
  };
  CHECK(second_time("Time [sec]", "5.00", "5.01") == Approx(0.01));
  CHECK(second_time("Time [ms]", "5000", "5010") == Approx(0.01));
  CHECK(second_time("Time", "1710422553000", "1710422553010") == Approx(0.01));
  CHECK(second_time("Time", "1710422553.00", "1710422553.01") == Approx(0.01));
  check_text_error("Tools,Port 1: a,Time [h],State,Tx,Ty,Tz\n1,Port 1: a,7,OK,1,2,3\n",
                   "line 1: expected one unit of time, s or ms, in column 3, found \"Time [h]\"");
}

TEST_CASE("what is wrong in a file of NDI is told with its place", "[ndi_csv]") {
  check_text_error("Tools,Port 1: a\n", "line 1: expected columns Frame of each tool");
  check_text_error("Tools,Port 1: a,Frame,State,Q0\n",
                   "line 1: expected columns X, Y and Z of \"a\"");
  check_text_error("Tools,Port 1: a,Frame,State,Tx,Ty,Tz\n1,Port 1: a,7,OK,1,2,x\n",
                   "line 2: column 7 (a Tz): expected a number, found \"x\"");
  const std::string head = "Number of frames: 2\nFrequency: 50\nUnits: mm\n\n";
  check_text_error(head, "expected a row that begins with Frame");
  check_text_error(
      "Number of frames: 2\nFrequency: 50\n\nFrame\ta x\ta y\ta z\n",
      "expected Units: mm, or another unit of length, above the columns, found nothing");
  check_text_error("Number of frames: 2\nUnits: mm\n\nFrame\ta x\ta y\ta z\n",
                   "expected Frequency in Hz above the columns, found nothing");
  check_text_error(head + "Frame\ta x\ta y\ta z\ta x\ta y\ta z\n",
                   "line 5: expected each target once");
  check_text_error(head + "Frame\ta x\ta y\ta z\n1\t\t\t\n2\t\t\t\n",
                   "line 5: expected measured positions below this line, found none in 2 lines");
}
