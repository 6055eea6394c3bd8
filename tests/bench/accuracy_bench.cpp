// How accurate the engine is: errors of simulated campaigns against the Cramér-Rao bound, against
// the paper's circles, and against the stated uncertainties. Fixed seeds; figures, not a test.

#include <algorithm>
#include <atomic>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/numbers.hpp"
#include "identify/identification.hpp"
#include "tests/bench/accuracy_campaign.hpp"
#include "tests/identify/simulated_campaign.hpp"

using namespace accuracy;
using identify::DhEstimate;
using identify::DhNumber;
using identify::Knowledge;
using sweepd::fixed;

namespace {

Simulated kr5(int arc_deg, std::size_t targets = 1) {
  Simulated robot;
  robot.arm = identify::test::kr5_arc();
  robot.targets_mm = {{200, 0, 215}, {-60, 160, 120}};
  robot.targets_mm.resize(targets);
  if (arc_deg == 90)
    robot.ranges = {{-45, 45}, {-60, -130}, {120, 30}, {90, 0}, {90, 0}, {0, 90}};
  else if (arc_deg == 30)
    robot.ranges = {{-15, 15}, {-60, -90}, {120, 90}, {90, 60}, {90, 60}, {0, 30}};
  else
    robot.ranges = {{-7.5, 7.5}, {-60, -75}, {120, 105}, {90, 75}, {90, 75}, {0, 15}};
  return robot;
}

/// One number of a table, over all runs.
struct Score {
  std::string name;
  double bound = 0;
  double squares = 0;
  double circle_squares = 0;
  int inside = 0;
  int count = 0;
  double sigma = 0;

  [[nodiscard]] double rms() const { return std::sqrt(squares / count); }
};

std::vector<const DhNumber*> numbers(const std::vector<DhEstimate>& table) {
  std::vector<const DhNumber*> all;
  for (const auto& row : table)
    for (const auto* number : {&row.b_mm, &row.theta_rad, &row.a_mm, &row.alpha_rad, &row.beta_rad})
      all.push_back(number);
  return all;
}

double error_of(const DhNumber& found, double truth, std::size_t index) {
  const bool length = index % 5 == 0 || index % 5 == 2;
  return length ? found.value - truth : identify::wrapped(found.value - truth);
}

struct Run {
  std::vector<Score> scores;
  std::vector<int> trusted;  ///< by joint
  int other_trust = 0;
  int failures = 0;
  double correlated = 0;
};

Run run(const Simulated& robot, const Regime& regime, bool believed, int runs,
        unsigned first_seed = 1) {
  const auto limit = bound(robot, regime, believed);
  const auto truth = numbers(limit);
  Run total;
  static const std::array<const char*, 5> kNames = {"b", "theta", "a", "alpha", "beta"};
  for (std::size_t k = 0; k < truth.size(); ++k)
    total.scores.push_back({kNames[k % 5] + std::to_string(k / 5 + 1), truth[k]->sigma});
  total.trusted.assign(robot.arm.joints(), 0);
  std::atomic<int> next = 0;
  std::vector<identify::Identification> found(static_cast<std::size_t>(runs));
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < std::max(1u, std::thread::hardware_concurrency()); ++t)
    threads.emplace_back([&] {
      for (int i = next++; i < runs; i = next++) {
        auto result =
            identify::identify(sweeps_of(robot, regime, first_seed + static_cast<unsigned>(i)),
                               campaign_of(robot, regime));
        result.joints.clear();
        found[static_cast<std::size_t>(i)] = std::move(result);
      }
    });
  for (auto& thread : threads) thread.join();
  for (const auto& result : found) {
    if (!result.chain || result.estimator != identify::Estimator::chain) {
      ++total.failures;
      continue;
    }
    total.correlated += result.chain->samples_per_independent / runs;
    for (std::size_t j = 0; j < total.trusted.size(); ++j)
      total.trusted[j] += result.chain->angles[j].trust == identify::AngleTrust::trusted;
    const auto seen = numbers(result.dh);
    const auto circles = numbers(result.circle_dh);
    const auto turned = [&](std::size_t index) {
      // Theta is stated at the home that the angles tell, not at the one that was meant; but a
      // sagging joint's angle is off there.
      const std::size_t j = index / 5;
      if (index % 5 != 1 || !regime.angles || j == regime.sagging) return 0.0;
      return robot.arm.positive[j] * (*result.home_rad[j] - robot.arm.home_rad[j]);
    };
    for (std::size_t k = 0; k < truth.size(); ++k) {
      if (truth[k]->knowledge != Knowledge::identified || truth[k]->sigma == 0) continue;
      if (seen[k]->knowledge != Knowledge::identified) continue;
      Score& score = total.scores[k];
      const double error = error_of(*seen[k], truth[k]->value + turned(k), k);
      const double circle_error = error_of(*circles[k], truth[k]->value + turned(k), k);
      ++score.count;
      score.squares += error * error;
      score.sigma += seen[k]->sigma;
      score.circle_squares += circle_error * circle_error;
      score.inside += std::abs(error) <= 1.96 * seen[k]->sigma;
    }
  }
  std::erase_if(total.scores, [](const Score& score) { return score.count == 0; });
  return total;
}

void print(const std::string& title, const Run& result) {
  std::cout << title << ": failures " << result.failures << ", samples/independent "
            << fixed(result.correlated, 2) << ", trusted";
  for (const int count : result.trusted) std::cout << ' ' << count;
  std::cout << '\n';
  double worst = 0;
  for (const auto& s : result.scores) {
    worst = std::max(worst, s.rms() / s.bound);
    std::cout << "  " << s.name << "  n " << s.count << "  rms " << fixed(s.rms(), 8) << "  bound "
              << fixed(s.bound, 8) << "  ratio " << fixed(s.rms() / s.bound, 3) << "  circle/chain "
              << fixed(std::sqrt(s.circle_squares / s.squares), 1) << "  covered "
              << fixed(100.0 * s.inside / s.count, 1) << "%  sigma/rms "
              << fixed(s.sigma / s.count / s.rms(), 3) << '\n';
  }
  std::cout << "  worst ratio " << fixed(worst, 3) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Accuracy of the engine on simulated campaigns");
  int runs = 1000;
  std::string what = "all";
  app.add_option("what", what);
  app.add_option("--runs", runs)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  for (const int arc : {90, 30, 15}) {
    const auto robot = kr5(arc);
    if (what == "efficiency" || what == "all") {
      Regime controller;
      controller.wobble_deg = 0.0005;
      controller.step = 1e-4;
      print("controller " + std::to_string(arc), run(robot, controller, true, runs));
      Regime tracker;
      tracker.position_mm = 0.02;
      tracker.angles = false;
      print("tracker " + std::to_string(arc), run(robot, tracker, false, runs));
    }
    if (what == "correlated") {
      Regime tracker;
      tracker.position_mm = 0.02;
      tracker.angles = false;
      tracker.correlation = 0.9;
      print("correlated " + std::to_string(arc), run(robot, tracker, false, runs));
    }
    if (what == "sag") {
      Regime tracker;
      tracker.position_mm = 0.02;
      tracker.sagging = 1;
      tracker.sag_arcsec = 100;
      print("sag " + std::to_string(arc), run(robot, tracker, false, runs));
    }
    if (what == "outliers") {
      Regime tracker;
      tracker.position_mm = 0.02;
      tracker.angles = false;
      tracker.outlier_share = 0.05;
      print("outliers " + std::to_string(arc), run(robot, tracker, false, runs));
    }
  }
}
