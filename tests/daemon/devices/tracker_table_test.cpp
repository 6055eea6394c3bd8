#include "daemon/devices/device_rows.hpp"
#include "daemon/devices/device_words.hpp"
#include "daemon/devices/maker_formats.hpp"
#include "tests/daemon/devices/read_text.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd;
using namespace sweepd::test;

TEST_CASE("the name of a column tells value and unit", "[column_name]") {
  const auto check = [](const char* text, const std::string& value, const std::string& unit) {
    INFO(text);
    CHECK(column_name(text).value == value);
    CHECK(column_name(text).unit == unit);
  };
  check("X", "x", "");
  check(" Y (mm) ", "y", "mm");
  check("Measured Z [Inch]", "z", "inch");
  check("Pos_X_mm", "x", "mm");
  check("Z-Coordinate", "z", "");
  check("Q0", "rw", "");
  check("Quaternion X", "rx", "");
  check("Time Stamp (ms)", "time", "ms");
  check("UTC timestamp", "time", "");
  check("Point Name", "name", "");
  check("Group", "group", "");
  check("Nominal X", "", "");
  check("dx", "", "");
  check("Temperature (C)", "", "c");
  check("", "", "");
}

TEST_CASE("the name of a group may tell a joint", "[tracker_table]") {
  CHECK(joint_in("Joint 3") == 3);
  CHECK(joint_in("A1") == 1);
  CHECK(joint_in("axis_12") == 12);
  CHECK(joint_in("j-6") == 6);
  for (const char* name : {"", "3", "Joint", "Joint 0", "Joint 13", "Scan 3", "A1b", "AA1"})
    CHECK(joint_in(name) == 0);
}

TEST_CASE("points in groups that are named as joints are that joint's", "[tracker_table]") {
  const auto file = read_text(
      "// Working frame: A::WORLD\nSMR1 Joint1 p1 1.500 2.500 3.500\nSMR1 Joint1 p2 1.600 2.500 "
      "3.500\nSMR1 Joint2 p1 1.700 2.500 3.500\n");
  CHECK(file.format == "SpatialAnalyzer text");
  CHECK(file.with_joints);
  CHECK_FALSE(file.with_times);
  REQUIRE(file.points.size() == 3);
  CHECK(file.points[1].joint == 1);
  CHECK(file.points[2].joint == 2);
  CHECK(file.points[2].target == 0);
  CHECK_THAT(notes_of(file), ContainsSubstring("millimetres assumed"));
}

TEST_CASE("SpatialAnalyzer's lists without a header are known by their commas", "[tracker_table]") {
  const auto file = read_text(
      "1,  1975.568420,  -310.198889,  -257.870805\n3,  2508.005925,  -556.994450,  -244.542473\n");
  CHECK(file.format == "SpatialAnalyzer text");
  REQUIRE(file.points.size() == 2);
  CHECK(file.points[1].target == 0);
  CHECK(file.points[1].sample.position_mm == Eigen::Vector3d(2508.005925, -556.99445, -244.542473));
}

TEST_CASE("dates count where points are dense, and with AM and PM", "[tracker_table]") {
  const std::string head = "// SpatialAnalyzer\n// Units: mm\n";
  const auto stream = read_text(head +
                                "p1 1.5 2.5 3.5 3/14/2024 11:59:59.990 AM\n"
                                "p2 1.5 2.5 3.5 3/14/2024 12:00:00.000 PM\n"
                                "p3 1.5 2.5 3.5 3/14/2024 12:00:00.010 PM\n");
  CHECK(stream.with_times);
  CHECK(stream.points.at(2).sample.time_s == Approx(0.02).margin(1e-6));
  const auto list = read_text(head +
                              "p1 1.5 2.5 3.5 3/14/2024 1:00:00 PM\n"
                              "p2 1.5 2.5 3.5 3/14/2024 1:00:05 PM\n"
                              "p3 1.5 2.5 3.5 3/14/2024 1:00:05 PM\n");
  CHECK_FALSE(list.with_times);
  CHECK(list.points.at(2).sample.time_s == 2);
  CHECK_THAT(notes_of(list), ContainsSubstring("too far apart for a stream"));
}

TEST_CASE("reflectors and groups are targets, and names that come again and again",
          "[tracker_table]") {
  const auto reflectors =
      read_text("FARO\nName,Reflector,X (mm),Y (mm),Z (mm)\np1,a,1,2,3\np2,b,1,2,3\np3,a,1,2,3\n");
  CHECK(reflectors.points.at(1).target == 1);
  CHECK(reflectors.points.at(2).target == 0);
  std::string text = "FARO\nName,X (mm),Y (mm),Z (mm)\n";
  for (int k = 0; k < 5; ++k) text += "a,1,2,3\nb,1,2,3\n";
  CHECK(read_text(text).points.at(3).target == 1);
}

