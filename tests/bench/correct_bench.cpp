// What `sweepd correct` does for simulated robots: how near corrected joints bring the tool to
// where it is wanted, whether frames, zeros and machine data make poses better that were kept back,
// and the level table beside one that was worked out by differences. Fixed seeds; figures, not a
// test.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iostream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "identify/correction/combined_poses.hpp"
#include "identify/correction/controller_fit.hpp"
#include "identify/correction/corrected_joints.hpp"
#include "tests/bench/coverage_cases.hpp"
#include "tests/bench/table.hpp"
#include "tests/simulation/level_oracle.hpp"

using bench::left;
using bench::right;
using identify::ControllerLevel;
using identify::PlacedArm;
using identify::Pose;

namespace {

struct Options {
  int runs = 200;
  unsigned threads = 0;
  double joint_deg = 0;
  std::vector<std::string> arms = {"kr5", "iiwa"};
};

constexpr double kNoise_mm = 0.02;
constexpr std::size_t kTargets = 50;
constexpr std::size_t kHeld = 500;

/// Of one robot, squares in mm^2 and counts.
struct Outcome {
  double as_is = 0, corrected = 0, expected = 0;
  double reached = 0, refused = 0;
  std::array<double, 4> held{};  ///< root mean squares: as it came, frames, zeros, machine data
  double table_off = 0;          ///< levels against those by differences
};

double held_rms(const PlacedArm& arm, const std::vector<Pose>& held) {
  return distances_mm(arm, held).norm() / std::sqrt(static_cast<double>(held.size()));
}

std::optional<Outcome> run(const std::string& name, std::size_t poses, double joint_deg,
                           std::uint32_t seed) {
  simulation::World world;
  world.angles = world.placed = true;
  world.noise.range_mm = world.noise.across_mm = kNoise_mm;
  world.home.sigma_deg = joint_deg;
  const simulation::Simulation built(coverage::robot_of(name, 1, seed), {}, world, seed);
  auto all = built.poses(poses + kHeld);
  const std::vector<Pose> held(all.begin() + static_cast<std::ptrdiff_t>(poses), all.end());
  all.resize(poses);
  std::string reason;
  const auto found = identify::estimate_poses(all, built.campaign(), nullptr, {}, reason);
  if (!found) return std::nullopt;
  Outcome outcome;
  const PlacedArm& controller = found->levels.front().arm;
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
  tool.translation() = controller.targets_mm.front();
  const identify::CorrectedJoints joints(found->fit, controller, tool);
  const auto truly = [&](const std::vector<double>& angles) {
    return Eigen::Vector3d(built.base() * (forward_kinematics(built.arm_at(angles), angles) *
                                           built.robot().targets_mm.front()));
  };
  for (const Pose& target : built.poses(kTargets, 60)) {
    const std::vector<double> angles(target.sample.angles_rad.begin(),
                                     target.sample.angles_rad.begin() + target.sample.joints);
    const auto reached = joints.reach(angles);
    if (!reached.converged) {
      ++outcome.refused;
      continue;
    }
    const Eigen::Vector3d wanted = joints.believed(angles).translation();
    ++outcome.reached;
    outcome.as_is += (truly(angles) - wanted).squaredNorm();
    outcome.corrected += (truly(reached.angles_rad) - wanted).squaredNorm();
    outcome.expected += reached.expected_mm * reached.expected_mm;
  }
  const Eigen::VectorXd each = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(poses));
  const auto combined = identify::combined_poses(found->fit.model, all, each);
  const Eigen::VectorXd weights =
      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(combined.size()),
                                static_cast<double>(poses) / static_cast<double>(combined.size()));
  outcome.held[0] =
      held_rms({built.robot().specified, built.base(), built.robot().targets_mm}, held);
  for (const auto level :
       {ControllerLevel::frames, ControllerLevel::mastering, ControllerLevel::machine_data})
    outcome.held[static_cast<std::size_t>(level) + 1] =
        held_rms(fitted_controller(controller, level, combined, weights).arm, held);
  if (seed <= 5) {
    const auto oracle = simulation::levels_by_differences(controller, all, held);
    for (std::size_t k = 0; k < oracle.size(); ++k) {
      const auto here = identify::left_of(distances_mm(found->levels[k].arm, held));
      outcome.table_off = std::max({outcome.table_off, std::abs(here.mean_mm - oracle[k].mean_mm),
                                    std::abs(here.most_mm - oracle[k].most_mm)});
    }
  }
  return outcome;
}

