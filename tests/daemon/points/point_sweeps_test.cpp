#include "daemon/points/point_sweeps.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/points/csv_file.hpp"
#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/point_files.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using identify::Sweep;
using identify::SweepDefect;
using namespace sweepd;
using namespace sweepd::test;

namespace {

constexpr identify::Resolution kSixDecimals{1e-6, 1.7e-8};

PointsFile file_of(const TemporaryFolder& folder, const std::string& text) {
  return PointsReader({}, 12).read(folder.write("points.csv", text), {});
}

/// Points on a circle about Z, one a degree from 0, of joint 1 unless `lead` says otherwise.
std::string arc(int points, const std::string& lead = "1,", double radius_mm = 100) {
  std::string text;
  for (int k = 0; k < points; ++k)
    text += lead + fixed(radius_mm * std::cos(radians(k)), 6) + "," +
            fixed(radius_mm * std::sin(radians(k)), 6) + ",5\n";
  return text;
}

const std::string kListed = "joint,x_mm,y_mm,z_mm\n";

}  // namespace

TEST_CASE("each run of lines of a joint is a sweep, in the order of the file", "[point_sweeps]") {
  const TemporaryFolder folder;
  const auto sweeps = listed_sweeps(
      file_of(folder, kListed + arc(30, "2,") + arc(20, "1,") + arc(10, "2,")), kSixDecimals);
  REQUIRE(sweeps.size() == 3);
  CHECK(sweeps[0].joint == 1U);
  CHECK(sweeps[1].joint == 0U);
  CHECK(sweeps[2].joint == 1U);
  CHECK(sweeps[0].samples->size() == 30);
  CHECK(sweeps[0].first().time_s < sweeps[1].first().time_s);
  for (const Sweep& sweep : sweeps) {
    CHECK(sweep.defect == SweepDefect::none);
    CHECK(sweep.direction == 0);  // no angles tell it
    CHECK(degrees(sweep.range_rad) ==
          Approx(static_cast<double>(sweep.samples->size() - 1)).margin(1e-3));
  }
}

TEST_CASE("a column sweep tells sweeps of one joint apart, a column target those of two targets",
          "[point_sweeps]") {
  const TemporaryFolder folder;
  const auto sweeps = listed_sweeps(
      file_of(folder, "joint,sweep,x_mm,y_mm,z_mm\n" + arc(30, "1,1,") + arc(20, "1,2,")),
      kSixDecimals);
  REQUIRE(sweeps.size() == 2);
  CHECK(sweeps[1].samples->size() == 20);

  // Two targets measured in turns.
  std::string text = "joint,target,x_mm,y_mm,z_mm\n";
  const std::string one = arc(30, "1,ball,");
  const std::string other = arc(30, "1,cone,", 50);
  for (std::size_t a = 0, b = 0; a < one.size();) {
    const auto end_a = one.find('\n', a) + 1;
    const auto end_b = other.find('\n', b) + 1;
    text += one.substr(a, end_a - a) + other.substr(b, end_b - b);
    a = end_a;
    b = end_b;
  }
  const auto both = listed_sweeps(file_of(folder, text), kSixDecimals);
  REQUIRE(both.size() == 2);
  CHECK(both[0].target == 0);
  CHECK(both[1].target == 1);
  CHECK(both[1].samples->size() == 30);
  CHECK(both[1].first().position_mm.x() == 50);
}

TEST_CASE("angles tell range and direction of a listed sweep, and that another joint moved",
          "[point_sweeps]") {
  const TemporaryFolder folder;
  const std::string header = "joint,x_mm,y_mm,z_mm,a1_deg,a2_deg\n";
  std::string falling = header;
  std::string crept = header;
  for (int k = 0; k <= 40; ++k) {
    const std::string start = "1," + fixed(100 * std::cos(radians(-k)), 6) + "," +
                              fixed(100 * std::sin(radians(-k)), 6) + ",5," + fixed(10 - k, 4);
    falling += start + ",20.0000\n";
    crept += start + "," + fixed(20 + 0.001 * k, 4) + "\n";
  }
  const auto good = listed_sweeps(file_of(folder, falling), {1e-6, radians(1e-4)});
  REQUIRE(good.size() == 1);
  CHECK(good[0].direction == -1);
  CHECK(degrees(good[0].range_rad) == Approx(40));
  CHECK(good[0].defect == SweepDefect::none);
  const auto bad = listed_sweeps(file_of(folder, crept), {1e-6, radians(1e-4)});
  REQUIRE(bad.size() == 1);
  CHECK(bad[0].defect == SweepDefect::other_joint_moved);  // by 0.04 degrees
}

