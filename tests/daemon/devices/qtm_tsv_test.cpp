#include "daemon/devices/maker_formats.hpp"
#include "tests/daemon/devices/read_text.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd;
using namespace sweepd::test;

namespace {

const std::string kQtmHead =
    "NO_OF_FRAMES\t3\nFREQUENCY\t200\nDATA_INCLUDED\t3D\nMARKER_NAMES\ta\tb\t\n"
    "TRAJECTORY_TYPES\tMeasured\tMeasured\n";

}  // namespace

TEST_CASE("QTM writes data with frame and time, or without, and with or without names of columns",
          "[qtm_tsv]") {
  for (const std::string lines :
       {"1\t2\t3\t4\t5\t6\n1\t2\t3\t4\t5\t6\n", "1\t2\t3\t4\t5\t6\t\n1\t2\t3\t4\t5\t6\t\n",
        "1\t0.000\t1\t2\t3\t4\t5\t6\n2\t0.005\t1\t2\t3\t4\t5\t6\n",
        "1\t1\t2\t3\t4\t5\t6\n2\t1\t2\t3\t4\t5\t6\n",
        "Frame\tTime\ta X\ta Y\ta Z\tb X\tb Y\tb "
        "Z\n1\t0\t1\t2\t3\t4\t5\t6\n2\t0.005\t1\t2\t3\t4\t5\t"
        "6\n"}) {
    const auto file = read_text(kQtmHead + lines);
    INFO(lines);
    REQUIRE(file.points.size() == 4);
    CHECK(file.points[1].sample.position_mm == Eigen::Vector3d(4, 5, 6));
    CHECK(file.points[3].sample.time_s == Approx(0.005));
    CHECK_THAT(notes_of(file), ContainsSubstring("2 of the 3 frames"));
  }
}

TEST_CASE("what QTM did not see is empty, null or zero", "[qtm_tsv]") {
  const auto file = read_text(kQtmHead +
                              "0.000\t0.000\t0.000\t4\t5\t6\nnull\tnull\tnull\t4\t5\t6\n"
                              "\t\t\t4\t5\t6\n1\t0\t0\t4\t5\t6\n");
  REQUIRE(file.points.size() == 5);
  CHECK(file.points[3].target == 1);
  CHECK(file.points[3].sample.position_mm == Eigen::Vector3d(1, 0, 0));
}

TEST_CASE("a frame in which QTM saw no target takes its time, where lines tell the time",
          "[qtm_tsv]") {
  const auto file = read_text(kQtmHead + "1\t2\t3\t4\t5\t6\n\t\t\t\t\t\n1\t2\t3\t4\t5\t6\n");
  REQUIRE(file.points.size() == 4);
  CHECK(file.points[2].sample.time_s == Approx(0.010));
  CHECK_THAT(notes_of(file), !ContainsSubstring("frames that it tells of"));
}

TEST_CASE("what is wrong in a file of QTM is told with its place", "[qtm_tsv]") {
  check_text_error("NO_OF_FRAMES\t3\nFREQUENCY\t200\n",
                   "line 2: expected MARKER_NAMES or BODY_NAMES");
  check_text_error(kQtmHead, "line 5: expected lines of data behind the header");
  check_text_error(kQtmHead + "1\t2\t3\t4\n",
                   "line 6: expected 3 columns for each of 2 names, perhaps with frame and time in "
                   "front, found 4");
  check_text_error(
      "NO_OF_FRAMES\t3\nFREQUENCY\tEXT\nMARKER_NAMES\ta\nTRAJECTORY_TYPES\tMeasured\n1\t2\t3\n",
      "expected FREQUENCY in Hz in the header or a column of times");
  check_text_error("NO_OF_FRAMES\t3\nFREQUENCY\t9\nMARKER_NAMES\ta\ta\n1\t2\t3\t1\t2\t3\n",
                   "line 3: expected each target once");
  check_text_error(kQtmHead + "1\t2\t3\t4\t5\t6\n1\t2\t3\t4\t5\tx\n",
                   "line 7: column 6 (b): expected a number, found \"x\"");
}
