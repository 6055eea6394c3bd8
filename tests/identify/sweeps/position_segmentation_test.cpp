#include "identify/sweeps/position_segmentation.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <random>

#include "identify/geometry/angle.hpp"
#include "identify/sweeps/segmentation.hpp"
#include "identify/sweeps/sweep.hpp"
#include "tests/catch.hpp"
#include "tests/identify/simulated_campaign.hpp"

using namespace identify;
using identify::test::kr5_arc;

namespace {

struct Stream {
  std::size_t markers = 1;
  double noise_mm = 0;
  double rate_hz = 100;  ///< at most 250
  std::uint32_t seed = 1;
  double lost_from_s = 0, lost_to_s = 0;  ///< when the last marker is not seen
  std::size_t stray_every = 0;            ///< so many frames, one is 200 mm off; 0: none
  std::size_t swap_every = 0;             ///< so many frames, the first two change places for eight
};
using Moves = std::function<void(test::Campaign&)>;

/// The paper's, after a second of rest.
void paper_sweeps(test::Campaign& campaign) {
  campaign.rest(1).sweep_all_90();
}

/// A KR 5 as a camera sees markers on its tool.
std::vector<Sweep> strokes_of(const Stream& how, PositionSegmenter& segmenter,
                              const Moves& moves = paper_sweeps) {
  const std::array<Eigen::Vector3d, 3> places{
      Eigen::Vector3d{200, 0, 215}, {60, 150, 180}, {-120, 90, 260}};
  std::vector<std::vector<Sample>> streams;
  for (std::size_t marker = 0; marker < how.markers; ++marker) {
    auto arm = kr5_arc();
    arm.tool_mm = places[marker];
    test::Campaign campaign(arm, {.position_mm = how.noise_mm,
                                  .seed = how.seed + static_cast<std::uint32_t>(10 * marker)});
    moves(campaign);
    streams.push_back(campaign.samples());
  }
  std::vector<Sweep> strokes;
  const auto take = [&](std::vector<Sweep> ended) {
    std::move(ended.begin(), ended.end(), std::back_inserter(strokes));
  };
  double next_s = 0;
  std::size_t count = 0, frames = 0;
  for (std::size_t i = 0; i < streams[0].size(); ++i) {
    const double time_s = streams[0][i].time_s;
    if (time_s < next_s) continue;
    next_s += 1 / how.rate_hz;
    std::vector<PositionSegmenter::Seen> frame;
    for (std::size_t marker = 0; marker < how.markers; ++marker) {
      if (marker + 1 == how.markers && time_s > how.lost_from_s && time_s < how.lost_to_s) continue;
      frame.push_back({marker, streams[marker][i]});
      frame.back().sample.joints = 0;
      if (how.stray_every > 0 && ++count % how.stray_every == 0)
        frame.back().sample.position_mm += Eigen::Vector3d(120, -120, 100);
    }
    if (how.swap_every > 0 && ++frames % how.swap_every >= how.swap_every - 8)
      std::swap(frame[0].sample.position_mm, frame[1].sample.position_mm);
    take(segmenter.push(frame));
  }
  take(segmenter.finish());
  return strokes;
}

std::vector<Sweep> strokes_of(const Stream& how, const Moves& moves = paper_sweeps) {
  PositionSegmenter segmenter;
  return strokes_of(how, segmenter, moves);
}

std::vector<Sweep> good(std::vector<Sweep> strokes, std::size_t target) {
  std::erase_if(strokes, [&](const Sweep& stroke) {
    return stroke.target != target || stroke.defect != SweepDefect::none;
  });
  return strokes;
}

double overlap(const Sweep& a, const Sweep& b) {
  const double both =
      std::min(a.last().time_s, b.last().time_s) - std::max(a.first().time_s, b.first().time_s);
  return both / (b.last().time_s - b.first().time_s);
}

/// From when to when a quiet stroke's target is faster than `speed_mm_s`, over +-0.1 s.
std::array<double, 2> faster_than(double speed_mm_s, const Sweep& stroke, double rate_hz) {
  const auto& samples = *stroke.samples;
  const auto half = static_cast<std::size_t>(0.1 * rate_hz);
  std::array<double, 2> from_to = {stroke.last().time_s, stroke.first().time_s};
  for (std::size_t i = half; i + half < samples.size(); ++i) {
    const Sample &before = samples[i - half], &after = samples[i + half];
    const double way = (after.position_mm - before.position_mm).norm();
    if (way < speed_mm_s * (after.time_s - before.time_s)) continue;
    from_to[0] = std::min(from_to[0], samples[i].time_s);
    from_to[1] = std::max(from_to[1], samples[i].time_s);
  }
  return from_to;
}

/// Each good stroke is one of the quiet stream, whole but for what is slower than the limit.
void check_strokes(const Stream& how) {
  CAPTURE(how.markers, how.noise_mm, how.rate_hz, how.seed);
  Stream without_noise = how;
  without_noise.noise_mm = 0;
  const auto quiet = strokes_of(without_noise);
  PositionSegmenter segmenter;
  const auto noisy = strokes_of(how, segmenter);
  const auto limit = segmenter.limit();
  REQUIRE(limit);
  CHECK(limit->noise_mm == Approx(how.noise_mm).epsilon(0.15));
  for (std::size_t marker = 0; marker < how.markers; ++marker) {
    CAPTURE(marker);
    const auto expected = good(quiet, marker), seen = good(noisy, marker);
    CHECK(seen.size() <= expected.size());
    // Positioning from near home hardly leaves the noise of 1 mm.
    CHECK(seen.size() >= (how.noise_mm < 0.5 ? expected.size() : 6));
    for (const Sweep& stroke : seen) {
      const auto same = std::find_if(expected.begin(), expected.end(),
                                     [&](const Sweep& one) { return overlap(stroke, one) > 0.8; });
      REQUIRE(same != expected.end());
      const auto clearly = faster_than(1.5 * limit->slowest_mm_s, *same, how.rate_hz);
      const double window_s = 0.1 + 1 / how.rate_hz;  // and the sample that it ends with
      CHECK(stroke.first().time_s > same->first().time_s - window_s);
      CHECK(stroke.first().time_s < clearly[0] + window_s);
      CHECK(stroke.last().time_s > clearly[1] - window_s);
      CHECK(stroke.last().time_s < same->last().time_s + window_s);
      CHECK(std::abs(stroke.range_rad - same->range_rad) < 4 * kDegree);
    }
  }
}

}  // namespace