TEST_CASE("listed points that are no sweep say why", "[point_sweeps]") {
  const TemporaryFolder folder;
  const auto defect_of = [&](const std::string& lines) {
    const auto sweeps = listed_sweeps(file_of(folder, kListed + lines), kSixDecimals);
    return sweeps.size() == 1 ? sweeps.front().defect : SweepDefect::none;
  };
  CHECK(defect_of(arc(3)) == SweepDefect::too_few_samples);
  CHECK(defect_of(arc(5)) == SweepDefect::too_short);  // 4 degrees
  CHECK(defect_of("1,0,0,0\n1,1,0,0\n1,2,0,0\n1,3,0,0\n1,4,0,0\n") == SweepDefect::not_an_arc);
  CHECK(defect_of("1,7,7,7\n1,7,7,7\n1,7,7,7\n1,7,7,7\n") == SweepDefect::not_an_arc);
  // Lines without a position are none; four points will do if they span an arc.
  CHECK(defect_of("1,100,0,0\n1,,0,0\n1,0,100,0\n1,-100,0,0\n1,0,-100,0\n") == SweepDefect::none);
  CHECK(listed_sweeps(file_of(folder, kListed + "1,,0,0\n"), kSixDecimals).empty());
}

TEST_CASE("a stream is split by target before it is segmented", "[point_sweeps]") {
  const TemporaryFolder folder;
  const auto first = measured_kr5({.wobble_deg = 1e-4});
  const auto second = measured_kr5({.wobble_deg = 1e-4}, {0, 150, 300});
  const Layout layout{.times = true, .angles = true, .more = "target,"};
  std::string text = points_header(layout);
  for (std::size_t k = 0; k < first.stream.size(); ++k)
    text += points_lines({first.stream[k]}, layout, "1,") +
            points_lines({second.stream[k]}, layout, "2,");
  WorstLimit limit;
  const auto sweeps = streamed_sweeps(file_of(folder, text), 6, kSixDecimals, limit);
  CHECK_FALSE(limit);  // angles tell what moves
  const auto alone = identify::test::segment(first.stream, kSixDecimals);
  REQUIRE(sweeps.size() == 2 * alone.size());
  for (std::size_t k = 0; k < sweeps.size(); ++k) {
    CHECK(sweeps[k].target == k % 2);  // in the order of time
    CHECK(sweeps[k].joint == alone[k / 2].joint);
    CHECK(sweeps[k].samples->size() == alone[k / 2].samples->size());
  }
}

namespace {

/// A KR 5's stream of so many markers: complete, right, and its noise as it is.
void check_noisy_stream(std::size_t markers, double noise_mm, std::uint32_t seed) {
  CAPTURE(markers, noise_mm, seed);
  const std::array<Eigen::Vector3d, 3> places{
      Eigen::Vector3d{200, 0, 215}, {60, 150, 180}, {-120, 90, 260}};
  PointsFile file;
  file.with_times = true;
  for (std::size_t target = 0; target < markers; ++target)
    for (identify::Sample sample :
         measured_kr5({.position_mm = noise_mm, .seed = seed + static_cast<std::uint32_t>(target)},
                      places[target])
             .stream) {
      sample.joints = 0;
      file.points.push_back({sample, 0, 0, target});
    }
  auto known = identify::test::for_kr5();
  auto sweeps = streamed_sweeps(file, 6, {}, known.motion_limit);
  REQUIRE(known.motion_limit);
  CHECK(known.motion_limit->noise_mm == Approx(noise_mm).epsilon(0.15));
  const auto found = identify::identify(std::move(sweeps), known);
  CAPTURE(found.reason);
  CHECK(found.status == identify::Status::complete);
  REQUIRE(found.chain);
  CHECK(found.chain->noise.position_mm == Approx(noise_mm).epsilon(0.05));
  CHECK(identify::test::find_warning(found, "motion_limit") == nullptr);
  REQUIRE(found.dh.size() == 6);
  for (std::size_t j = 0; j < 5; ++j) {
    CAPTURE(j);
    const auto& row = found.dh[j];
    const auto& right = found.specified[j];
    // Five sigma are not passed by chance; half a degree and 5 mm tell every sign.
    CHECK(std::abs(row.a_mm.value - right.a_mm) < std::min(5.0, 5 * row.a_mm.sigma));
    CHECK(std::abs(row.alpha_rad.value - right.alpha_rad) <
          std::min(0.5 * identify::kDegree, 5 * row.alpha_rad.sigma));
  }
}

}  // namespace

TEST_CASE("noisy positions of one marker or three give the arm, and the noise that they have",
          "[point_sweeps][long]") {
  check_noisy_stream(1, 0.1, 1);
  check_noisy_stream(3, 0.1, 4);
}

