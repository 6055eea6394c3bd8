#include "daemon/points/axes_file.hpp"

#include "daemon/points/csv_file.hpp"
#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using Eigen::Vector3d;
using sweepd::CsvError;
using sweepd::read_axes;
using sweepd::test::TemporaryFolder;

namespace {

const std::string kAxesHeader = "joint,x_mm,y_mm,z_mm,dx,dy,dz\n";

void check_axes_error(const std::string& text, const std::string& said) {
  const TemporaryFolder folder;
  INFO(text);
  const auto path = folder.write("axes.csv", text);
  CHECK_THROWS_AS(read_axes(path, {}, 6), CsvError);
  CHECK_THROWS_WITH(read_axes(path, {}, 6), ContainsSubstring("axes.csv: " + said));
}

}  // namespace

TEST_CASE("axes come in any order, with directions of any length, in mm or m", "[axes_file]") {
  const TemporaryFolder folder;
  const auto axes = read_axes(
      folder.write("axes.csv", "dz,dy,dx,joint,x_m,y_m,z_m\n0,4,3,2,0.5,0,0\n-7,0,0,1,0,0,0.4\n"),
      {}, 6);
  REQUIRE(axes.size() == 2);
  CHECK((axes[0].direction - Vector3d(0, 0, -1)).norm() < 1e-15);
  CHECK((axes[0].point_mm - Vector3d(0, 0, 400)).norm() < 1e-12);
  CHECK((axes[1].direction - Vector3d(0.6, 0.8, 0)).norm() < 1e-15);
  CHECK((axes[1].point_mm - Vector3d(500, 0, 0)).norm() < 1e-12);
  CHECK(axes[0].covariance.isZero(0));
}

TEST_CASE("stated uncertainties are those of the axis, across it", "[axes_file]") {
  const TemporaryFolder folder;
  const auto axes =
      read_axes(folder.write("axes.csv",
                             "joint,x_mm,y_mm,z_mm,dx,dy,dz,direction_sigma_deg,point_sigma_mm\n"
                             "1,0,0,0,1,2,3,0.01,0.2\n2,0,0,0,0,0,1,,\n"),
                {}, 6);
  CHECK(axes[0].direction_sigma_rad() == Approx(sweepd::radians(0.01)));
  CHECK(axes[0].point_sigma_mm() == Approx(0.2));
  CHECK((axes[0].covariance.topLeftCorner<3, 3>() * axes[0].direction).norm() < 1e-15);
  CHECK(axes[1].covariance.isZero(0));
}

TEST_CASE("axes without a header are named from outside", "[axes_file]") {
  const TemporaryFolder folder;
  const auto path = folder.write("axes.csv", "1 base 0 0 0 0 0 1\n");
  CHECK(read_axes(path, {"joint", "-", "x_mm", "y_mm", "z_mm", "dx", "dy", "dz"}, 6).size() == 1);
  CHECK_THROWS_AS(read_axes(path, {"joint", "name"}, 6), std::invalid_argument);
}

TEST_CASE("axes that are wrong are told with line and column", "[axes_file]") {
  check_axes_error(kAxesHeader + "1,0,0,0,0,0,0\n",
                   "line 2, column 5 (dx): expected a direction, found zero");
  check_axes_error(
      kAxesHeader + "1,0,0,0,0,0,1\n2,0,0,0,1,0,0\n1,0,0,0,0,0,1\n",
      "line 4, column 1 (joint): expected each joint once, found joint 1 in line 2 too");
  check_axes_error(kAxesHeader + "1,0,0,0,0,0,1\n3,0,0,0,1,0,0\n",
                   "line 3: expected the axes of all joints up to joint 3, found none of joint 2");
  check_axes_error(kAxesHeader + "7,0,0,0,0,0,1\n",
                   "line 2, column 1 (joint): expected a whole number from 1 to 6, found \"7\"");
  check_axes_error(kAxesHeader + "1,0,0,,0,0,1\n",
                   "line 2, column 4 (z_mm): expected a number, found nothing");
  check_axes_error(kAxesHeader + "1,0,0,0,0,0,up\n",
                   "line 2, column 7 (dz): expected a number, found \"up\"");
  check_axes_error(kAxesHeader, "expected axes, found no line but the header");
  check_axes_error("joint,x_mm,y_mm,z_mm,dx,dy\n", "line 1: expected a column dz, found none");
  check_axes_error("joint,x_mm,y_mm,z_mm,dx,dy,dz,name\n",
                   "line 1, column 8 (name): expected a known column");
  check_axes_error("joint,x_mm,y_mm,z_mm,dx,dy,dz,point_sigma_mm\n1,0,0,0,0,0,1,-1\n",
                   "line 2, column 8 (point_sigma_mm): expected a standard uncertainty");
}
