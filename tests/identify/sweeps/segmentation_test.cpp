#include "identify/sweeps/segmentation.hpp"

#include <algorithm>
#include <cmath>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/simulated_campaign.hpp"

using namespace identify;
using identify::test::segment;
using identify::test::without_angles;

namespace {

double angle_deg(const Sample& sample, std::size_t joint) {
  return sample.angles_rad[joint] / kDegree;
}

/// What a controller prints at one decimal.
std::vector<Sample> rounded(std::vector<Sample> samples, double step_deg) {
  for (auto& sample : samples)
    for (auto& angle : sample.angles_rad)
      angle = std::round(angle / kDegree / step_deg) * step_deg * kDegree;
  return samples;
}

}  // namespace

TEST_CASE("each stroke of the paper's campaign is found, with its joint, direction and ends",
          "[segmentation]") {
  test::Campaign campaign(test::kr5_arc(), {0.0005});
  campaign.sweep_all_90();
  const auto sweeps = segment(campaign.samples());
  struct Expected {
    std::size_t joint;
    double from, to;
  };
  const std::vector<Expected> expected = {
      {0, 90, -45},   {0, -45, 45}, {0, 45, 90},  {1, -90, -60}, {1, -60, -130},
      {1, -130, -90}, {2, 90, 120}, {2, 120, 30}, {2, 30, 90},   {3, 0, 90},
      {3, 90, 0},     {4, 90, 0},   {4, 0, 90},   {5, 0, 90},    {5, 90, 0}};
  REQUIRE(sweeps.size() == expected.size());
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    CAPTURE(i);
    CHECK(sweeps[i].joint == expected[i].joint);
    CHECK(sweeps[i].direction == (expected[i].to > expected[i].from ? 1 : -1));
    CHECK(sweeps[i].defect == SweepDefect::none);
    // Slow creep at the soft ends, and rest that is trimmed, stay below 0.2 %.
    CHECK(angle_deg(sweeps[i].first(), expected[i].joint) == Approx(expected[i].from).margin(0.3));
    CHECK(angle_deg(sweeps[i].last(), expected[i].joint) == Approx(expected[i].to).margin(0.3));
    CHECK(sweeps[i].range_rad / kDegree ==
          Approx(std::abs(expected[i].to - expected[i].from)).margin(0.5));
  }
}

TEST_CASE("positions alone give the same strokes, without joints", "[segmentation]") {
  test::Campaign campaign(test::kr5_arc(), {0.0005});
  campaign.sweep_all_30();
  const auto with = segment(campaign.samples());
  const auto without = segment(without_angles(campaign.samples()));
  REQUIRE(without.size() == with.size());
  for (std::size_t i = 0; i < with.size(); ++i) {
    CAPTURE(i);
    CHECK_FALSE(without[i].joint);
    CHECK(without[i].defect == SweepDefect::none);
    CHECK(without[i].range_rad == Approx(with[i].range_rad).margin(0.5 * kDegree));
  }
}

TEST_CASE("a joint that swings without rest is cut at its turning points", "[segmentation]") {
  for (const double step : {0.0, 0.1}) {
    test::Campaign campaign(test::kr5_arc());
    campaign.rest(1);
    for (const double to : {26.0, -26.0, 26.0, -26.0}) campaign.move(0, 90 + to, 40);
    const auto sweeps = segment(step > 0 ? rounded(campaign.samples(), step) : campaign.samples(),
                                {0, step * kDegree});
    REQUIRE(sweeps.size() == 4);
    for (std::size_t i = 0; i < 4; ++i) {
      CHECK(sweeps[i].direction == (i % 2 == 0 ? 1 : -1));
      CHECK(angle_deg(sweeps[i].last(), 0) == Approx(i % 2 == 0 ? 116 : 64).margin(0.3));
    }
  }
}

TEST_CASE("a joint at rest between two printed values is not taken for a moving one",
          "[segmentation]") {
  test::Campaign campaign(test::kr5_arc(), {0.02});
  campaign.rest(2).move(0, 45, 30).rest(2);
  const auto sweeps = segment(rounded(campaign.samples(), 0.1), {0, 0.1 * kDegree});
  REQUIRE(sweeps.size() == 1);
  CHECK(sweeps[0].joint == 0u);
  CHECK(sweeps[0].defect == SweepDefect::none);
}