TEST_CASE("noisy strokes are those of a quiet stream: none is made up, cut or joined",
          "[position_segmentation][long]") {
  const auto noise_mm = GENERATE(0.1, 1.0);
  check_strokes({.markers = 1, .noise_mm = noise_mm});
  check_strokes({.markers = 3, .noise_mm = noise_mm});
}

TEST_CASE("noisy strokes are those of a quiet stream, at all rates and sizes",
          "[position_segmentation][long]") {
  const auto markers = GENERATE(std::size_t{1}, std::size_t{3});
  const auto noise_mm = GENERATE(0.05, 0.1, 0.3, 1.0);
  const auto rate_hz = GENERATE(100.0, 240.0);
  for (std::uint32_t seed = 1; seed <= 3; ++seed)
    check_strokes({.markers = markers, .noise_mm = noise_mm, .rate_hz = rate_hz, .seed = seed});
}

TEST_CASE("noise says how slow a motion and how short an arc is still seen",
          "[position_segmentation][long]") {
  PositionSegmenter segmenter;
  CHECK_FALSE(segmenter.limit());
  (void)strokes_of({.noise_mm = 0.3, .rate_hz = 250}, segmenter);
  // 51 positions in 0.2 s: 6 sigma, 0.3 mm sqrt(3) / sqrt(sum of t^2).
  const double slowest = 6 * 0.3 * std::sqrt(3.0) / 0.4204;
  REQUIRE(segmenter.limit());
  CHECK(segmenter.limit()->by_noise());
  CHECK(segmenter.limit()->slowest_mm_s == Approx(slowest).epsilon(0.15));
  CHECK(segmenter.limit()->shortest_mm == Approx(30 * 0.3).epsilon(0.15));
  PositionSegmenter quiet;
  (void)strokes_of({.noise_mm = 0.001}, quiet);
  REQUIRE(quiet.limit());
  CHECK_FALSE(quiet.limit()->by_noise());

  // Joint 1 with 820 mm to the target: half the limit, and twice.
  const auto turning = [&](double speed_mm_s) {
    return [=](test::Campaign& campaign) {
      campaign.rest(2).move(0, 90 + 40, speed_mm_s / 820 / kDegree).rest(2);
    };
  };
  const auto slow = strokes_of({.noise_mm = 0.3, .rate_hz = 250}, turning(slowest / 4));
  CHECK(good(slow, 0).empty());
  const auto fast = strokes_of({.noise_mm = 0.3, .rate_hz = 250}, turning(2 * slowest));
  REQUIRE(good(fast, 0).size() == 1);
  CHECK(good(fast, 0)[0].range_rad > 37 * kDegree);
}