TEST_CASE("noisy positions give the arm up to a millimetre of noise", "[point_sweeps][long]") {
  const auto markers = GENERATE(std::size_t{1}, std::size_t{3});
  const auto noise_mm = GENERATE(0.05, 0.1, 0.3, 1.0);
  check_noisy_stream(markers, noise_mm, 10);
}

TEST_CASE("the strokes of one file are all of its joint, unless angles say otherwise",
          "[point_sweeps]") {
  const TemporaryFolder folder;
  identify::test::Campaign campaign(identify::test::kr5_arc());
  campaign.rest().sweep(2, 120, 30);
  const Layout layout{.times = true};
  const auto file =
      file_of(folder, points_header(layout) + points_lines(campaign.samples(), layout));
  WorstLimit limit;
  const auto sweeps = sweeps_of_joint(file, 4, 6, kSixDecimals, limit);
  CHECK(sweeps.size() == 3);
  for (const Sweep& sweep : sweeps) CHECK(sweep.joint == 4U);

  const Layout with_angles{.times = true, .angles = true};
  const auto known =
      file_of(folder, points_header(with_angles) + points_lines(campaign.samples(), with_angles));
  CHECK(sweeps_of_joint(known, 2, 6, kSixDecimals, limit).size() == 3);
  CHECK_THROWS_WITH(sweeps_of_joint(known, 4, 6, kSixDecimals, limit),
                    ContainsSubstring("points.csv: expected sweeps of joint 5") &&
                        ContainsSubstring("found angles of joint 3 alone"));
}

TEST_CASE("a stream whose times are no seconds, or positions no millimetres, is told to be",
          "[point_sweeps]") {
  const TemporaryFolder folder;
  identify::test::Campaign campaign(identify::test::kr5_arc(), {.position_mm = 0.02});
  campaign.rest(1).sweep(2, 120, 30);
  const Layout layout{.times = true};
  const auto seen = [&](double time, double length) {
    auto samples = campaign.samples();
    for (auto& sample : samples) {
      sample.time_s *= time;
      sample.position_mm *= length;
    }
    WorstLimit limit;
    return streamed_sweeps(file_of(folder, points_header(layout) + points_lines(samples, layout)),
                           6, kSixDecimals, limit);
  };
  CHECK(seen(1, 1).size() == 3);
  CHECK_THROWS_WITH(seen(1000, 1), ContainsSubstring("points.csv: expected times at most 0.25 s") &&
                                       ContainsSubstring("found 4 s: give seconds"));
  CHECK_THROWS_WITH(seen(1, 1e-3), ContainsSubstring("points.csv: expected positions that move") &&
                                       ContainsSubstring("x_m, y_m, z_m"));

  const auto with_angles = [&](double time, double angle, const std::string& unit = "_deg") {
    auto samples = campaign.samples();
    for (auto& sample : samples) {
      sample.angles_rad[5] += sample.time_s * radians(0.002);  // a locked joint is not quite still
      sample.time_s *= time;
      for (double& each : sample.angles_rad) each *= angle;
    }
    const Layout all{.times = true, .angles = true};
    WorstLimit limit;
    std::string header = points_header(all);
    for (auto at = header.find("_deg"); at != std::string::npos; at = header.find("_deg", at + 1))
      header.replace(at, 4, unit);
    return streamed_sweeps(file_of(folder, header + points_lines(samples, all)), 6, kSixDecimals,
                           limit);
  };
  CHECK(with_angles(1, 1).front().defect == SweepDefect::none);
  CHECK_THROWS_WITH(with_angles(1000, 1), ContainsSubstring("found 4 s: give seconds"));
  CHECK_THROWS_WITH(with_angles(0, 1), ContainsSubstring("expected times that rise") &&
                                           ContainsSubstring("found 0 s for all"));
  CHECK_THROWS_WITH(seen(0, 1), ContainsSubstring("expected times that rise"));
  for (const auto& [angle, unit] : {std::pair(degrees(1), "_deg"), {1.0, "_rad"}})
    CHECK_THROWS_WITH(with_angles(1, angle, unit),
                      ContainsSubstring("found 120 rad: name the columns a1_deg"));
  CHECK_NOTHROW(with_angles(1, degrees(1), "_mm"));

  // One that only rests is no mistake.
  identify::test::Campaign still(identify::test::kr5_arc(), {.position_mm = 0.02});
  still.rest(5);
  WorstLimit limit;
  CHECK(streamed_sweeps(
            file_of(folder, points_header(layout) + points_lines(still.samples(), layout)), 6,
            kSixDecimals, limit)
            .empty());
}
