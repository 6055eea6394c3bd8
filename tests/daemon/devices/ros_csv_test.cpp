#include <utility>

#include "daemon/devices/maker_formats.hpp"
#include "tests/daemon/devices/read_text.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd;
using namespace sweepd::test;

TEST_CASE("messages of ROS that hold a pose are read by the names of their columns", "[ros_csv]") {
  const auto odometry = read_text(
      "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.child_frame_id,field."
      "pose.pose.position.x,field.pose.pose.position.y,field.pose.pose.position.z,field.pose.pose."
      "orientation.x,field.pose.pose.orientation.y,field.pose.pose.orientation.z,field.pose.pose."
      "orientation.w,field.pose.covariance0\n"
      "1710422553000000000,1,1710422552000000000,world,tool,1,2,3,0,0,0,1,0.1\n"
      "1710422553010000000,2,1710422552004000001,world,tool,nan,nan,nan,0,0,0,1,0.1\n"
      "1710422553020000000,3,1710422552008000001,world,tool,1,2,4,nan,nan,nan,nan,0.1\n");
  REQUIRE(odometry.points.size() == 2);
  // Doubles have no nanoseconds of these.
  CHECK(odometry.points[1].sample.time_s == Approx(0.008000001).epsilon(1e-12));
  CHECK(odometry.points[1].sample.position_mm == Eigen::Vector3d(1000, 2000, 4000));
  CHECK(odometry.points[0].sample.has_orientation);
  CHECK_FALSE(odometry.points[1].sample.has_orientation);
  const auto point = read_text(
      "%time,field.header.seq,field.header.stamp,field.point.x,field.point.y,field.point.z\n"
      "1000000000,1,0,1,2,3\n1500000000,1,0,1,2,3\n");
  CHECK(point.points.at(1).sample.time_s == 0.5);  // received: there are no stamps
  const auto bag = read_text(
      "Time,header.seq,header.stamp.secs,header.stamp.nsecs,header.frame_id,transform.translation."
      "x,"
      "transform.translation.y,transform.translation.z,transform.rotation.x,transform.rotation.y,"
      "transform.rotation.z,transform.rotation.w\n"
      "5.5,1,1710422552,999000000,w,1,2,3,0,0,0,1\n5.6,1,1710422553,1000000,w,1,2,3,0,0,0,1\n");
  CHECK(bag.points.at(1).sample.time_s == Approx(0.002).epsilon(1e-12));
}

TEST_CASE("stamps with decimals are seconds, as PlotJuggler writes them", "[ros_csv]") {
  const auto second_time = [](const std::string& first, const std::string& second) {
    return read_text("%time,field.header.stamp,field.point.x,field.point.y,field.point.z\n0," +
                     first + ",1,2,3\n0," + second + ",1,2,3\n")
        .points.at(1)
        .sample.time_s;
  };
  CHECK(second_time("1710422552.50", "1710422552.51") == Approx(0.01).epsilon(1e-4));
  CHECK(second_time("5.50", "5.51") == Approx(0.01));
  CHECK(second_time("5500000000", "5510000000") == Approx(0.01));  // since a simulation's start
}

TEST_CASE("PlotJuggler's columns stand in the order of their names", "[ros_csv]") {
  const auto file = read_text(
      "__time,/arm/pose/orientation/w,/arm/pose/orientation/x,/arm/pose/orientation/y,"
      "/arm/pose/orientation/z,/arm/pose/position/x,/arm/pose/position/y,/arm/pose/position/z\n"
      "1710422552.500000,0,1,0,0,1.5,2.5,3.5\n1710422552.510000,0,1,0,0,1.5,2.5,3.5\n");
  REQUIRE(file.points.size() == 2);
  CHECK(file.points[1].sample.time_s == Approx(0.01).epsilon(1e-4));
  CHECK(file.points[1].sample.position_mm == Eigen::Vector3d(1500, 2500, 3500));
  CHECK(identify::orientation(file.points[1].sample)
            .isApprox(Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix()));
}