TEST_CASE("units stand with X, below the names or above the table", "[tracker_table]") {
  for (const std::string text :
       {"FARO\nX (in),Y (in),Z (in)\n1,2,3\n2,2,3\n", "CAM2\nX,Y,Z\n[inch],[inch],[inch]\n1,2,3\n",
        "FARO\nLength units: Inches\nX,Y,Z\n1,2,3\n", "FARO\nUnits in inch\nX,Y,Z\n1,2,3\n"}) {
    INFO(text);
    const auto file = read_text(text);
    CHECK(file.points.at(0).sample.position_mm.isApprox(25.4 * Eigen::Vector3d(1, 2, 3)));
    CHECK(notes_of(file).empty());
  }
}

TEST_CASE("micrometres are no metres, and the word in is no inch", "[tracker_table]") {
  const auto first_mm = [](const std::string& above) {
    return read_text("FARO\n" + above + "\nX,Y,Z\n1,2,3\n").points.at(0).sample.position_mm.x();
  };
  CHECK(first_mm("Units: \xc2\xb5m") == Approx(0.001));
  CHECK(first_mm("Units: \xb5m") == Approx(0.001));  // Latin-1
  CHECK(first_mm("Units: Micrometers") == Approx(0.001));
  CHECK(first_mm("Length unit: mils") == Approx(0.0254));
  CHECK(first_mm("Temperature unit: C; pressure in hPa") == 1);
  CHECK(first_mm("Units in world frame") == 1);
  CHECK(first_mm("Units: in deg") == 25.4);
  CHECK(first_mm("Units [in]; Angles [deg]") == 25.4);
  CHECK(first_mm("Units in") == 25.4);
  CHECK(read_text("X [\xc2\xb5m],Y [\xc2\xb5m],Z [\xc2\xb5m]\n1,2,3\n")
            .points.at(0)
            .sample.position_mm.x() == Approx(0.001));
}

TEST_CASE("what stands behind a unit in brackets is of the name", "[tracker_table]") {
  const auto file = read_text(
      "X [mm] nominal,Y [mm] nominal,Z [mm] nominal,X [mm] actual,Y [mm] actual,Z [mm] actual\n"
      "1,2,3,4,5,6\n");
  CHECK(file.points.at(0).sample.position_mm == Eigen::Vector3d(4, 5, 6));
  CHECK_THROWS_AS(read_text("Name,X [mm] dev,Y [mm] dev,Z [mm] dev\na,1,2,3\n"), CsvError);
}

TEST_CASE("each column of times has its own unit", "[tracker_table]") {
  const auto second_time = [](const std::string& names) {
    return read_text("Leica\n" + names + "\n5000,1,2,3,5\n5010,1,2,3,5.01\n")
        .points.at(1)
        .sample.time_s;
  };
  CHECK(second_time("Time [ms],X,Y,Z,Elapsed time [s]") == Approx(0.01));
  CHECK(second_time("Timestamp,X,Y,Z,Timestamp [s]") == 1);  // a list: 10 s apart
  CHECK(second_time("Time [min],X,Y,Z,Elapsed time [s]") == Approx(0.01));
  CHECK_THAT(notes_of(read_text("Leica\nTime [min],X,Y,Z\n5,1,2,3\n5.1,1,2,3\n")),
             ContainsSubstring("left out: times, as \"min\" is no known unit of time"));
}

TEST_CASE("points behind a # are counted", "[tracker_table]") {
  const auto file =
      read_text("# by hand\nName,X [mm],Y [mm],Z [mm]\na,1,2,3\n#b,1,2,3\n\nc,1,2,3\n");
  CHECK(file.points.size() == 2);
  CHECK_THAT(notes_of(file), ContainsSubstring("left out: 1 line among the points, for the #"));
}

TEST_CASE("numbers of times are seconds, unless a unit or their size tells", "[tracker_table]") {
  const auto second_time = [](const std::string& name, const std::string& first,
                              const std::string& second) {
    return read_text("Leica\n" + name + ",X,Y,Z\n" + first + ",1,2,3\n" + second + ",1,2,3\n")
        .points.at(1)
        .sample.time_s;
  };
  CHECK(second_time("Time", "5.00", "5.01") == Approx(0.01));
  CHECK(second_time("Time (ms)", "5000", "5010") == Approx(0.01));
  CHECK(second_time("Timestamp [us]", "5000000", "5010000") == Approx(0.01));
  CHECK(second_time("Timestamp", "1710422553000", "1710422553010") == Approx(0.01));
  CHECK(second_time("Timestamp", "1710422553000000000", "1710422553010000000") == Approx(0.01));
}