TEST_CASE("a stream of 20 lines a second tells its noise, and what that hides",
          "[position_segmentation]") {
  const auto rate_hz = GENERATE(20.0, 25.0);
  CAPTURE(rate_hz);
  const Stream how{.markers = 1, .noise_mm = 0.3, .rate_hz = rate_hz};
  PositionSegmenter segmenter;
  const auto noisy = strokes_of(how, segmenter);
  REQUIRE(segmenter.limit());
  CHECK(segmenter.limit()->noise_mm == Approx(0.3).epsilon(0.25));
  CHECK(segmenter.limit()->by_noise());
  Stream without_noise = how;
  without_noise.noise_mm = 0;
  const auto quiet = strokes_of(without_noise);
  CHECK(good(noisy, 0).size() == good(quiet, 0).size());
}

TEST_CASE("there and back without a rest is two strokes, in noise as well",
          "[position_segmentation]") {
  const auto strokes = good(strokes_of({.noise_mm = 0.3},
                                       [](test::Campaign& campaign) {
                                         campaign.rest(1).move(0, 90 + 60).move(0, 90 - 30).rest(1);
                                       }),
                            0);
  REQUIRE(strokes.size() == 2);
  CHECK(strokes[0].range_rad == Approx(60 * kDegree).margin(2 * kDegree));
  CHECK(strokes[1].range_rad == Approx(90 * kDegree).margin(2 * kDegree));
}

TEST_CASE("a marker that is not seen for a while cuts no stroke of the others",
          "[position_segmentation]") {
  const auto all = strokes_of({.markers = 2, .noise_mm = 0.1});
  const auto some = strokes_of({.markers = 2, .noise_mm = 0.1, .lost_from_s = 4, .lost_to_s = 20});
  REQUIRE(good(some, 0).size() == good(all, 0).size());
  for (std::size_t k = 0; k < good(all, 0).size(); ++k)
    CHECK(overlap(good(some, 0)[k], good(all, 0)[k]) > 0.97);
  CHECK(good(some, 1).size() < good(all, 1).size());
}

TEST_CASE("a position far off for one frame moves nothing and cuts no stroke",
          "[position_segmentation]") {
  const auto clean = good(strokes_of({.noise_mm = 0.05}), 0);
  const auto strays = good(strokes_of({.noise_mm = 0.05, .stray_every = 97}), 0);
  REQUIRE(strays.size() == clean.size());
  for (std::size_t k = 0; k < clean.size(); ++k) CHECK(overlap(strays[k], clean[k]) > 0.97);
}

TEST_CASE("markers that are taken for each other for some frames cut no stroke",
          "[position_segmentation]") {
  const double noise_mm = GENERATE(0.05, 0.3);
  const auto clean = strokes_of({.markers = 3, .noise_mm = noise_mm});
  const auto swapped = strokes_of({.markers = 3, .noise_mm = noise_mm, .swap_every = 150});
  for (const std::size_t marker : {0U, 1U, 2U}) {
    const auto there = good(clean, marker), found = good(swapped, marker);
    REQUIRE(found.size() == there.size());
    for (std::size_t k = 0; k < there.size(); ++k) CHECK(overlap(found[k], there[k]) > 0.97);
  }
}

