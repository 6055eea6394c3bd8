// Streams of positions alone, as a camera sees one marker on the tool or three: a campaign of
// sweeps with rests, in noise, segmented and identified. For each arm, number of markers, rate and
// noise: how many results are complete, and of those how many are wrong; how large errors are
// beside their uncertainties. Fixed seeds; figures, not a test.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iostream>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/points/point_sweeps.hpp"
#include "identify/geometry/angle.hpp"
#include "tests/bench/coverage_cases.hpp"
#include "tests/bench/coverage_score.hpp"
#include "tests/bench/table.hpp"
#include "tests/simulation/truth.hpp"

using bench::left;
using bench::right;
using identify::kDegree;

namespace {

struct Options {
  std::uint32_t runs = 10;
  std::vector<std::string> arms = {"paper", "kr5", "iiwa"};
  std::vector<std::size_t> markers = {1, 3};
  std::vector<double> rates = {100, 240};
  std::vector<double> noises = {0.05, 0.1, 0.3, 1};
  double arc_deg = 90;
  double speed_deg_s = 20;
  double rest_s = 0.5;
  double positioning_deg_s = 60;
  double correlation = 0;
  bool plan = false;
  bool details = false;
};

struct Cell {
  std::string arm;
  std::size_t markers = 1;
  double rate_hz = 100;
  double noise_mm = 0.1;
  double correlation = 0;
};

/// Each joint in turn: to the start of its sweep, over it, and home, with rests between.
class Stream {
 public:
  Stream(const identify::Arm& arm, const std::vector<Eigen::Vector3d>& targets_mm, const Cell& cell,
         std::uint32_t seed)
      : arm_(arm),
        targets_mm_(targets_mm),
        cell_(cell),
        random_(seed),
        angles_(arm.home_rad),
        errors_(targets_mm.size(), Eigen::Vector3d::Zero()) {
    file_.with_times = true;
  }

  sweepd::PointsFile run(const Options& how) {
    const double arc_deg = how.arc_deg, speed_deg_s = how.speed_deg_s;
    const double kPositioning_deg_s = how.positioning_deg_s;
    rest(0.5);
    rest_s_ = how.rest_s;
    for (std::size_t joint = 0; joint < arm_.joints(); ++joint) {
      const double home = arm_.home_rad[joint];
      move(joint, home - arc_deg / 2 * kDegree, kPositioning_deg_s);
      move(joint, home + arc_deg / 2 * kDegree, speed_deg_s);
      move(joint, home, kPositioning_deg_s);
    }
    return std::move(file_);
  }

 private:
  void move(std::size_t joint, double to_rad, double speed_deg_s) {
    const double from = angles_[joint];
    const double seconds = std::abs(to_rad - from) / (speed_deg_s * kDegree);
    for (const double begin = time_s_; time_s_ < begin + seconds; see())
      angles_[joint] =
          from +
          (to_rad - from) * (0.5 - 0.5 * std::cos(std::numbers::pi * (time_s_ - begin) / seconds));
    angles_[joint] = to_rad;
    rest(rest_s_);
  }
  void rest(double seconds) {
    for (const double begin = time_s_; time_s_ < begin + seconds;) see();
  }
  void see() {
    std::normal_distribution<> normal;
    const double kept = cell_.correlation, added = std::sqrt(1 - kept * kept);
    const auto frame = identify::forward_kinematics(arm_, angles_);
    for (std::size_t target = 0; target < targets_mm_.size(); ++target) {
      sweepd::Point point;
      point.target = target;
      point.sample.time_s = time_s_;
      point.sample.position_mm = frame * targets_mm_[target];
      for (double& error : errors_[target]) error = kept * error + added * normal(random_);
      point.sample.position_mm += cell_.noise_mm * errors_[target];
      point.sample.has_position = true;
      file_.points.push_back(point);
    }
    time_s_ += 1 / cell_.rate_hz;
  }

