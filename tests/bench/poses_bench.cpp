// What static poses tell of arms that are known exactly: errors against the Cramer-Rao bound and
// the stated uncertainties, effects of joints that are found or invented, and how long it takes.
// Fixed seeds; figures, not a test.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <iostream>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"
#include "identify/poses/pose_outlook.hpp"
#include "tests/bench/coverage_cases.hpp"
#include "tests/bench/table.hpp"
#include "tests/simulation/truth.hpp"

using bench::left;
using bench::right;
using identify::Identification;
using identify::JointEffect;
using identify::kArcsec;
using identify::kDegree;
using identify::Knowledge;
using simulation::Simulation;
using simulation::World;
using sweepd::fixed;

namespace {

struct Options {
  int runs = 200;
  std::size_t poses = 40;
  double noise_mm = 0.02;
  double joint_deg = 0.002;
  double gears_arcsec = 0;
  unsigned threads = 0;
  std::vector<std::string> arms = {"kr5", "iiwa"};
  bool details = false;
};

World tracker(const Options& options, std::uint32_t seed) {
  World world;
  world.angles = world.placed = true;
  world.noise.range_mm = world.noise.across_mm = options.noise_mm;
  world.home.sigma_deg = seed % 2 == 0 ? options.joint_deg : 0;
  world.gears.first_arcsec = world.gears.second_arcsec = options.gears_arcsec;
  return world;
}

Simulation arm_of(const Options& options, const std::string& arm, std::uint32_t seed,
                  const std::function<void(World&)>& change = {}) {
  World world = tracker(options, seed);
  if (change) change(world);
  return {coverage::robot_of(arm, 1, seed), simulation::Strokes(), world, seed};
}

void run_all(const Options& options, const std::function<void(std::uint32_t)>& run) {
  std::atomic<std::uint32_t> next{1};
  std::vector<std::thread> threads;
  const unsigned count =
      options.threads > 0 ? options.threads : std::thread::hardware_concurrency();
  for (unsigned t = 0; t < std::max(1U, count); ++t)
    threads.emplace_back([&] {
      for (std::uint32_t seed; (seed = next++) <= static_cast<std::uint32_t>(options.runs);)
        run(seed);
    });
  for (std::thread& thread : threads) thread.join();
}

/// Errors of one number over all runs.
struct Score {
  int count = 0, inside = 0;
  double errors = 0, stated = 0, bound = 0, normalised = 0;

  void add(double error, double sigma, double least) {
    ++count;
    if (std::abs(error) < 1.959964 * sigma) ++inside;
    errors += error * error;
    stated += sigma * sigma;
    bound += least * least;
    normalised += error * error / (sigma * sigma);
  }
  void add(const Score& other) {
    count += other.count;
    inside += other.inside;
    normalised += other.normalised;
  }
  [[nodiscard]] double by_bound() const { return std::sqrt(errors / bound); }
  [[nodiscard]] double by_stated() const { return std::sqrt(normalised / count); }
  [[nodiscard]] double covered() const { return 100.0 * inside / count; }
};

void score(const Simulation& of, const Identification& found, const Options& options,
           std::uint32_t seed, const std::vector<identify::Pose>& poses,
           std::map<std::string, Score>& scores, std::mutex& mutex) {
  identify::Campaign truth = of.campaign();
  truth.specified = of.robot().arm;
  truth.specified->tool_mm = of.robot().targets_mm.front();
  const World world = tracker(options, seed);
  const identify::PoseForecast forecast(truth, {.position_mm = world.noise.range_mm,
                                                .orientation_rad = 0,
                                                .joint_rad = world.home.sigma_deg * kDegree});
  std::vector<identify::PoseRow> rows;
  for (const auto& pose : poses)
    rows.push_back(forecast.row(
        {pose.sample.angles_rad.begin(), pose.sample.angles_rad.begin() + pose.sample.joints}));
  const auto bound = forecast.outlook(rows, {});
  const auto table = simulation::true_table(of, found.dh, found.home_rad);
  const std::lock_guard lock(mutex);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::array<double, 5> values{table[i].b_mm, table[i].theta_rad, table[i].a_mm,
                                       table[i].alpha_rad, table[i].beta_rad};
    const auto numbers = numbers_of(found.dh[i]), least = numbers_of(bound.dh[i]);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (numbers[k]->knowledge != Knowledge::identified ||
          least[k]->knowledge != Knowledge::identified)
        continue;
      double error = numbers[k]->value - values[k];
      if (k == 1 || k > 2) error = std::remainder(error, 2 * identify::kPi);
      static constexpr std::array kNames = {"b", "theta", "a", "alpha", "beta"};
      scores[kNames.at(k) + std::to_string(i + 1)].add(error, numbers[k]->sigma, least[k]->sigma);
    }
  }
}

