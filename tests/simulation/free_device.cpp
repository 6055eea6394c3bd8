#include "tests/simulation/free_device.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "identify/geometry/angle.hpp"
#include "tests/simulation/device.hpp"
#include "tests/simulation/printed.hpp"
#include "tests/simulation/stream.hpp"

namespace simulation {

using identify::kDegree;

namespace {

/// Where joints are that follow their motors through their play.
class Playing {
 public:
  Playing(const FreeDevice& how, const identify::JointAngles& begin, std::size_t joints,
          std::uint32_t seed)
      : half_rad_(joints, 0.0), behind_(begin) {
    auto random = stream(seed, Source::gears);
    std::bernoulli_distribution above;
    for (std::size_t j = 0; j < joints; ++j) {
      if (j == how.plays.value_or(j)) half_rad_[j] = how.play_arcsec / 2 * identify::kArcsec;
      behind_[j] += above(random) ? half_rad_[j] : -half_rad_[j];
    }
  }

  /// The motors have gone straight from where they were to here.
  const identify::JointAngles& moved_to(const identify::JointAngles& motors) {
    for (std::size_t j = 0; j < half_rad_.size(); ++j)
      behind_[j] = std::clamp(behind_[j], motors[j] - half_rad_[j], motors[j] + half_rad_[j]);
    return behind_;
  }

 private:
  std::vector<double> half_rad_;  ///< of the play, one a joint
  identify::JointAngles behind_;
};

}  // namespace

TwoViews two_views(const Robot& robot, const Program& program, const FreeDevice& how,
                   std::uint32_t seed, const Telling& telling) {
  const std::size_t joints = robot.arm.joints();
  const auto chain = chain_of(robot);
  const Eigen::Isometry3d base = random_place(seed);
  TwoViews views{identify::AngleTape(joints), {}};

  auto wobble = stream(seed, Source::wobble);
  std::normal_distribution<> normal;
  const auto cycles = static_cast<int>(program.seconds() / telling.cycle_s);
  for (int i = 0; i <= cycles; ++i) {
    identify::Sample sample;
    sample.time_s = telling.cycle_s * i;
    sample.joints = static_cast<std::uint8_t>(joints);
    sample.angles_rad = program.angles_rad(sample.time_s);
    for (std::size_t j = 0; j < joints; ++j)
      sample.angles_rad[j] =
          printed(sample.angles_rad[j] / kDegree + telling.wobble_deg * normal(wobble),
                  telling.decimals) *
          kDegree;
    views.tape.add(sample);
  }

  Playing arm(how, program.angles_rad(0), joints, seed);
  Device device(how.noise, how.drift, program.seconds(), seed);
  auto random = stream(seed, Source::clock);
  std::uniform_real_distribution<> uniform(0, 1);
  const double begin_s = uniform(random) / how.rate_hz;
  for (int i = 0;; ++i) {
    const double at = begin_s + i / how.rate_hz;
    if (at > program.seconds()) break;
    const double off = how.jitter_s * (2 * uniform(random) - 1);
    const bool lost = uniform(random) < how.loss;
    const auto& angles = arm.moved_to(program.angles_rad(at));
    identify::Turns turns{};
    for (std::size_t j = 0; j < joints; ++j) turns[j] = angles[j] - robot.arm.home_rad[j];
    for (std::size_t t = 0; t < robot.targets_mm.size(); ++t) {
      identify::Measured point;
      point.target = t;
      point.sample.has_position = true;
      point.sample.position_mm = device.measured(base * chain.target_mm(t, turns), at);
      point.sample.time_s = at + how.ahead_s + off +
                            1e-6 * how.rate_ppm * (at - program.seconds() / 2) +
                            (how.step_s != 0 && at > how.step_at_s ? how.step_s : 0);
      if (how.stamp_step_s > 0)
        point.sample.time_s = std::round(point.sample.time_s / how.stamp_step_s) * how.stamp_step_s;
      const bool in_gap = std::any_of(how.gaps.begin(), how.gaps.end(), [&](const auto& gap) {
        return at >= gap.begin_s && at <= gap.end_s;
      });
      if (!lost && !in_gap) views.points.push_back(point);
    }
  }
  return views;
}

}  // namespace simulation
