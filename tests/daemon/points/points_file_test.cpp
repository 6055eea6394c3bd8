#include "daemon/points/points_file.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <Eigen/Geometry>

#include "daemon/points/csv_file.hpp"
#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::CsvError;
using sweepd::PointsFile;
using sweepd::PointsReader;
using sweepd::radians;
using namespace sweepd::test;

namespace {

PointsFile read(const TemporaryFolder& folder, const std::string& text,
                std::vector<std::string> columns = {}) {
  return PointsReader(std::move(columns), 12).read(folder.write("points.csv", text), {});
}

void check_points_error(const std::string& text, const std::string& said) {
  const TemporaryFolder folder;
  INFO(text);
  CHECK_THROWS_AS(read(folder, text), CsvError);
  CHECK_THROWS_WITH(read(folder, text), ContainsSubstring("points.csv: " + said));
}

Eigen::Matrix3d rotation(const std::array<double, 3>& abc) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(abc[0], Vector3d::UnitZ()) * AngleAxisd(abc[1], Vector3d::UnitY()) *
          AngleAxisd(abc[2], Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace

TEST_CASE("names of Latin-1 are read, and told, as what they are", "[points_file]") {
  const TemporaryFolder folder;
  PointsReader reader({}, 12);
  static_cast<void>(reader.read(
      folder.write("points.csv", "target,t_s,x_mm,y_mm,z_mm\nKugel gr\xfcn,1,2,3,4\n"), {}));
  CHECK(reader.targets() == std::vector<std::string>{"Kugel gr\xc3\xbcn"});
  check_points_error(
      "t_s,x_mm,y_mm,z_mm,temp_\xb0"
      "c\n",
      "line 1, column 5 (temp_\xc2\xb0"
      "c): ");
}

TEST_CASE("columns come in any order, lengths in mm or m, angles in deg or rad", "[points_file]") {
  const TemporaryFolder folder;
  const auto file = read(folder,
                         "z_mm,a2_rad,t_s,y_m,joint,x_mm,a1_deg,sweep,target\n"
                         "3,0.5,7.25,-0.002,12,1,90,4,ball\n");
  CHECK(file.with_joints);
  CHECK(file.with_times);
  CHECK(file.angles == 2);
  REQUIRE(file.points.size() == 1);
  const auto& point = file.points.front();
  CHECK(point.joint == 12);
  CHECK(point.sweep == 4);
  CHECK(point.target == 0);
  CHECK(point.sample.time_s == 7.25);
  CHECK(point.sample.has_position);
  CHECK((point.sample.position_mm - Eigen::Vector3d(1, -2, 3)).norm() < 1e-12);
  CHECK(point.sample.joints == 2);
  CHECK(point.sample.angles_rad[0] == Approx(radians(90)));
  CHECK(point.sample.angles_rad[1] == 0.5);
  CHECK_FALSE(point.sample.has_orientation);
}

TEST_CASE("a linear joint has its place in mm or m, or in a column of degrees", "[points_file]") {
  const TemporaryFolder folder;
  for (const auto& [columns, values] : {std::pair("a1_rad,a2_mm,a3_deg", "0.5,120,90"),
                                        std::pair("a1_rad,a2_m,a3_deg", "0.5,.12,90"),
                                        std::pair("a1_rad,a2_deg,a3_deg", "0.5,120,90")}) {
    INFO(columns);
    const auto file =
        read(folder, std::string("x_mm,y_mm,z_mm,") + columns + "\n1,2,3," + values + "\n");
    const auto& point = file.points.front();
    CHECK(point.sample.joints == 3);
    CHECK(point.sample.angles_rad[0] == 0.5);
    CHECK(point.sample.angles_rad[1] == Approx(radians(120)));
    CHECK(point.sample.angles_rad[2] == Approx(radians(90)));
    CHECK(file.is_linear(1) == (std::string(columns).find("a2_m") != std::string::npos));
    CHECK_FALSE((file.is_linear(0) || file.is_linear(2)));
  }
  PointsReader reader({}, 12);
  static_cast<void>(reader.read(folder.write("x.csv", "x_mm,y_mm,z_mm,a1_mm\n1,2,3,5.25\n"), {}));
  CHECK(reader.resolution().angle_rad == Approx(radians(0.01)));
}

TEST_CASE("a unit that a joint cannot have is refused, and told with its column", "[points_file]") {
  using sweepd::JointKind;
  const TemporaryFolder folder;
  const auto read_as = [&](const char* column, JointKind kind) {
    PointsReader reader({}, 12, {}, {JointKind::unknown, kind});
    return reader.read(folder.write("points.csv", "x_mm,y_mm,z_mm,a1_rad," + std::string(column) +
                                                      "\n1,2,3,0.5,0.25\n"),
                       {});
  };
  CHECK_THROWS_WITH(read_as("a2_rad", JointKind::linear),
                    ContainsSubstring("line 1, column 5 (a2_rad): expected mm, as joint 2 is "
                                      "linear, found radians") &&
                        ContainsSubstring("name the column a2_mm"));
  for (const char* column : {"a2_mm", "a2_m"})
    CHECK_THROWS_WITH(read_as(column, JointKind::turning),
                      ContainsSubstring("expected an angle, as joint 2 turns, found m") &&
                          ContainsSubstring("name the column a2_deg or a2_rad"));
  for (const char* column : {"a2_mm", "a2_m", "a2_deg"})
    CHECK(read_as(column, JointKind::linear).is_linear(1));
  for (const char* column : {"a2_rad", "a2_deg"})
    CHECK_FALSE(read_as(column, JointKind::turning).is_linear(1));
  CHECK(read_as("a2_rad", JointKind::unknown).angles == 2);
}

TEST_CASE("a header may be in capitals, and the file in UTF-16", "[points_file]") {
  const std::string text = "Joint,T_S,X_mm,Y_MM,Z_mm,A1_Deg\n2,7.5,1,2,3,90\n";
  std::string wide = "\xff\xfe";
  for (const char c : text) wide.append({c, '\0'});
  for (const std::string& bytes : {text, wide}) {
    const TemporaryFolder folder;
    const auto file = read(folder, bytes);
    REQUIRE(file.points.size() == 1);
    const auto& point = file.points.front();
    CHECK(point.joint == 2);
    CHECK(point.sample.time_s == 7.5);
    CHECK((point.sample.position_mm - Eigen::Vector3d(1, 2, 3)).norm() < 1e-12);
    CHECK(point.sample.angles_rad[0] == Approx(radians(90)));
  }
}

TEST_CASE("joint angles in capitals are no measuring program's", "[points_file][column_name]") {
  for (const char* header : {"A1_DEG,A2_DEG,X_MM,Y_MM,Z_MM", "a1_rad,a2_rad,X_mm,Y_mm,Z_mm"}) {
    const TemporaryFolder folder;
    const auto file = read(folder, std::string(header) + "\n0.5,1,1,2,3\n");
    CHECK(file.format.empty());
    REQUIRE(file.points.size() == 1);
    CHECK(file.points.front().sample.joints == 2);
    CHECK(file.points.front().sample.position_mm.z() == 3);
  }
}

TEST_CASE("without times the points count; without a joint there is none", "[points_file]") {
  const TemporaryFolder folder;
  const auto file = read(folder, "x_mm,y_mm,z_mm\n1,2,3\n4,5,6\n");
  CHECK_FALSE(file.with_joints);
  CHECK_FALSE(file.with_times);
  CHECK(file.points[0].joint == 0);
  CHECK(file.points[0].sample.time_s == 0);
  CHECK(file.points[1].sample.time_s == 1);
  CHECK(file.points[1].sample.joints == 0);
}

TEST_CASE("a quaternion and KUKA's A, B, C tell the same orientation", "[points_file]") {
  const TemporaryFolder folder;
  // B at +-90 degrees is where A and C turn about the same direction.
  for (const auto& abc :
       {std::array{30.0, -40.0, 110.0}, std::array{-170.0, 80.0, -5.0},
        std::array{20.0, 90.0, 50.0}, std::array{20.0, -90.0, 50.0}, std::array{0.0, 0.0, 180.0}}) {
    std::array<double, 3> radian{};
    std::string text = "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n0,0,0";
    for (std::size_t k = 0; k < 3; ++k) {
      radian[k] = radians(abc[k]);
      text += "," + std::to_string(abc[k]);
    }
    INFO(text);
    const Eigen::Quaterniond q(rotation(radian));
    const auto by_abc = read(folder, text + "\n");
    // Twice as long as a unit quaternion, and in metres.
    const auto by_quaternion =
        read(folder, "x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0," + std::to_string(2 * q.w()) + "," +
                         std::to_string(2 * q.x()) + "," + std::to_string(2 * q.y()) + "," +
                         std::to_string(2 * q.z()) + "\n");
    const auto& one = by_abc.points[0].sample;
    const auto& other = by_quaternion.points[0].sample;
    REQUIRE(one.has_orientation);
    REQUIRE(other.has_orientation);
    CHECK((rotation(one.abc_rad) - rotation(radian)).norm() < 1e-12);
    // Six decimals were printed.
    CHECK((rotation(other.abc_rad) - rotation(radian)).norm() < 5e-6);
  }
}

TEST_CASE("what is missing leaves the rest of the point as it is", "[points_file]") {
  const TemporaryFolder folder;
  const auto file = read(folder,
                         "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,a1_deg,a2_deg\n"
                         "1,,3,1,2,3,4,5\n1,2,3,,,,4,5\n1,2,3,1,2,3,,5\n");
  CHECK_FALSE(file.points[0].sample.has_position);
  CHECK(file.points[0].sample.has_orientation);
  CHECK(file.points[0].sample.joints == 2);
  CHECK_FALSE(file.points[1].sample.has_orientation);
  CHECK(file.points[1].sample.has_position);
  CHECK(file.points[2].sample.joints == 0);
}

TEST_CASE("files of sweepd itself are understood as they are", "[points_file]") {
  const TemporaryFolder folder;
  const auto samples =
      read(folder,
           "t_s,ipoc,x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg\n"
           "0.004,4004,1.0,2.0,3.0,4.0,5.0,6.0,7.0,8.0,9.0,10.0,11.0,12.0\n");
  CHECK(samples.angles == 6);
  CHECK(samples.points[0].sample.has_orientation);
  const auto sweeps =
      read(folder,
           "joint,sweep,t_s,x_mm,y_mm,z_mm,a1_deg,plane_residual_mm,radial_residual_mm\n"
           "1,2,0.004,1.0,2.0,3.0,4.0,0.001,-0.002\n");
  CHECK(sweeps.points[0].joint == 1);
  CHECK(sweeps.points[0].sweep == 2);
  CHECK(sweeps.angles == 1);
}

TEST_CASE("the columns of a file without a header are named from outside", "[points_file]") {
  const TemporaryFolder folder;
  const auto file = read(folder, "2\t-37.702407\t-100.32\t0.06\t-180\trevolute\t0\n",
                         {"joint", "x_mm", "y_mm", "z_mm", "-", "_", ""});
  CHECK(file.points[0].joint == 2);
  CHECK(file.points[0].sample.position_mm.x() == -37.702407);
}

TEST_CASE("the last decimal printed is the resolution, ten of them are full precision",
          "[points_file]") {
  const TemporaryFolder folder;
  PointsReader reader({}, 12);
  const auto resolution_with = [&](const std::string& text) {
    static_cast<void>(reader.read(folder.write("x.csv", text), {}));
    return reader.resolution();
  };
  auto found = resolution_with("x_m,y_m,z_m,a1_deg\n1,2.5,3.12,90\n");
  CHECK(found.position_mm == Approx(10));
  CHECK(found.angle_rad == 0);  // commanded
  found = resolution_with("x_mm,y_mm,z_mm,a1_deg\n1,2.5,3.1200,90.10\n");
  CHECK(found.position_mm == Approx(1e-4));
  CHECK(found.angle_rad == Approx(radians(0.01)));
  // The finest file counts.
  found = resolution_with("x_mm,y_mm,z_mm,a1_rad\n1,2.5,3,1.234567\n");
  CHECK(found.position_mm == Approx(1e-4));
  CHECK(found.angle_rad == Approx(1e-6));
  found = resolution_with("x_m,y_m,z_m\n0.24528665080062623,1,2\n");
  CHECK(found.position_mm == 0);

  PointsReader other({}, 12);
  static_cast<void>(
      other.read(folder.write("x.csv", "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n1,2,3,1.5,2,3\n"), {}));
  CHECK(other.resolution().angle_rad == Approx(radians(0.1)));
}

TEST_CASE("targets are told apart by name, across files", "[points_file]") {
  const TemporaryFolder folder;
  PointsReader reader({}, 12);
  const std::string header = "target,x_mm,y_mm,z_mm\n";
  const auto first = reader.read(folder.write("1.csv", header + "b,0,0,0\na,0,0,0\nb,0,0,0\n"), {});
  const auto second = reader.read(folder.write("2.csv", header + "a,0,0,0\n7,0,0,0\n"), {});
  CHECK(first.points[0].target == 0);
  CHECK(first.points[1].target == 1);
  CHECK(first.points[2].target == 0);
  CHECK(second.points[0].target == 1);
  CHECK(second.points[1].target == 2);
  CHECK(reader.targets() == std::vector<std::string>{"b", "a", "7"});
}

TEST_CASE("a name for each point is read in time by the size of the file", "[points_file]") {
  const TemporaryFolder folder;
  const auto took = [&](bool many_names) {
    std::string text = "target,x_mm,y_mm,z_mm\n";
    for (int i = 0; i < 20'000; ++i) text += std::to_string(many_names ? i : 0) + ",1,2,3\n";
    const auto path = folder.write("names.csv", text);
    auto best = std::chrono::nanoseconds::max();
    for (int round = 0; round < 3; ++round) {
      PointsReader reader({}, 12);
      const auto start = std::chrono::steady_clock::now();
      CHECK(reader.read(path, {}).points.size() == 20'000);
      best = std::min<std::chrono::nanoseconds>(best, std::chrono::steady_clock::now() - start);
      CHECK(reader.targets().size() == (many_names ? 20'000 : 1));
    }
    return best;
  };
  // To look through all names for each point takes some thirty times as long.
  CHECK(took(true) < 10 * took(false));
}

TEST_CASE("angles of more joints than the robot has are passed over", "[points_file]") {
  const TemporaryFolder folder;
  PointsReader reader({}, 2);
  const auto file =
      reader.read(folder.write("x.csv", "x_mm,y_mm,z_mm,a1_deg,a2_deg,a3_deg\n0,0,0,1,2,\n"), {});
  CHECK(file.angles == 2);
  CHECK(file.points[0].sample.joints == 2);
}

TEST_CASE("a header that is wrong is told with its column", "[points_file]") {
  check_points_error("x_mm,y_mm,z_mm,speed\n", "line 1, column 4 (speed): expected a known column");
  check_points_error("# points\nu_mm,y_mm,z_mm\n",
                     "line 2, column 1 (u_mm): expected a known column");
  check_points_error("x,y_mm,z_mm\n", "line 1, column 1 (x): expected a known column");
  check_points_error("x_mm,y_mm,z_mm,a13_deg\n",
                     "line 1, column 4 (a13_deg): expected a known column");
  check_points_error("x_mm,y_mm,z_mm,a_mm\n", "line 1, column 4 (a_mm): expected a known column");
  check_points_error("x_mm,y_mm,z_mm,x_m\n",
                     "line 1, column 4 (x_m): expected each value once, found x a second time");
  check_points_error("x_mm,z_mm\n",
                     "line 1: expected a column for each of 3 values that belong together, "
                     "found none for y");
  check_points_error("t_s,a1_deg\n", "line 1: expected columns with positions");
  check_points_error("x_mm,y_mm,z_mm,qx,qy\n",
                     "line 1: expected a column for each of 4 values that "
                     "belong together, found none for qz, qw");
  check_points_error("x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,qx,qy,qz,qw\n",
                     "line 1: expected one orientation");
  check_points_error("x_mm,y_mm,z_mm,a1_deg,a3_deg\n",
                     "line 1: expected angles of all joints from a1 on, found a3 but no a2");
  check_points_error("1,2,3\n", "line 1: expected a header");
  check_points_error("x_mm,y_mm,z_mm\n", "expected points, found no line but the header");
  const TemporaryFolder folder;
  CHECK_THROWS_AS(read(folder, "1,2,3\n", {"x_mm", "y_mm", "speed"}), std::invalid_argument);
  CHECK_THROWS_WITH(read(folder, "1,2,3\n", {"x_mm", "y_mm", "speed"}),
                    Catch::Matchers::StartsWith("--columns, column 3 (speed): expected a known"));
}

TEST_CASE("a value that is wrong is told with line and column", "[points_file]") {
  const std::string header = "joint,t_s,x_mm,y_mm,z_mm,target,qx,qy,qz,qw\n1,0,1,2,3,a,0,0,0,1\n";
  const auto check_line = [&](const std::string& line, const std::string& said) {
    check_points_error(header + line + "\n", "line 3, column " + said);
  };
  check_line("1,0,1,abc,3,a,0,0,0,1", "4 (y_mm): expected a number, found \"abc\"");
  check_line("1,0,nan,2,3,a,0,0,0,1", "3 (x_mm): expected a number, found \"nan\"");
  check_line("1,0,1,2,inf,a,0,0,0,1", "5 (z_mm): expected a number, found \"inf\"");
  check_line("1,,1,2,3,a,0,0,0,1", "2 (t_s): expected a number, found nothing");
  check_line("0,0,1,2,3,a,0,0,0,1", "1 (joint): expected a whole number from 1 to 12, found \"0\"");
  check_line("13,0,1,2,3,a,0,0,0,1", "1 (joint): expected a whole number from 1 to 12");
  check_line("1.5,0,1,2,3,a,0,0,0,1", "1 (joint): expected a whole number from 1 to 12");
  check_line("1,0,1,2,3,,0,0,0,1", "6 (target): expected a name or number, found nothing");
  check_line("1,0,1,2,3,a,0,0,0,0", "7 (qx): expected a quaternion, found zero");
  check_line("1,-1,1,2,3,a,0,0,0,1", "2 (t_s): expected a time no earlier than the line before");
  check_points_error(header + "1,0,1,2,3\n", "line 3: expected 10 columns, as in line 1, found 5");
}

TEST_CASE("time begins anew with another joint, sweep or target", "[points_file]") {
  const TemporaryFolder folder;
  CHECK(read(folder,
             "joint,sweep,target,t_s,x_mm,y_mm,z_mm\n1,1,a,5,0,0,0\n1,1,a,5,0,0,0\n"
             "1,1,b,4,0,0,0\n1,2,a,3,0,0,0\n2,2,a,2,0,0,0\n")
            .points.size() == 5);
}
