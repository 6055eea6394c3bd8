#include "daemon/report/report_folder.hpp"

#include <cmath>

#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using namespace sweepd;
using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;

namespace {

constexpr const char* kHead =
    "joint,sweep,t_s,x_mm,y_mm,z_mm,a1_deg,a2_deg,plane_residual_mm,radial_residual_mm,"
    "chain_axial_residual_mm,chain_radial_residual_mm,angle_error_arcsec,curve_error_arcsec,"
    "target\n";

}  // namespace

TEST_CASE("strokes are told apart by joint, sweep and target", "[report_folder]") {
  ReportFolder folder;
  read_strokes(std::string(kHead) +
                   "1,2,0.004,1,2,3,-45,90,0.1,0.2,0.3,0.4,5,6,1\n"
                   "1,2,0.008,2,2,3,-44,90,0.1,0.2,,,,,1\n"
                   "2,3,0.012,3,2,3,-44,91,,,,,,,2\n"
                   "2,3,0.016,,,,-44,92,,,,,,,2\n",
               folder);
  REQUIRE(folder.strokes.size() == 2);
  const Stroke& first = folder.strokes[0];
  CHECK(first.joint == 0);
  CHECK(first.sweep == 1);
  REQUIRE(first.points.size() == 2);
  CHECK(first.points[0].angle == -45);
  CHECK(first.points[0].axial_mm == 0.3);  // the chain's
  CHECK(first.points[1].axial_mm == 0.1);  // the circle's, where the chain has none
  CHECK(first.points[1].radial_mm == 0.2);
  CHECK(std::isnan(first.points[1].along_arcsec));
  CHECK(folder.strokes[1].target == 1);
  CHECK(folder.strokes[1].points.size() == 1);  // a row without a position is none
  CHECK(folder.strokes[1].points[0].angle == 91);
  REQUIRE(folder.sums.size() == 2);
  CHECK(folder.sums[0].count == 2);
}

TEST_CASE("the sums of a joint's points are of one target, whose points lie on one circle",
          "[report_folder]") {
  ReportFolder folder;
  std::string csv = kHead;
  for (const char* const target : {"2", "3"})
    for (int k = 0; k < 5; ++k)
      csv += "1,1," + std::to_string(k) + "," + std::to_string(k) + ",7," + target +
             "00,0,0,,,,,,," + target + "\n";
  read_strokes(csv, folder);
  REQUIRE(folder.sums.size() == 1);
  CHECK(folder.sums[0].target == 1);
  CHECK(folder.sums[0].count == 5);
  CHECK(folder.sums[0].products(2, 2) == 0);  // all at the same height
}

TEST_CASE("a day's sweep is thinned for drawing, its sums are of all points", "[report_folder]") {
  ReportFolder folder;
  std::string csv = kHead;
  constexpr int kRows = 25'003;
  for (int k = 0; k < kRows; ++k)
    csv += "1,1," + std::to_string(k) + "," + std::to_string(k) + ",7,9,0,0,,,,,,,1\n";
  read_strokes(csv, folder);
  REQUIRE(folder.strokes.size() == 1);
  const auto& points = folder.strokes[0].points;
  CHECK(points.size() <= ReportFolder::kMostPoints + 1);
  CHECK(points.size() > ReportFolder::kMostPoints / 2);
  CHECK(points.front().time_s == 0);
  CHECK(points.back().time_s == kRows - 1);
  CHECK(folder.sums[0].count == kRows);
  CHECK_THAT(folder.sums[0].sum.x() / kRows, WithinAbs((kRows - 1) / 2.0, 1e-6));
}

TEST_CASE("a folder without a result says which one to give", "[report_folder]") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH(read_report_folder(folder.path()),
                    ContainsSubstring("result.json is not there: give a folder"));
  (void)folder.write("result.json", "{\"schema\": \"something else\"}");
  CHECK_THROWS_WITH(read_report_folder(folder.path()),
                    ContainsSubstring("result.json holds no result of sweepd"));
  (void)folder.write("result.json", "{\"schema\": \"sweepd.result/2\"}");
  CHECK_THROWS_WITH(read_report_folder(folder.path()),
                    ContainsSubstring("result.json has the schema sweepd.result/2"));
  (void)folder.write("result.json", "[1, 2");
  CHECK_THROWS_WITH(read_report_folder(folder.path()), ContainsSubstring("holds no result"));
  (void)folder.write("result.json", "{\"schema\": 5}");
  CHECK_THROWS_WITH(read_report_folder(folder.path()), ContainsSubstring("holds no result"));
}

TEST_CASE("what else is missing, or is rubbish, is left out", "[report_folder]") {
  const TemporaryFolder folder;
  (void)folder.write("result.json", "{\"schema\": \"sweepd.result/1\"}");
  (void)folder.write("run.json", "no JSON");
  (void)folder.write("sweeps.csv", "joint,sweep\n-5,99999999999999\nx,y\n\n1,2,3");
  const auto read = read_report_folder(folder.path());
  CHECK(read.run.is_null());
  CHECK(read.link.is_null());
  CHECK(read.dh_csv.empty());
  for (const Stroke& stroke : read.strokes) CHECK(stroke.points.empty());
}