TEST_CASE("moves of several joints are no sweeps", "[segmentation]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.rest().move_all({{0, 45}, {2, 60}}, 20).rest();
  CHECK(segment(campaign.samples()).empty());
  const auto seen = segment(without_angles(campaign.samples()));
  REQUIRE(seen.size() == 1);
  CHECK(seen[0].defect == SweepDefect::not_an_arc);
}

TEST_CASE("a second joint that creeps along spoils a sweep", "[segmentation]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.rest().move_all({{0, 0}, {1, -90.08}}, 20).rest();
  const auto sweeps = segment(campaign.samples());
  REQUIRE(sweeps.size() == 1);
  CHECK(sweeps[0].joint == 0u);
  CHECK(sweeps[0].defect == SweepDefect::other_joint_moved);
}

TEST_CASE("short strokes and those of few samples are reported as such", "[segmentation]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.rest().move(0, 87, 10).rest().move(1, -70, 400).rest();
  const auto sweeps = segment(campaign.samples());
  REQUIRE(sweeps.size() == 2);
  CHECK(sweeps[0].defect == SweepDefect::too_short);
  CHECK(sweeps[1].defect == SweepDefect::too_few_samples);
}

TEST_CASE("a gap in the stream ends a stroke, single lost samples do not", "[segmentation]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.rest().move(0, 0, 20).rest();
  std::vector<Sample> holes;
  for (std::size_t i = 0; i < campaign.samples().size(); ++i)
    if (i % 50 != 7) holes.push_back(campaign.samples()[i]);
  CHECK(segment(holes).size() == 1);
  std::vector<Sample> gap;
  for (const auto& sample : campaign.samples())
    if (sample.time_s < 2 || sample.time_s > 2.5) gap.push_back(sample);
  CHECK(segment(gap).size() == 2);
}

TEST_CASE("samples out of order, without positions or without angles do no harm",
          "[segmentation]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.rest().move(0, 0, 20).rest();
  auto samples = campaign.samples();
  samples.insert(samples.begin() + 500, samples[300]);
  samples.insert(samples.begin() + 600, samples[599]);
  samples[700].joints = 0;
  for (auto& sample : samples) sample.has_position = false;
  const auto sweeps = segment(samples);
  REQUIRE(sweeps.size() == 1);
  CHECK(sweeps[0].range_rad == Approx(90 * kDegree).margin(0.2 * kDegree));
  Segmenter nothing(6);
  CHECK(nothing.finish().empty());
}

TEST_CASE("a stream has angles from the first sample on that has them", "[segmentation]") {
  test::Campaign campaign(test::kr5_arc());
  campaign.sweep_all_30();
  const auto whole = segment(campaign.samples());
  for (const std::size_t every : {7U, 30U, 100000U}) {
    CAPTURE(every);
    auto samples = campaign.samples();
    for (std::size_t i = 0; i < samples.size(); i += every) {
      samples[i].joints = 0;
      samples[i].angles_rad = {};
    }
    const auto sweeps = segment(samples);
    REQUIRE(sweeps.size() == whole.size());
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
      CAPTURE(i);
      CHECK(sweeps[i].joint == whole[i].joint);
      CHECK(sweeps[i].range_rad == Approx(whole[i].range_rad).margin(0.1 * kDegree));
      CHECK(std::all_of(sweeps[i].samples->begin(), sweeps[i].samples->end(),
                        [](const Sample& sample) { return sample.joints > 0; }));
    }
  }
}

TEST_CASE("a target at rest is no motion, whatever the device's noise", "[segmentation]") {
  test::Campaign campaign(test::kr5_arc(), {0, 0.03});
  campaign.rest(5);
  CHECK(segment(without_angles(campaign.samples())).empty());
}

TEST_CASE("the ringing after a stop is no sweep, though it turns through any angle",
          "[segmentation]") {
  test::Campaign campaign(test::kr5_arc(), {0.0001});
  campaign.rest().move(0, 0, 20);
  const double stop_s = campaign.samples().back().time_s;
  campaign.rest(2);
  auto samples = without_angles(campaign.samples());
  // As seen on a real arm: some tenths of a millimetre at a few hertz, for a while.
  for (auto& sample : samples) {
    const double since = sample.time_s - stop_s - 0.4;
    if (since <= 0 || since > 1) continue;
    const double phase = 2 * kPi * 2.5 * since;
    sample.position_mm += 0.4 * Eigen::Vector3d(std::cos(phase) - 1, std::sin(phase), 0);
  }
  std::size_t usable = 0;
  for (const auto& sweep : segment(samples)) usable += sweep.defect == SweepDefect::none ? 1 : 0;
  CHECK(usable == 1);
}