void print_accuracy(const Options& options, const std::string& arm) {
  std::map<std::string, Score> scores;
  std::mutex mutex;
  std::atomic<int> complete{0}, invented{0};
  run_all(options, [&](std::uint32_t seed) {
    const Simulation of = arm_of(options, arm, seed);
    auto campaign = of.campaign();
    campaign.loads = of.loads();
    const auto poses = of.poses(options.poses);
    const Identification found = identify::identify({}, campaign, poses);
    if (found.status == identify::Status::complete) ++complete;
    if (options.gears_arcsec == 0 && found.poses && !found.poses->effects.empty()) {
      ++invented;
      return;  // counted there; its numbers are those of another model
    }
    score(of, found, options, seed, poses, scores, mutex);
  });
  Score all;
  std::vector<std::pair<double, std::string>> by_bound, by_stated;
  for (const auto& [name, one] : scores) {
    all.add(one);
    by_bound.emplace_back(one.by_bound(), name);
    by_stated.emplace_back(one.by_stated(), name);
    if (options.details)
      std::cout << left("  " + name, 10) << right(one.covered(), 1, 8)
                << right(one.by_bound(), 3, 8) << right(one.by_stated(), 3, 8)
                << right(std::to_string(one.count), 7) << '\n';
  }
  std::sort(by_bound.begin(), by_bound.end());
  std::sort(by_stated.begin(), by_stated.end());
  std::cout << left(arm, 6) << right(std::to_string(options.runs), 6)
            << right(std::to_string(complete), 10) << right(std::to_string(invented), 10)
            << right(all.covered(), 1, 10) << right(all.by_stated(), 3, 9)
            << right(by_stated.back().first, 3, 8) << ' ' << left(by_stated.back().second, 7)
            << right(by_bound[by_bound.size() / 2].first, 3, 9)
            << right(by_bound.back().first, 3, 8) << ' ' << by_bound.back().second << std::endl;
}

bool has(const Identification& found, std::size_t joint, JointEffect::Kind kind) {
  return found.poses && std::any_of(found.poses->effects.begin(), found.poses->effects.end(),
                                    [&](const identify::EffectEvidence& one) {
                                      return one.effect.joint == joint && one.effect.kind == kind;
                                    });
}

/// How often an effect is found, and how many others beside it.
void print_found(const Options& options, const std::string& arm, const std::string& what,
                 std::size_t joint, JointEffect::Kind kind,
                 const std::function<void(World&, const Simulation&)>& change) {
  std::atomic<int> found{0}, others{0};
  run_all(options, [&](std::uint32_t seed) {
    const Simulation of = arm_of(options, arm, seed,
                                 [&](World& world) { change(world, arm_of(options, arm, seed)); });
    auto campaign = of.campaign();
    campaign.loads = of.loads();
    const Identification result = identify::identify({}, campaign, of.poses(3 * options.poses));
    if (has(result, joint, kind)) ++found;
    const auto& bent = of.robot().elastic;
    const auto expected = [&](const identify::EffectEvidence& one) {
      if (one.effect.kind != kind) return false;
      return one.effect.joint == joint ||
             (kind == JointEffect::Kind::compliance &&
              std::find(bent.begin(), bent.end(), one.effect.joint) != bent.end());
    };
    if (result.poses &&
        !std::all_of(result.poses->effects.begin(), result.poses->effects.end(), expected))
      ++others;
  });
  const auto percent = [&](int count) { return 100.0 * count / options.runs; };
  std::cout << left(arm, 6) << left(what, 44) << right(percent(found), 1, 8)
            << right(percent(others), 1, 14) << std::endl;
}

void print_time(const Options& options) {
  const Simulation of = arm_of(options, "kr5", 1);
  const auto poses = of.poses(1000);
  double best = 1e9;
  for (int round = 0; round < 5; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    static_cast<void>(identify::identify({}, of.campaign(), poses));
    best = std::min(
        best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  std::cout << "1,000 poses of a kr5: " << fixed(best, 3) << " s, the best of five" << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Static poses of simulated arms", "bench_poses");
  Options options;
  app.add_option("--runs", options.runs, "Arms of each kind")
      ->check(CLI::Range(2, 100000))
      ->capture_default_str();
  app.add_option("--poses", options.poses, "Poses of each; three times as many for effects")
      ->check(CLI::Range(12, 2000))
      ->capture_default_str();
  app.add_option("--arm", options.arms, "Arms")
      ->expected(-1)
      ->check(CLI::IsMember(coverage::all_arms()));
  app.add_option("--noise-mm", options.noise_mm, "Of each coordinate")->capture_default_str();
  app.add_option("--joint-deg", options.joint_deg, "Of each joint, in every other arm")
      ->capture_default_str();
  app.add_option("--gears-arcsec", options.gears_arcsec,
                 "Every joint's gear errs by so much once and twice a turn: accuracy alone")
      ->capture_default_str();
  app.add_option("--threads", options.threads, "0: as many as there are cores")
      ->capture_default_str();
  app.add_flag("--details", options.details, "Each number");
  CLI11_PARSE(app, argc, argv);

  std::cout << options.poses << " poses at random, a tracker of " << options.noise_mm
            << " mm, joints off by " << options.joint_deg << " deg in every other arm\n"
            << left("arm", 6) << right("runs", 6) << right("complete", 10) << right("invented", 10)
            << right("inside %", 10) << right("rms z", 9) << right("worst", 8) << left(" ", 8)
            << right("by bound", 9) << right("worst", 8) << '\n';
  for (const std::string& arm : options.arms) print_accuracy(options, arm);
  if (options.gears_arcsec > 0) return 0;
  std::cout << '\n'
            << 3 * options.poses << " poses\n"
            << left("arm", 6) << left("effect", 44) << right("found %", 8)
            << right("others too %", 14) << '\n';
  for (const std::string& arm : options.arms) {
    print_found(options, arm, "50 arcsec once a turn, joint 2", 1, JointEffect::Kind::once,
                [](World& world, const Simulation&) {
                  world.gears.joint = 1;
                  world.gears.first_arcsec = 50;
                });
    print_found(options, arm, "20 urad/Nm of the joints that bend, joint 2", 1,
                JointEffect::Kind::compliance, [](World& world, const Simulation& of) {
                  const simulation::Sag sag(of.robot(), kArcsec);
                  identify::Turns out{};
                  out[1] = 1;
                  world.sag_arcsec = 20e-6 / (sag.at(out)[1] / sag.torques(out)[1]);
                });
  }
  print_time(options);
}
