// How right `sweepd plan` is: the standard uncertainties that it predicts against the scatter of
// simulated campaigns with other seeds, identified. Fixed seeds; figures, not a test.

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/plan/plan_outlook.hpp"
#include "daemon/text/units.hpp"
#include "tests/bench/table.hpp"
#include "tests/config_folder.hpp"

using bench::left;
using bench::right;
using identify::DhEstimate;
using identify::DhNumber;
using identify::Knowledge;

namespace {

constexpr std::array kNumbers{&DhEstimate::b_mm, &DhEstimate::theta_rad, &DhEstimate::a_mm,
                              &DhEstimate::alpha_rad, &DhEstimate::beta_rad};
constexpr std::array kNames{"b", "theta", "a", "alpha", "beta"};

struct Options {
  int runs = 200;
  int first_seed = 1000;
  unsigned threads = 0;
};

/// Errors of one number over all runs.
struct Score {
  std::string name;
  double predicted = 0;
  double stated = 0;  ///< sum of what the results state
  double sum = 0;
  double squares = 0;
  int count = 0;

  [[nodiscard]] double rms() const { return std::sqrt(squares / count); }
  [[nodiscard]] double deviation() const {
    return std::sqrt(std::max(0.0, squares - sum * sum / count) / (count - 1));
  }
};

using Errors = std::vector<std::array<DhNumber, 5>>;  // a row a joint; value is the error

/// The table of a campaign, less the arm that was simulated, at the home that it states.
Errors errors_of(const identify::Identification& found) {
  Errors errors;
  for (std::size_t j = 0; j < found.dh.size(); ++j) {
    const identify::DhRow& truth = found.specified[j];
    const std::array values{truth.b_mm, truth.theta_rad, truth.a_mm, truth.alpha_rad,
                            truth.beta_rad};
    errors.emplace_back();
    for (std::size_t k = 0; k < kNumbers.size(); ++k) {
      errors.back()[k] = found.dh[j].*kNumbers[k];
      double& value = errors.back()[k].value;
      value -= values[k];
      if (k % 2 == 1 || k == 4) value = identify::wrapped(value);
    }
  }
  return errors;
}

std::vector<Errors> simulated(const Options& options, const sweepd::RobotDescription& robot,
                              const sweepd::SweepPlan& plan,
                              const sweepd::Measurement& measurement) {
  std::vector<Errors> runs(static_cast<std::size_t>(options.runs));
  std::atomic<int> next = 0;
  std::vector<std::thread> threads;
  const unsigned wanted =
      options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency());
  for (unsigned t = 0; t < wanted; ++t)
    threads.emplace_back([&] {
      for (int i = next++; i < options.runs; i = next++) {
        const auto seed = static_cast<std::uint64_t>(options.first_seed + i);
        const auto run = sweepd::rehearse(robot, plan, measurement, seed);
        if (run.identification.estimator == identify::Estimator::chain)
          runs[static_cast<std::size_t>(i)] = errors_of(run.identification);
      }
    });
  for (auto& thread : threads) thread.join();
  return runs;
}

void compare(const Options& options, const std::string& title, const std::string& plan_file,
             const sweepd::Measurement& measurement) {
  const auto robot = sweepd::load_robot(sweepd::test::kRobot);
  const auto plan = sweepd::load_plan(sweepd::test::kConfig / "plans" / plan_file);
  const auto prediction = sweepd::look_ahead(robot, plan, measurement).prediction;
  const auto runs = simulated(options, robot, plan, measurement);

  int failed = 0;
  std::vector<Score> scores;
  for (std::size_t j = 0; j < prediction.dh.size(); ++j)
    for (std::size_t k = 0; k < kNumbers.size(); ++k) {
      const DhNumber& number = prediction.dh[j].*kNumbers[k];
      if (number.knowledge != Knowledge::identified) continue;
      Score score;
      score.name = kNames[k] + std::to_string(j + 1);
      score.predicted = number.sigma;
      for (const Errors& run : runs) {
        if (run.empty() || run[j][k].knowledge != Knowledge::identified) continue;
        ++score.count;
        score.sum += run[j][k].value;
        score.squares += run[j][k].value * run[j][k].value;
        score.stated += run[j][k].sigma;
      }
      if (score.count > 1) scores.push_back(score);
    }
  for (const Errors& run : runs) failed += run.empty();

  std::cout << "\n"
            << title << ": " << options.runs << " runs, " << failed
            << " failed\nscatter: standard deviation about the mean; rms: about the truth; stated: "
               "the results' own, mean. Of "
            << options.runs << " runs\nchance alone makes the ratios scatter by "
            << sweepd::fixed(100 / std::sqrt(2.0 * options.runs), 1) << " %.\n\n"
            << left("", 8) << right("runs", 6) << right("predicted", 14) << right("", 4)
            << right("scatter/pred", 14) << right("rms/pred", 10) << right("stated/pred", 13)
            << "\n";
  double worst = 0;
  for (const Score& score : scores) {
    const bool length = score.name[0] == 'b' ? score.name[1] != 'e' : score.name.size() == 2;
    const double ratio = score.deviation() / score.predicted;
    worst = std::max(worst, std::abs(ratio - 1));
    std::cout << left(score.name, 8) << right(std::to_string(score.count), 6)
              << right(length ? score.predicted : sweepd::degrees(score.predicted), 9, 14)
              << left(length ? " mm" : " deg", 4) << right(ratio, 3, 14)
              << right(score.rms() / score.predicted, 3, 10)
              << right(score.stated / score.count / score.predicted, 3, 13) << "\n";
  }
  std::cout << "worst: off by " << sweepd::fixed(100 * worst, 1) << " %" << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Predicted standard uncertainties against the scatter of simulated campaigns",
               "bench_plan");
  Options options;
  app.add_option("--runs", options.runs, "Campaigns of each kind")
      ->check(CLI::Range(2, 1000000))
      ->capture_default_str();
  app.add_option("--first-seed", options.first_seed, "The others follow")->capture_default_str();
  app.add_option("--threads", options.threads, "0: as many as there are cores")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  compare(options, "Table 2, 90 degrees, controller", "kr5_arc_90deg.toml", {});
  compare(options, "Table 2, 30 degrees, controller", "kr5_arc_30deg.toml", {});
  sweepd::Measurement tracker;
  tracker.position_sigma_mm = 0.02;
  compare(options, "Table 2, 90 degrees, tracker of 0.02 mm", "kr5_arc_90deg.toml", tracker);
  compare(options, "Table 2, 30 degrees, tracker of 0.02 mm", "kr5_arc_30deg.toml", tracker);
}