TEST_CASE("what is wrong in a file of ROS is told with its place", "[ros_csv]") {
  check_text_error("%time,field.header.stamp,field.pose.position.x,field.pose.position.y\n",
                   "line 1: expected columns position.x, position.y, position.z of a pose");
  check_text_error("field.header.seq,field.point.x,field.point.y,field.point.z\n1,1,2,3\n",
                   "line 1: expected a column header.stamp or %time");
  check_text_error("10,0,w,1,2,3,0,0,0,1\n10,1000000000,w,1,2,3,0,0,0,1\n",
                   "line 2: column 2: expected nanoseconds from 0 to 999999999");
  check_text_error("10,0,w,1,2,3,0,0,0,1\n10,1,w,1,2,3,0,0,0,7\n",
                   "line 2: column 7: expected a rotation");
  check_text_error("10,5,w,1,2,3,0,0,0,1\n10,1,w,1,2,3,0,0,0,1\n",
                   "line 2: column 1: expected a time no earlier");
}

TEST_CASE("a time that no difference of 64 bits holds is refused, the least of all too",
          "[ros_csv]") {
  const std::string header = "%time,field.point.x,field.point.y,field.point.z\n";
  for (const std::string time : {"-9223372036854775808", "9223372036854775807"}) {
    check_text_error(header + time + ",1,2,3\n" + time + ",1,2,4\n",
                     "line 2: column 1 (%time): expected a measured number");
    check_text_error(header + "0,1,2,3\n" + time + ",1,2,4\n",
                     "line 3: column 1 (%time): expected a measured number");
    check_text_error("10,0,w,1,2,3,0,0,0,1\n" + time + ",1,w,1,2,3,0,0,0,1\n",
                     "line 2: column 1: expected whole seconds");
  }
}

TEST_CASE("whole stamps are of the unit that their size and their rate tell", "[ros_csv]") {
  const auto times = [](long long first, long long step, int lines = 5) {
    std::string text = "%time,field.header.stamp,field.point.x,field.point.y,field.point.z\n";
    for (int i = 0; i < lines; ++i) text += "0," + std::to_string(first + i * step) + ",1,2,3\n";
    return read_text(text).points.at(1).sample.time_s;
  };
  CHECK(times(1'710'422'552'500, 10) == Approx(0.01));          // ms since 1970
  CHECK(times(1'710'422'552'500'000, 10'000) == Approx(0.01));  // us
  CHECK(times(1'710'422'552'500'000'000, 10'000'000) == Approx(0.01));
  CHECK(times(1'710'422'552'500'000'000, 2'000'000'000) == Approx(2));
  CHECK(times(1'710'422'552'500, 10'000'000) == Approx(0.01));  // ns, 28 minutes from a start
  CHECK(times(5'500, 10) == Approx(0.01));                      // ms, 5.5 s from a start
  CHECK(times(5'500'000, 10'000) == Approx(0.01));
  CHECK(times(5'500'000'000, 2'000'000'000) == Approx(2));
  CHECK(times(1'710'422'552'500, 10, 1000) == Approx(0.01));
  for (const auto& [first, step] : {std::pair{1'710'422'552'500LL, 2'000LL},           // ms, or us
                                    std::pair{1'710'422'552'500'000LL, 2'000'000LL}})  // us, or ns
    CHECK_THROWS_WITH(times(first, step),
                      ContainsSubstring("line 2: column 2: expected stamps that tell their unit") &&
                          ContainsSubstring("give nanoseconds, or seconds with decimals"));
  std::string seconds = "%time,field.point.x,field.point.y,field.point.z\n";
  for (int i = 0; i < 300; ++i) seconds += std::to_string(1'710'422'552 + i / 100) + ",1,2,3\n";
  check_text_error(seconds, "line 2: column 1: expected stamps that tell their unit");
}

TEST_CASE("transforms of ROS 2 are read as its poses are, by the child's frame", "[ros_csv]") {
  const std::string text =
      "1710422552,999000000,world,tool,1,2,3,0,0,0,1\n"
      "1710422553,1000000,world,tool,1,2,4,1,0,0,0\n"
      "1710422553,2000000,world,ball,5,6,7,0,0,0,1\n";
  const TemporaryFolder folder;
  PointsReader reader({}, 6);
  const auto file = reader.read(folder.write("take.csv", text), {});
  REQUIRE(file.points.size() == 3);
  CHECK_THAT(file.format, ContainsSubstring("ROS"));
  CHECK(file.points[1].sample.time_s == Approx(0.002).epsilon(1e-6));
  CHECK(file.points[1].sample.position_mm == Eigen::Vector3d(1000, 2000, 4000));
  CHECK(identify::orientation(file.points[1].sample)
            .isApprox(Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix()));
  CHECK(reader.targets() == std::vector<std::string>{"tool", "ball"});
}