  identify::Arm arm_;
  std::vector<Eigen::Vector3d> targets_mm_;
  Cell cell_;
  std::mt19937_64 random_;
  std::vector<double> angles_;
  std::vector<Eigen::Vector3d> errors_;  // of each target, in units of the noise
  double time_s_ = 0;
  double rest_s_ = 0;
  sweepd::PointsFile file_;
};

struct Result {
  coverage::Outcome outcome;
  bool sign_wrong = false;
  bool told = false;  ///< the noise is said to hide motion
  double noise_mm = 0;
  std::string about;
};

Result run(const Cell& cell, const Options& options, std::uint32_t seed) {
  const simulation::Simulation truth(coverage::robot_of(cell.arm, cell.markers, seed), {}, {},
                                     seed);
  const auto& robot = truth.robot();
  const auto file = Stream(robot.arm, robot.targets_mm, cell, seed).run(options);
  identify::Campaign known;
  known.joints = robot.arm.joints();
  known.specified = robot.specified;
  known.device_frame = true;
  if (options.plan) {
    known.declared_home_rad = robot.specified.home_rad;
    const double arc = options.arc_deg * kDegree;
    for (std::size_t j = 0; j < known.joints; ++j)
      known.order.push_back({j, -1, {-arc / 2, arc, -arc / 2}});
  }
  auto sweeps = sweepd::streamed_sweeps(file, known.joints, {}, known.motion_limit);
  const auto found = identify::identify(std::move(sweeps), known);
  Result result;
  result.outcome = coverage::judged(truth, found);
  const auto right_table = simulation::true_table(truth, found.dh, found.home_rad);
  for (const auto& number : result.outcome.numbers) {
    const auto& row = right_table[number.index / 5];
    const double values[] = {row.b_mm, row.theta_rad, row.a_mm, row.alpha_rad, row.beta_rad};
    const double value = values[number.index % 5];
    const bool length = number.index % 5 == 0 || number.index % 5 == 2;
    if (std::abs(value) > (length ? 5 : 5 * kDegree) && std::abs(number.error) > std::abs(value))
      result.sign_wrong = true;
  }
  if (found.chain) result.noise_mm = found.chain->noise.position_mm;
  result.about = found.reason;
  for (const auto& warning : found.warnings) {
    result.told |= warning.code == "motion_limit";
    result.about +=
        " [" + warning.code + (warning.code == "motion_limit" ? " " + warning.message : "") + "]";
  }
  return result;
}

std::vector<Result> run_all(const Cell& cell, const Options& options) {
  std::vector<Result> results(options.runs);
  std::atomic<std::uint32_t> next = 0;
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < std::max(1U, std::thread::hardware_concurrency()); ++t)
    threads.emplace_back([&] {
      for (auto i = next++; i < results.size(); i = next++) results[i] = run(cell, options, i + 1);
    });
  for (auto& thread : threads) thread.join();
  return results;
}

void print(const Cell& cell, const std::vector<Result>& results, bool details) {
  using identify::Status;
  int complete = 0, doubtful = 0, wrong = 0, signs = 0, told = 0;
  double inside = 0, numbers = 0, noise = 0;
  for (const Result& result : results) {
    const Status status = result.outcome.status;
    complete += status == Status::complete;
    doubtful += status == Status::doubtful;
    told += result.told;
    signs += result.sign_wrong;
    noise += result.noise_mm / static_cast<double>(results.size());
    if (status != Status::complete) continue;
    double most = 0;
    for (const auto& number : result.outcome.numbers) {
      inside += number.inside();
      ++numbers;
      most = std::max(most, std::abs(number.error) / number.sigma);
    }
    wrong += most > 6;
  }
  std::cout << left(cell.arm, 7) << right(std::to_string(cell.markers), 8)
            << right(cell.rate_hz, 0, 6) << right(cell.noise_mm, 2, 7)
            << right(std::to_string(complete), 10) << right(std::to_string(doubtful), 10)
            << right(std::to_string(results.size() - static_cast<std::size_t>(complete + doubtful)),
                     7)
            << right(std::to_string(wrong), 7) << right(std::to_string(signs), 7)
            << right(numbers > 0 ? 100 * inside / numbers : 0, 1, 9) << right(noise, 4, 10)
            << right(std::to_string(told), 6) << std::endl;
  std::map<std::string, int> reasons;
  for (const Result& result : results)
    ++reasons[std::string(identify::text(result.outcome.status)) +
              (result.sign_wrong ? " SIGN" : "") + ": " + result.about];
  if (details)
    for (const auto& [reason, count] : reasons)
      std::cout << "    " << count << " x " << reason << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Streams of positions alone, in noise");
  Options options;
  app.add_option("--runs", options.runs, "Seeds of each kind");
  app.add_option("--arm", options.arms, "Arms");
  app.add_option("--markers", options.markers, "Targets seen at once");
  app.add_option("--rate", options.rates, "Frames a second");
  app.add_option("--noise", options.noises, "Of a coordinate, mm");
  app.add_option("--arc", options.arc_deg, "Degrees of each sweep");
  app.add_option("--speed", options.speed_deg_s, "Mean speed of the sweeps, degrees a second");
  app.add_option("--rest", options.rest_s, "Seconds between moves");
  app.add_option("--positioning", options.positioning_deg_s,
                 "Mean speed of other moves, degrees a second");
  app.add_option("--correlation", options.correlation,
                 "Of a coordinate's error with the one before");
  app.add_flag("--plan", options.plan, "The sweeps and home are declared");
  app.add_flag("--details", options.details, "Why results are not complete");
  CLI11_PARSE(app, argc, argv);
  std::cout << "arm     markers  rate  noise  complete  doubtful  other  wrong  signs  inside %  "
               "noise mm  told\n";
  for (const auto& arm : options.arms)
    for (const std::size_t markers : options.markers)
      for (const double rate : options.rates)
        for (const double noise : options.noises) {
          const Cell cell{arm, markers, rate, noise, options.correlation};
          print(cell, run_all(cell, options), options.details);
        }
}
