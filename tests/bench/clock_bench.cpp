// Device and controller with a clock each: how well offset, drift and geometry are found, and
// whether perfect gears are accused, or those that play are found and the table's uncertainties
// hold. Arguments: takes, rounds of sweeps, jitter and step of the stamps in microseconds, play in
// arcsec, the joint that alone plays (0: all).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "identify/clock/joined_take.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"
#include "tests/simulation/device.hpp"
#include "tests/simulation/free_device.hpp"
#include "tests/simulation/truth.hpp"

namespace {

using namespace simulation;
using identify::kDegree;

struct Seen {
  double off_ms = 0;  ///< error of the offset in the middle of the program
  double sigma_ms = 0;
  double rate_ppm = 0;  ///< error
  double rate_sigma_ppm = 0;
  double geometry_mm = 0;
  std::size_t poses = 0;
  bool accused = false;
  std::vector<double> errors;  ///< of the table, in standard uncertainties
  std::string trouble;
};

Program campaign_of(const Robot& robot, int rounds, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<> more(0, 0.4);
  Program program(robot.arm.home_rad);
  program.rest(2);
  for (int round = 0; round < rounds; ++round)
    for (std::size_t j = 0; j < robot.arm.joints(); ++j)
      program.sweep(j, 40 + 5 * static_cast<double>(j % 3), 20, 0.35 + more(random)).rest(0.3);
  return program.rest(2);
}

/// How far predicted positions of the target are off, over poses all round home.
double geometry_error(const identify::Identification& found, const Robot& robot,
                      std::uint32_t seed) {
  if (!found.chain) return -1;
  const auto chain = chain_of(robot);
  const auto base = random_place(seed);
  std::mt19937 random(5);
  std::uniform_real_distribution<> range(-60 * kDegree, 60 * kDegree);
  double squares = 0;
  constexpr int kPoses = 200;
  for (int i = 0; i < kPoses; ++i) {
    identify::Turns turns{}, from_found{};
    for (std::size_t j = 0; j < robot.arm.joints(); ++j) {
      turns[j] = range(random);
      from_found[j] = turns[j] + robot.arm.home_rad[j] - *found.home_rad[j];
    }
    squares += (found.chain->chain.target_mm(0, from_found) - base * chain.target_mm(0, turns))
                   .squaredNorm();
  }
  return std::sqrt(squares / kPoses);
}

Seen run(const Robot& robot, const Program& program, const FreeDevice& device, std::uint32_t seed) {
  const auto views = two_views(robot, program, device, seed);
  identify::Campaign campaign;
  campaign.joints = robot.arm.joints();
  campaign.specified = robot.specified;
  campaign.resolution.angle_rad = 1e-4 * kDegree;
  campaign.device_frame = true;
  campaign.two_clocks = true;
  const auto take = identify::joined(views.tape, views.points, campaign);
  Seen seen;
  seen.trouble = take.problem;
  if (!take.problem.empty()) return seen;
  campaign.resolution.time_s = take.stamp_step_s;
  const auto found = identify::identify(take.sweeps, campaign, take.poses);
  seen.poses = take.poses.size();
  seen.accused = std::any_of(found.warnings.begin(), found.warnings.end(), [](const auto& warning) {
    return warning.code == "backlash" || warning.code == "transmission_error";
  });
  World world;
  world.placed = true;
  seen.errors = errors_in_sigmas(Simulation(robot, {}, world, seed), found);
  const auto clock = identify::refined(take.clock, found.delay);
  const double middle = program.seconds() / 2;
  seen.off_ms = 1e3 * (clock.ahead_s + clock.rate * (middle - clock.at_s) - device.ahead_s);
  seen.sigma_ms = 1e3 * clock.sigma_s;
  seen.rate_ppm = 1e6 * clock.rate - device.rate_ppm;
  seen.rate_sigma_ppm = 1e6 * clock.rate_sigma;
  seen.geometry_mm = geometry_error(found, robot, seed);
  seen.trouble = found.reason;
  return seen;
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 40;
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 2;
  const int jitter_us = argc > 3 ? std::atoi(argv[3]) : 5000;
  const int step_us = argc > 4 ? std::atoi(argv[4]) : 0;
  const int play_arcsec = argc > 5 ? std::atoi(argv[5]) : 0;
  const int joint = argc > 6 ? std::atoi(argv[6]) : 0;
  std::vector<double> errors;
  double off2 = 0, z2 = 0, rate2 = 0, geometry2 = 0, plain2 = 0;
  int within = 0, within_tenth = 0, rate_within = 0, accused = 0, done = 0;
  for (int s = 1; s <= seeds; ++s) {
    const auto seed = static_cast<std::uint32_t>(s);
    std::mt19937 random(seed);
    std::uniform_real_distribution<> uniform(0, 1);
    const Robot robot = built(kr5(), seed);
    const Program program = campaign_of(robot, rounds, seed);
    FreeDevice device;
    device.ahead_s = s % 4 == 0 ? 3600 * (uniform(random) - 0.5) : 0.5 * uniform(random);
    device.rate_ppm = 100 * (uniform(random) - 0.5);
    device.jitter_s = 1e-6 * jitter_us;
    device.stamp_step_s = 1e-6 * step_us;
    device.loss = 0.02;
    device.gaps = {{20, 20.4}, {41, 43}};
    device.play_arcsec = play_arcsec;
    if (joint > 0) device.plays = static_cast<std::size_t>(joint - 1);
    FreeDevice plain = device;
    plain.ahead_s = plain.rate_ppm = 0;
    const auto begin = std::chrono::steady_clock::now();
    const Seen seen = run(robot, program, device, seed);
    const double took =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const Seen without = run(robot, program, plain, seed);
    std::printf(
        "%3d off %8.4f +- %.4f ms  rate %7.2f +- %.2f ppm  poses %zu  geometry %.4f / %.4f mm  "
        "%.2f s %s\n",
        s, seen.off_ms, seen.sigma_ms, seen.rate_ppm, seen.rate_sigma_ppm, seen.poses,
        seen.geometry_mm, without.geometry_mm, took, seen.trouble.c_str());
    if (seen.geometry_mm <= 0) continue;
    ++done;
    for (const double error : seen.errors) errors.push_back(std::abs(error));
    accused += seen.accused;
    off2 += seen.off_ms * seen.off_ms;
    z2 += std::pow(seen.off_ms / seen.sigma_ms, 2);
    rate2 += std::pow(seen.rate_ppm / seen.rate_sigma_ppm, 2);
    within += std::abs(seen.off_ms) < 2 * seen.sigma_ms;
    within_tenth += std::abs(seen.off_ms) < 0.1;
    rate_within += std::abs(seen.rate_ppm) < 2 * seen.rate_sigma_ppm;
    geometry2 += seen.geometry_mm * seen.geometry_mm;
    plain2 += without.geometry_mm * without.geometry_mm;
  }
  std::printf(
      "%d of %d: offset rms %.4f ms, z %.2f, within 2 sigma %d, within 0.1 ms %d; rate z %.2f, "
      "within 2 sigma %d; geometry %.4f against %.4f mm: %.3f; gears accused %d\n",
      done, seeds, std::sqrt(off2 / done), std::sqrt(z2 / done), within, within_tenth,
      std::sqrt(rate2 / done), rate_within, std::sqrt(geometry2 / done), std::sqrt(plain2 / done),
      std::sqrt(geometry2 / plain2), accused);
  const auto inside =
      std::count_if(errors.begin(), errors.end(), [](double error) { return error < 1.96; });
  if (!errors.empty())
    std::printf("table: %.1f %% of %zu numbers inside, at most %.1f sigma\n",
                100.0 * static_cast<double>(inside) / static_cast<double>(errors.size()),
                errors.size(), *std::max_element(errors.begin(), errors.end()));
}
