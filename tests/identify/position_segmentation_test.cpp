#include "identify/position_segmentation.hpp"

#include <cmath>

#include "identify/segmentation.hpp"
#include "tests/catch.hpp"
#include "tests/identify/simulated_campaign.hpp"

using namespace identify;
using identify::test::kr5_arc;

namespace {

/// The paper's campaign as a camera sees markers on the tool, `rate_hz` at most 250.
std::vector<Sweep> strokes_of(std::size_t markers, double noise_mm, double rate_hz,
                              std::uint32_t seed, PositionSegmenter* segmenter = nullptr) {
  const std::array<Eigen::Vector3d, 3> places{
      Eigen::Vector3d{200, 0, 215}, {60, 150, 180}, {-120, 90, 260}};
  std::vector<std::vector<Sample>> streams;
  for (std::size_t marker = 0; marker < markers; ++marker) {
    auto arm = kr5_arc();
    arm.tool_mm = places[marker];
    test::Campaign campaign(
        arm, {.position_mm = noise_mm, .seed = seed + static_cast<std::uint32_t>(10 * marker)});
    campaign.rest(1);
    campaign.sweep_all_90();
    streams.push_back(campaign.samples());
  }
  PositionSegmenter own;
  if (segmenter == nullptr) segmenter = &own;
  std::vector<Sweep> strokes;
  const auto take = [&](std::vector<Sweep> ended) {
    std::move(ended.begin(), ended.end(), std::back_inserter(strokes));
  };
  double next_s = 0;
  for (std::size_t i = 0; i < streams[0].size(); ++i) {
    if (streams[0][i].time_s < next_s) continue;
    next_s += 1 / rate_hz;
    std::vector<PositionSegmenter::Seen> frame;
    for (std::size_t marker = 0; marker < markers; ++marker) {
      frame.push_back({marker, streams[marker][i]});
      frame.back().sample.joints = 0;
    }
    take(segmenter->push(frame));
  }
  take(segmenter->finish());
  return strokes;
}

double overlap(const Sweep& a, const Sweep& b) {
  const double both =
      std::min(a.last().time_s, b.last().time_s) - std::max(a.first().time_s, b.first().time_s);
  return both / (b.last().time_s - b.first().time_s);
}

}  // namespace

TEST_CASE("noisy strokes are those of a quiet stream, or refused: none is made up, cut or joined") {
  const auto markers = GENERATE(std::size_t{1}, std::size_t{3});
  const auto noise_mm = GENERATE(0.05, 0.1, 0.3, 1.0);
  const auto rate_hz = GENERATE(100.0, 240.0);
  CAPTURE(markers, noise_mm, rate_hz);
  const auto quiet = strokes_of(markers, 0, rate_hz, 1);
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    CAPTURE(seed);
    PositionSegmenter segmenter;
    const auto noisy = strokes_of(markers, noise_mm, rate_hz, seed, &segmenter);
    CHECK(segmenter.noise_mm() == Approx(noise_mm).epsilon(0.15));
    std::size_t good = 0, expected = 0;
    for (const Sweep& stroke : quiet)
      if (stroke.defect == SweepDefect::none) ++expected;
    for (const Sweep& stroke : noisy) {
      if (stroke.defect != SweepDefect::none) continue;
      ++good;
      const auto same = std::find_if(quiet.begin(), quiet.end(), [&](const Sweep& one) {
        return one.target == stroke.target && overlap(stroke, one) > 0.8;
      });
      REQUIRE(same != quiet.end());
      CHECK(same->defect == SweepDefect::none);
      CHECK(overlap(*same, stroke) > 0.95);
      CHECK(std::abs(stroke.range_rad - same->range_rad) < 4 * kDegree);
    }
    CHECK(good <= expected);
    if (noise_mm < 0.5) CHECK(good == expected);
    CHECK(good >= expected / 2);
  }
}

TEST_CASE("the noise that rests show says how slow a motion is still seen") {
  PositionSegmenter segmenter;
  (void)strokes_of(1, 0.3, 100, 1, &segmenter);
  // 21 positions in 0.2 s: 6 sigma, 0.3 mm sqrt(3) / sqrt(sum of t^2).
  CHECK(segmenter.slowest_mm_s() == Approx(6 * 0.3 * std::sqrt(3.0) / 0.2775).epsilon(0.2));
}