TEST_CASE("date and time of day may come in any order, and beside other times", "[tracker_table]") {
  for (const std::string text :
       {"FARO\nTime,Date,X,Y,Z\n13:22:33.00,3/14/2024,1,2,3\n13:22:33.01,3/14/2024,1,2,3\n",
        "FARO\nTime,Timestamp,X,Y,Z\n7,13:22:33.00,1,2,3\n7,13:22:33.01,1,2,3\n",
        "FARO\nTime;Timestamp;X;Y;Z\nlate;5,00;1;2;3\nlater;5,01;1;2;3\n"}) {
    INFO(text);
    CHECK(read_text(text).points.at(1).sample.time_s == Approx(0.01));
  }
  const auto none = read_text("FARO\nTime,X,Y,Z\nlate,1,2,3\nlater,1,2,3\n");
  CHECK_FALSE(none.with_times);
  CHECK_THAT(notes_of(none), ContainsSubstring("left out: times, as \"late"));
}

TEST_CASE("what is wrong in a tracker's table is told with its place", "[tracker_table]") {
  check_text_error("FARO\nName,X (mm),Y (mm),Z (mm)\n",
                   "line 2: expected points below the names of the columns");
  check_text_error("FARO\nName,X (mm),Y (m),Z (mm)\n1,1,2,3\n",
                   "line 2: expected one unit for X, Y and Z, found \"mm\" and \"m\"");
  check_text_error("FARO\nX,Y,Z\n(mm),(mm),(in)\n1,2,3\n",
                   "line 3: expected one unit for X, Y and Z, found \"mm\" and \"in\"");
  check_text_error("FARO\nX,Y,Z,Measured X\n1,2,3,4\n",
                   "line 2: expected x once, found it a second time");
  check_text_error("FARO\nX (deg),Y (deg),Z (deg)\n1,2,3\n",
                   "line 2: expected a unit of length with X, Y and Z, found \"deg\"");
  check_text_error("FARO\nX,Y,Z\n1.5,2,3\n1;2;3\n",
                   "line 4: expected 3 columns, as line 2 tells, found 1");
  check_text_error("FARO\nX;Y;Z\n1.5;2;3\n1,5;2;3\n",
                   "line 4: column 1 (X): expected a decimal point, as in line 3, found \"1,5\"");
  check_text_error("FARO\nX;Y;Z\n1,500.5;2;3\n",
                   "line 3: column 1 (X): expected a number, found \"1,500.5\"");
  check_text_error("FARO\nDate,Time,X,Y,Z\n3/14/2024,13:22:33,1,2,3\n3/14/2024,13:62:33,1,2,3\n",
                   "line 4: column 1 (Date): expected a date and a time of day");
  check_text_error("// SA\nA Joint1 p1 1.5 2.5 3.5\nA Joint7 p1 1.5 2.5 3.5\n",
                   "line 3: column 2: expected the name of a joint from 1 to 6, found "
                   "\"Joint7\"");
  check_text_error("FARO\nX (mm),Y (mm),Z (mm)\n1,-1e25,3\n",
                   "line 3: column 2 (Y (mm)): expected a measured number, found \"-1e25\"");
  check_text_error("// SA\nA Joint1 p1 1.5 2.5 3.5\nA Base p1 1.5 2.5\n",
                   "line 3: expected 6 columns, as line 2 tells, found 5");
}

TEST_CASE("what may be thousands or decimals is refused, unless a position tells which",
          "[tracker_table]") {
  const auto xs = [](const std::string& lines) {
    std::vector<double> found;
    for (const auto& point : read_text("Name;X [mm];Y [mm];Z [mm]\n" + lines).points)
      found.push_back(point.sample.position_mm.x());
    return found;
  };
  for (const std::string text : {"a;1,234;567;1,012\n", "a;0;567;0\na;1,234;1,567;1,012\n",
                                 "a;1.234;567;1.012\n", "a;12,345;-7;1,012\na;12,346;-7;1,012\n"}) {
    INFO(text);
    CHECK_THROWS_WITH(xs(text), ContainsSubstring("which may be either") &&
                                    ContainsSubstring("nothing between thousands"));
  }
  // All have three decimals, or one shows that they are decimals.
  CHECK(xs("a;1,234;5,670;1,012\n") == std::vector{1.234});
  CHECK(xs("a;1,234;0;1,012\n") == std::vector{1.234});
  CHECK(xs("a;1,234;567;1,012\na;1,23;567;1,012\n") == std::vector{1.234, 1.23});
  CHECK(xs("a;1,234;567;0,012\n") == std::vector{1.234});
  CHECK(xs("a;1234,567;567;1,012\n") == std::vector{1234.567});
}

TEST_CASE("both signs in one number, and other signs between thousands, are told",
          "[tracker_table]") {
  const std::string header = "Name,X [mm],Y [mm],Z [mm]\n";
  for (const std::string wrong :
       {"\"1,234.5\"", "\"1,234,567\"", "1.234.567", "1'234.5", "1 234.5"})
    check_text_error(header + "a," + wrong + ",2,3\n",
                     "line 2: column 2 (X [mm]): expected a number");
  for (const std::string wrong : {"\"1,234.5\"", "1'234.5", "1 234.5"}) {
    INFO(wrong);
    CHECK_THROWS_WITH(read_text(header + "a," + wrong + ",2,3\n"),
                      ContainsSubstring("nothing between thousands"));
  }
}