TEST_CASE("points that come as fast as never are segmented in time by their number",
          "[position_segmentation][long]") {
  const auto took = [](double step_s, std::size_t strokes) {
    auto best = std::chrono::nanoseconds::max();
    for (int round = 0; round < 2; ++round) {
      PositionSegmenter segmenter;
      std::vector<Sweep> found;
      const auto take = [&](std::vector<Sweep> ended) {
        std::move(ended.begin(), ended.end(), std::back_inserter(found));
      };
      const auto start = std::chrono::steady_clock::now();
      for (int i = 0; i < 15'000; ++i) {
        Sample sample;
        sample.time_s = i * step_s;
        const double turn = 90 * kDegree * i / 15'000;
        sample.position_mm = {400 * std::cos(turn), 400 * std::sin(turn), 70};
        sample.has_position = true;
        take(segmenter.push({{0, sample}}));
      }
      take(segmenter.finish());
      best = std::min<std::chrono::nanoseconds>(best, std::chrono::steady_clock::now() - start);
      CHECK(found.size() == strokes);
      // What a parabola leaves of a window that holds all of the arc is taken for noise, which cuts
      // off its ends.
      if (!found.empty()) CHECK(found.front().range_rad == Approx(90 * kDegree).epsilon(0.05));
    }
    return best;
  };
  // A window of 250 Hz has 51 pictures. To look at all 15,000 for each takes 300 times as long.
  CHECK(took(20e-3 / 15'000, 1) < 60 * took(4e-3, 1));
}

namespace {

/// A hundred samples a stroke, through these angles, with so much noise.
std::vector<Sample> along(const std::vector<double>& corners_deg, double noise_mm) {
  std::mt19937 random(3);
  std::normal_distribution<> normal(0, noise_mm);
  std::vector<Sample> samples;
  for (std::size_t k = 1; k < corners_deg.size(); ++k)
    for (int i = 0; i < 100; ++i) {
      const double turn =
          kDegree * (corners_deg[k - 1] + (corners_deg[k] - corners_deg[k - 1]) * i / 100);
      Sample sample;
      sample.position_mm = {400 * std::cos(turn) + normal(random),
                            400 * std::sin(turn) + normal(random), 70 + normal(random)};
      sample.has_position = true;
      samples.push_back(sample);
    }
  return samples;
}

/// An arc of the circle that passes the origin, where the turn is zero.
Sweep arc_of(double radius_mm, double from_deg, double to_deg, double begin_s, double noise_mm,
             std::mt19937& random) {
  std::normal_distribution<double> noise(0, noise_mm);
  std::vector<Sample> samples;
  for (int i = 0; i < 200; ++i) {
    const double turn = (from_deg + (to_deg - from_deg) * i / 199) * kDegree;
    Sample sample;
    sample.time_s = begin_s + i * 0.01;
    sample.has_position = true;
    sample.position_mm = Eigen::Vector3d(radius_mm * (std::cos(turn) - 1) + noise(random),
                                         radius_mm * std::sin(turn) + noise(random), noise(random));
    samples.push_back(sample);
  }
  Sweep sweep;
  sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
  return sweep;
}

}  // namespace

TEST_CASE("a short arc beside long ones of another circle is another turn",
          "[position_segmentation]") {
  // A marker near an axis: 40 degrees of a circle of 40 mm. It begins where the long arcs, of 668
  // mm, pass home, and goes the same way.
  std::mt19937 random(1);
  const auto arc = [&](double radius_mm, double from_deg, double to_deg, double begin_s) {
    return arc_of(radius_mm, from_deg, to_deg, begin_s, 0.3, random);
  };
  std::vector<Sweep> strokes{arc(668, 0, -27, 0), arc(668, -27, 13, 3), arc(668, 13, 0, 6),
                             arc(-40, -20, 20, 9)};
  CHECK(turns_in(strokes, {0, 1, 2, 3}, 7).size() == 2);
  strokes.back() = arc(668, 0, 2.5, 9);
  CHECK(turns_in(strokes, {0, 1, 2, 3}, 7).size() == 1);
}

TEST_CASE("strokes of a long arm that came home badly are of one turn", "[position_segmentation]") {
  std::mt19937 random(1);
  const auto arc = [&](double radius_mm, double from_deg, double to_deg, double begin_s,
                       double off_mm) {
    Sweep sweep = arc_of(radius_mm, from_deg, to_deg, begin_s, 0.01, random);
    auto samples = *sweep.samples;
    for (Sample& sample : samples) sample.position_mm += off_mm * Eigen::Vector3d(1, 0, 1);
    sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
    return sweep;
  };
  const auto turns = [&](double radius_mm, double most_deg, double off_mm) {
    const std::vector<Sweep> strokes{arc(2000, 0, 90, 0, 0), arc(2000, 90, 0, 3, off_mm),
                                     arc(1000, 0, -90, 6, 0), arc(1000, -90, 0, 9, -off_mm),
                                     arc(radius_mm, 0, most_deg, 12, off_mm)};
    return turns_in(strokes, {0, 1, 2, 3, 4}, 3).size();
  };
  CHECK(turns(-800, 90, 0.3) == 3);
  // Joints that go the same way from home about parallel axes are two.
  CHECK(turns(900, -90, 0.3) == 3);
  CHECK(turns(900, -20, 0.3) == 3);
  CHECK(turns(980, -20, 0.05) == 3);
  // What is centimetres off is no joint that came home badly.
  CHECK(turns(-800, 90, 30) > 3);
}

TEST_CASE("Each turn of the motion is found, where it is and no other", "[position_segmentation]") {
  for (const double noise_mm : {0.0, 0.02, 1.0}) {
    CAPTURE(noise_mm);
    CHECK(turning_points(along({0, 60}, noise_mm)).empty());
    const auto found = turning_points(along({-50, 40, -50, 10}, noise_mm));
    REQUIRE(found.size() == 2);
    CHECK(std::abs(static_cast<int>(found[0]) - 100) < 8);
    CHECK(std::abs(static_cast<int>(found[1]) - 200) < 8);
  }
  // A sway of a degree is none; half of a circle each way is two strokes.
  CHECK(turning_points(along({0, 30, 29, 60}, 0.02)).empty());
  CHECK(turning_points(along({-90, 90, -90}, 0.02)).size() == 1);
}

TEST_CASE("Strokes whose way back was not recorded are apart", "[position_segmentation]") {
  for (const double most_deg : {30.0, 90.0, 170.0, 270.0}) {
    CAPTURE(most_deg);
    const auto once = along({0, most_deg}, 0.02);
    std::vector<Sample> samples;
    for (int stroke = 0; stroke < 3; ++stroke)
      samples.insert(samples.end(), once.begin(), once.end());
    CHECK(turning_points(samples) == std::vector<std::size_t>{100, 200});
  }
  // A line of sight that was interrupted for a while: one stroke.
  auto samples = along({0, 90}, 0.02);
  samples.erase(samples.begin() + 40, samples.begin() + 70);
  CHECK(turning_points(samples).empty());
}

TEST_CASE("A turn is between the last sample there and the first one back",
          "[position_segmentation]") {
  std::mt19937 random(7);
  for (const double noise_mm : {0.0, 0.02}) {
    CAPTURE(noise_mm);
    std::normal_distribution<> noise(0, noise_mm > 0 ? noise_mm : 1);
    std::vector<Sample> samples;
    for (int i = 0; i < 180; ++i) {  // soft at its ends, and twice at the turn
      const double share = (i < 90 ? i : 179 - i) / 89.0;
      const double angle = 90 * kDegree * (0.5 - 0.5 * std::cos(kPi * share));
      Sample sample;
      sample.has_position = true;
      sample.position_mm = {600 * std::cos(angle), 600 * std::sin(angle), 0};
      if (noise_mm > 0)
        for (double& number : sample.position_mm) number += noise(random);
      samples.push_back(sample);
    }
    REQUIRE(turning_points(samples).size() == 1);
    CHECK(turning_points(samples)[0] == 90);
  }
}

TEST_CASE("A linear joint turns round, too", "[position_segmentation]") {
  std::mt19937 random(5);
  std::normal_distribution<> noise(0, 0.02);
  const Eigen::Vector3d way = Eigen::Vector3d(1, 2, 3).normalized();
  for (const double length_mm : {8.0, 200.0, 800.0, 6000.0}) {
    CAPTURE(length_mm);
    std::vector<Sample> samples;
    for (int i = 0; i <= 200; ++i) {
      Sample sample;
      sample.has_position = true;
      const Eigen::Vector3d off(noise(random), noise(random), noise(random));
      sample.position_mm = length_mm * (i <= 100 ? i : 200 - i) / 100 * way + off;
      samples.push_back(sample);
    }
    const auto turns = turning_points(samples);
    REQUIRE(turns.size() == 1);
    CHECK(std::abs(static_cast<int>(turns[0]) - 100) < 8);
    samples.resize(101);
    CHECK(turning_points(samples).empty());
    for (Sample& sample : samples) sample.position_mm *= 1e-3;  // stands still, nearly
    if (length_mm < 1000) CHECK(turning_points(samples).empty());
  }
}

TEST_CASE("A point far off is no turn", "[position_segmentation]") {
  auto samples = along({-50, 40, -50}, 0.02);
  const auto turns = turning_points(samples);
  REQUIRE(turns.size() == 1);
  for (const auto& off : {Eigen::Vector3d(130, 0, 0), {0, -130, 40}, {900, 0, -2000}})
    for (const std::size_t at : {std::size_t{30}, std::size_t{61}, samples.size() - 4}) {
      auto strayed = samples;
      strayed[at].position_mm += off;
      CHECK(turning_points(strayed) == turns);
    }
}

TEST_CASE("Points in no order, and on no circle, have no turns", "[position_segmentation]") {
  auto samples = along({0, 90}, 0.02);
  std::shuffle(samples.begin(), samples.end(), std::mt19937(5));
  CHECK(turning_points(samples).empty());
  for (Sample& sample : samples) sample.position_mm = {1, 2, 3};
  CHECK(turning_points(samples).empty());
  CHECK(turning_points({}).empty());
}
