#include "tests/simulation/strokes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "identify/geometry/angle.hpp"
#include "tests/simulation/stream.hpp"

namespace simulation {
namespace {

using identify::kDegree;

}  // namespace

double Stroke::turn_at(double time_s, double ramp) const {
  double share = time_s / seconds;
  if (ramp > 0) {
    // A trapezoid of speed: its plateau is 1 / (1 - ramp) of the mean.
    const double x = std::clamp(share, 0.0, 1.0);
    const double end = std::min(x, 1 - x);
    const double gone = end < ramp ? end * end / (2 * ramp) : end - ramp / 2;
    share = (x < 0.5 ? gone : 1 - ramp - gone) / (1 - ramp);
  }
  return from_rad + share * (to_rad - from_rad);
}

std::vector<Stroke> strokes_of(const Strokes& how, std::size_t joints, std::size_t targets) {
  std::vector<Stroke> strokes;
  double time = 0;
  const auto add = [&](std::size_t home, std::vector<std::size_t> seen, std::size_t joint,
                       bool back) {
    Stroke stroke{joint, home, std::move(seen), 0, 0, time, 0, false};
    const double half = (joint % 2 == 0 ? 0.5 : -0.5) * how.arc_deg;
    const auto [from, to] = how.ranges_deg.empty()
                                ? std::array<double, 2>{-half, half}
                                : how.ranges_deg[(home * joints + joint) % how.ranges_deg.size()];
    stroke.from_rad = (back ? to : from) * kDegree;
    stroke.to_rad = (back ? from : to) * kDegree;
    const double times = how.times_as_fast.empty() ? 1 : how.times_as_fast[joint];
    stroke.seconds = std::abs(to - from) / (times * how.speed_deg_s);
    time += stroke.seconds + how.rest_s;
    strokes.push_back(std::move(stroke));
  };
  std::vector<std::vector<std::size_t>> seen;
  for (std::size_t t = 0; t < targets; ++t) seen.push_back({t});
  if (how.targets_at_once) {
    seen.assign(1, std::vector<std::size_t>(targets));
    std::iota(seen[0].begin(), seen[0].end(), 0U);
  }
  for (std::size_t home = 0; home < static_cast<std::size_t>(how.homes); ++home)
    for (int round = 0; round < how.rounds; ++round)
      for (const auto& of_stroke : seen)
        for (std::size_t joint = 0; joint < joints; ++joint) {
          for (int repeat = 0; repeat < how.repeats; ++repeat) {
            add(home, of_stroke, joint, false);
            if (how.there_and_back) add(home, of_stroke, joint, true);
          }
          strokes.back().last_of_joint = true;
        }
  return strokes;
}

std::vector<std::vector<double>> homes_of(const Strokes& how, const Robot& robot,
                                          std::uint32_t seed) {
  std::vector<std::vector<double>> homes = {robot.arm.home_rad};
  auto random = stream(seed, Source::homes);
  std::uniform_real_distribution<> off(-30 * kDegree, 30 * kDegree);
  while (homes.size() < static_cast<std::size_t>(how.homes)) {
    std::vector<double> home = robot.arm.home_rad;
    for (double& angle : home) {
      double by = 0;
      while (std::abs(by) < 15 * kDegree) by = off(random);
      angle += by;
    }
    if (fit_for_sweeps(chain_of(at_home(robot, home)))) homes.push_back(home);
  }
  return homes;
}

}  // namespace simulation