void print(const std::string& name, std::size_t poses, const Options& options) {
  std::vector<std::optional<Outcome>> all(static_cast<std::size_t>(options.runs));
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> threads;
  const unsigned wanted =
      options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency());
  for (unsigned t = 0; t < wanted; ++t)
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < all.size(); i = next++)
        all[i] = run(name, poses, options.joint_deg, static_cast<std::uint32_t>(i + 1));
    });
  for (auto& thread : threads) thread.join();
  Outcome sum;
  double worst = 0, robots = 0;
  std::array<int, 3> worse{};
  std::array<double, 3> most{};
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i]) continue;
    const Outcome& one = *all[i];
    ++robots;
    sum.as_is += one.as_is;
    sum.corrected += one.corrected;
    sum.expected += one.expected;
    sum.reached += one.reached;
    sum.refused += one.refused;
    sum.table_off = std::max(sum.table_off, one.table_off);
    worst = std::max(worst, std::sqrt(one.corrected / one.reached));
    for (std::size_t k = 0; k < 4; ++k) sum.held[k] += one.held[k] * one.held[k];
    for (std::size_t k = 0; k < 3; ++k) {
      const double more = one.held[k + 1] / one.held[k] - 1;
      if (more <= 0) continue;
      ++worse[k];
      most[k] = std::max(most[k], more);
      std::cout << "  robot " << i + 1 << ": level " << k + 1 << " is worse by "
                << right(100 * more, 2, 5) << " %\n";
    }
  }
  const auto rms = [&](double squares) { return std::sqrt(squares / sum.reached); };
  std::cout << left(name, 6) << right(std::to_string(poses), 6) << right(rms(sum.as_is), 4, 9)
            << right(rms(sum.corrected), 4, 11)
            << right(rms(sum.corrected) / (kNoise_mm * std::sqrt(3.0)), 3, 8)
            << right(worst / (kNoise_mm * std::sqrt(3.0)), 3, 8) << right(rms(sum.expected), 4, 10)
            << right(100 * sum.refused / (sum.reached + sum.refused), 2, 9);
  for (const double squares : sum.held) std::cout << right(std::sqrt(squares / robots), 4, 9);
  std::cout << "  ";
  for (const int count : worse) std::cout << ' ' << count;
  std::cout << right(1e3 * sum.table_off, 4, 10) << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Simulated robots, identified and corrected", "bench_correct");
  Options options;
  app.add_option("--runs", options.runs, "Robots of each arm")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--joint-deg", options.joint_deg, "Joints stand off by as much, sigma")
      ->capture_default_str();
  app.add_option("--arm", options.arms, "Arms")->check(CLI::IsMember(coverage::all_arms()));
  app.add_option("--threads", options.threads, "0: as many as there are cores")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::cout
      << "Built off by 0.5 mm and 0.05 deg, a tracker of 0.02 mm. mm, rms; targets within the "
         "poses' range.\n"
      << left("arm", 6) << right("poses", 6) << right("as is", 9) << right("corrected", 11)
      << right("/noise", 8) << right("worst", 8) << right("expected", 10) << right("refused%", 9)
      << right("came", 9) << right("frames", 9) << right("zeros", 9) << right("data", 9)
      << "   worse  table um\n";
  for (const std::string& arm : options.arms)
    for (const std::size_t poses : {60UL, 100UL}) print(arm, poses, options);
}
