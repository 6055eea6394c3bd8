// Whether `sweepd compare` tells a robot that has changed from one that has not: pairs of simulated
// campaigns of one arm, each identified, written as result.json and read again. Fixed seeds;
// figures, not a test.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <Eigen/Dense>

#include "daemon/results/change.hpp"
#include "daemon/results/result_formats.hpp"
#include "identify/geometry/angle.hpp"
#include "tests/bench/coverage_cases.hpp"
#include "tests/bench/table.hpp"

using bench::left;
using bench::right;
using identify::kDegree;
using simulation::Robot;
using simulation::Strokes;
using simulation::World;
using sweepd::Change;
using sweepd::fixed;
using sweepd::name_of;
namespace fs = std::filesystem;

namespace {

struct Options {
  int pairs = 400;
  unsigned threads = 0;
  double level = 0.05;
  std::string arm = "kr5";
  std::vector<std::string> cases;
};

/// One campaign of a pair.
struct Measurement {
  Robot robot;
  Strokes strokes;
  World world;
  std::uint32_t seed = 1;
  bool reversed = false;  ///< the last joint first
};

struct Pair {
  Measurement first;
  Measurement second;
};

World tracker() {
  World world;
  world.placed = true;
  world.angles = true;
  world.decimals = 4;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  return world;
}

/// The same strokes in the other order.
std::vector<identify::Sweep> in_reverse(std::vector<identify::Sweep> sweeps) {
  std::reverse(sweeps.begin(), sweeps.end());
  double start_s = 0;
  for (identify::Sweep& sweep : sweeps) {
    auto samples = *sweep.samples;
    const double later_s = start_s - samples.front().time_s;
    for (auto& sample : samples) sample.time_s += later_s;
    start_s = samples.back().time_s + 10;
    sweep.samples = std::make_shared<const std::vector<identify::Sample>>(std::move(samples));
  }
  return sweeps;
}

sweepd::ToldArm told(const Measurement& measured, const fs::path& file) {
  const simulation::Simulation simulation(measured.robot, measured.strokes, measured.world,
                                          measured.seed);
  const auto campaign = simulation.campaign();
  sweepd::Outcome outcome;
  outcome.robot = "simulated";
  outcome.source_kind = "points";
  if (!measured.world.controller) outcome.points = sweepd::PointCounts{};
  outcome.identification = identify::identify(
      measured.reversed ? in_reverse(simulation.sweeps()) : simulation.sweeps(), campaign);
  outcome.positive = measured.robot.specified.positive;
  outcome.angle_step_rad = campaign.resolution.angle_rad;
  std::ofstream(file) << sweepd::result_json(outcome);
  return sweepd::read_told_arm(file);
}

Change compare(const Pair& pair, double level, const fs::path& folder, int index) {
  const fs::path file = folder / (std::to_string(index) + ".json");
  auto first = told(pair.first, file);
  auto second = told(pair.second, file);
  fs::remove(file);
  return sweepd::change_between(std::move(first), std::move(second), level);
}

/// The same arm, measured twice by a device that stands elsewhere.
Pair unchanged(const std::string& arm, std::uint32_t seed) {
  Measurement one{coverage::robot_of(arm, 1, seed), {}, tracker(), 2 * seed};
  one.strokes.there_and_back = true;
  one.strokes.repeats = 2;
  one.strokes.samples = 150;
  Measurement other = one;
  other.seed = 2 * seed + 1;
  return {one, other};
}

void other_tool(Pair& pair, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<> off(-40, 40);
  for (auto& target : pair.second.robot.targets_mm)
    target += Eigen::Vector3d(off(random), off(random), off(random));
}

void other_home(Pair& pair, std::uint32_t seed) {
  pair.second.robot = simulation::at_random_home(pair.second.robot, seed + 77);
}

void other_plan(Pair& pair) {
  pair.second.strokes.arc_deg = 60;
  pair.second.strokes.repeats = 3;
  pair.second.strokes.ramp = 0.1;
  pair.second.strokes.samples = 120;
}

struct Case {
  std::string name;
  std::string about;
  std::function<void(Pair&, std::uint32_t)> set;
};

const std::vector<Case>& cases() {
  const auto gears = [](Pair& pair, std::uint32_t seed) {
    for (Measurement* one : {&pair.first, &pair.second}) one->world.gears = {20, 10, 0, {}, seed};
  };
  static const std::vector<Case> kAll = {
      {"same", "device elsewhere", [](Pair&, std::uint32_t) {}},
      {"oneway", "every sweep once and one way",
       [](Pair& pair, std::uint32_t) {
         for (Measurement* one : {&pair.first, &pair.second}) one->strokes = {};
       }},
      {"tool", "other tool, too", other_tool},
      {"home", "other home, too", other_home},
      {"plan", "other arcs and repeats, too", [](Pair& pair, std::uint32_t) { other_plan(pair); }},
      {"order", "the last joint first, too",
       [](Pair& pair, std::uint32_t) { pair.second.reversed = true; }},
      {"all", "tool, home, plan and order",
       [](Pair& pair, std::uint32_t seed) {
         pair.second.reversed = true;
         other_tool(pair, seed);
         other_home(pair, seed);
         other_plan(pair);
       }},
      {"play", "as all, locked joints off by 0.002 deg",
       [](Pair& pair, std::uint32_t seed) {
         other_tool(pair, seed);
         other_home(pair, seed);
         other_plan(pair);
         for (Measurement* one : {&pair.first, &pair.second}) one->world.home.sigma_deg = 0.002;
       }},
      {"gears", "as all, transmission errors of 20 + 10 arcsec",
       [gears](Pair& pair, std::uint32_t seed) {
         other_tool(pair, seed);
         other_home(pair, seed);
         other_plan(pair);
         gears(pair, seed);
       }},
      {"model", "the controller's telegrams, other tool, home and plan",
       [](Pair& pair, std::uint32_t seed) {
         other_tool(pair, seed);
         other_home(pair, seed);
         other_plan(pair);
         for (Measurement* one : {&pair.first, &pair.second}) {
           one->world = {};
           one->world.controller = one->world.angles = one->world.orientations = true;
           one->world.decimals = 4;
           one->world.wobble_deg = 0.0005;
         }
       }},
  };
  return kAll;
}

std::vector<Change> run_all(const Options& options, const fs::path& folder,
                            const std::function<std::optional<Pair>(std::size_t)>& pair, int runs) {
  std::vector<std::optional<Change>> found(static_cast<std::size_t>(runs));
  std::atomic<std::size_t> next = 0;
  std::atomic<int> refused = 0;
  std::vector<std::thread> threads;
  const unsigned wanted =
      options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency());
  for (unsigned t = 0; t < wanted; ++t)
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < found.size(); i = next++) try {
          if (const auto one = pair(i))
            found[i] = compare(*one, options.level, folder, static_cast<int>(i));
        } catch (const std::exception& problem) {
          if (refused++ == 0) std::cerr << problem.what() << '\n';
        }
    });
  for (auto& thread : threads) thread.join();
  if (refused > 0) std::cout << "  refused: " << refused << '\n';
  std::vector<Change> all;
  for (auto& one : found)
    if (one) all.push_back(std::move(*one));
  return all;
}

double percent(double part, double whole) {
  return whole > 0 ? 100 * part / whole : 0;
}

void print_alarms(const Case& what, const std::vector<Change>& all, double level) {
  double t_squared = 0, total = 0, by_holm = 0, changed = 0, numbers = 0, squares = 0;
  for (const Change& one : all) {
    total += one.test.p < level;
    t_squared += one.test.t_squared / static_cast<double>(one.test.numbers.size());
    double least = 1;
    for (std::size_t k = 0; k < one.test.numbers.size(); ++k) {
      const double z =
          one.arms.difference(static_cast<Eigen::Index>(k)) / one.test.numbers[k].sigma;
      squares += z * z;
      ++numbers;
      least = std::min(least, std::erfc(std::abs(z) / std::sqrt(2)));
    }
    // Holm's first step, which decides whether there is any.
    by_holm += least * static_cast<double>(one.test.numbers.size()) < level;
    changed += one.test.changed;
  }
  const auto count = static_cast<double>(all.size());
  std::cout << left(what.name, 8) << right(std::to_string(all.size()), 6)
            << right(percent(total, count), 1, 9) << right(percent(by_holm, count), 1, 9)
            << right(percent(changed, count), 1, 9) << right(numbers / count, 1, 9)
            << right(t_squared / count, 2, 8) << right(std::sqrt(squares / numbers), 2, 8) << "  "
            << what.about << std::endl;
}

/// A number of the true arm moved, its joints' axes along positive rotation.
void move_number(Robot& robot, const identify::ArmNumber& number, double by) {
  identify::DhRow& row = robot.arm.rows[number.joint];
  const int positive = robot.arm.positive[number.joint];
  switch (number.kind) {
    case identify::ArmNumberKind::b:
      row.b_mm += positive * by;
      break;
    case identify::ArmNumberKind::zero:
      row.theta_rad += positive * by;
      break;
    case identify::ArmNumberKind::a:
      row.a_mm += by;
      break;
    case identify::ArmNumberKind::alpha:
      row.alpha_rad += by;
      break;
    default:
      row.beta_rad += by;
  }
}

/// Each pair with the smallest change of one of its numbers that the pair itself states.
void print_smallest(const Options& options, const fs::path& folder, int runs, bool anew) {
  std::map<std::string, std::array<double, 2>> by_number;
  double found = 0, seen = 0, count = 0;
  std::mutex mutex;
  std::vector<std::size_t> moved(static_cast<std::size_t>(runs));
  const auto all = run_all(
      options, folder,
      [&](std::size_t i) -> std::optional<Pair> {
        const auto seed = static_cast<std::uint32_t>(i + 1);
        Pair pair = unchanged(options.arm, seed);
        const Change before = compare(pair, options.level, folder, static_cast<int>(i));
        const std::size_t k = i % before.arms.numbers.size();
        const identify::ArmNumber& number = before.arms.numbers[k];
        move_number(pair.second.robot, number, before.test.numbers[k].smallest);
        if (anew) pair.second.seed += 100000;
        moved[i] = k;
        return pair;
      },
      runs);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::size_t k = moved[i];
    if (k >= all[i].test.numbers.size()) continue;
    const bool named = all[i].test.numbers[k].changed;
    auto& [hits, cases] = by_number[name_of(all[i].arms.numbers[k])];
    hits += named;
    ++cases;
    found += named;
    seen += all[i].test.changed;
    ++count;
  }
  std::cout << "\na number moved by its smallest change, "
            << (anew ? "measured anew, " : "with the same noise, ") << count << " pairs: named in "
            << fixed(percent(found, count), 1) << " %, any change seen in "
            << fixed(percent(seen, count), 1) << " %\n ";
  for (const auto& [name, hits] : by_number)
    std::cout << ' ' << name << ' ' << hits[0] << '/' << hits[1];
  std::cout << std::endl;
}

/// The largest displacement between two true arms, base and tool fitted, over poses of chance.
double true_displacement(const Robot& first, const Robot& second,
                         const std::vector<identify::TurnRange>& ranges) {
  std::mt19937 random(5);
  constexpr std::size_t kPoses = 4000;
  using Columns = Eigen::Matrix<double, 3, 9>;
  const auto at_pose = [&](const std::vector<double>& angles) {
    const Eigen::Isometry3d pose = forward_kinematics(first.arm, angles);
    const Eigen::Vector3d point = pose * first.targets_mm[0];
    Columns columns;
    columns << Eigen::Matrix3d::Identity(), -identify::cross_matrix(point) / 1000, pose.linear();
    const Eigen::Vector3d moved =
        forward_kinematics(second.arm, angles) * first.targets_mm[0] - point;
    return std::pair(moved, columns);
  };
  Eigen::MatrixXd frames(3 * kPoses, 9);
  Eigen::VectorXd off(3 * kPoses);
  for (std::size_t k = 0; k < kPoses; ++k) {
    std::vector<double> angles = first.arm.home_rad;
    for (std::size_t j = 0; j < angles.size(); ++j)
      angles[j] += std::uniform_real_distribution<>(ranges[j][0], ranges[j][1])(random);
    const Eigen::Isometry3d pose = forward_kinematics(first.arm, angles);
    const Eigen::Vector3d point = pose * first.targets_mm[0];
    const auto at = static_cast<Eigen::Index>(3 * k);
    off.segment<3>(at) = forward_kinematics(second.arm, angles) * first.targets_mm[0] - point;
    frames.block<3, 9>(at, 0) << Eigen::Matrix3d::Identity(), -identify::cross_matrix(point) / 1000,
        pose.linear();
  }
  const Eigen::VectorXd fitted = frames.colPivHouseholderQr().solve(off);
  // The largest: poses of chance, then smaller and smaller steps from the best; some times over.
  double largest = 0;
  for (int round = 0; round < 20; ++round) {
    std::vector<double> best = first.arm.home_rad;
    double most = 0;
    for (std::size_t k = 0; k < kPoses; ++k) {
      const double share = std::min(1.0, std::pow(0.998, static_cast<double>(k) - 0.25 * kPoses));
      std::vector<double> angles = first.arm.home_rad;
      for (std::size_t j = 0; j < angles.size(); ++j) {
        const double low = angles[j] + ranges[j][0], high = angles[j] + ranges[j][1];
        const double anywhere = std::uniform_real_distribution<>(low, high)(random);
        const double step = std::normal_distribution<>(0, share * (high - low))(random);
        angles[j] = share < 1 ? std::clamp(best[j] + step, low, high) : anywhere;
      }
      const auto [moved, columns] = at_pose(angles);
      const double size = (moved - columns * fitted).norm();
      if (size <= most) continue;
      most = size;
      best = angles;
    }
    largest = std::max(largest, most);
  }
  return largest;
}

void print_crash(const Options& options, const fs::path& folder, int runs) {
  double found = 0, named = 0, alone = 0, right_by_ten = 0, in_band = 0;
  std::vector<double> ratios;
  for (const Change& one : run_all(
           options, folder,
           [&](std::size_t i) -> std::optional<Pair> {
             Pair pair = unchanged(options.arm, static_cast<std::uint32_t>(i + 1));
             pair.second.robot.arm.rows[3].theta_rad += 0.02 * kDegree;
             return pair;
           },
           runs)) {
    const auto seed = static_cast<std::uint32_t>(ratios.size() + 1);
    const Robot before = coverage::robot_of(options.arm, 1, seed);
    Robot after = before;
    after.arm.rows[3].theta_rad += 0.02 * kDegree;
    const double truth = true_displacement(before, after, one.first.reach.ranges);
    const identify::Displacement shown = one.changes_displacement.value_or(one.displacement);
    const double ratio = shown.largest_mm / truth;
    ratios.push_back(ratio);
    found += one.test.changed;
    int others = 0;
    bool zero4 = false;
    for (std::size_t k = 0; k < one.test.numbers.size(); ++k) {
      if (!one.test.numbers[k].changed) continue;
      if (name_of(one.arms.numbers[k]) == "zero4")
        zero4 = true;
      else
        ++others;
    }
    named += zero4;
    alone += zero4 && others == 0;
    right_by_ten += std::abs(ratio - 1) <= 0.1;
    in_band += shown.low_mm <= truth && truth <= shown.high_mm;
    if (seed == 1)
      std::cout << "\nfirst: true " << fixed(truth, 4) << " mm, found "
                << fixed(shown.largest_mm, 4) << " (" << fixed(shown.low_mm, 4) << " to "
                << fixed(shown.high_mm, 4) << ")\n";
  }
  const auto count = static_cast<double>(ratios.size());
  std::sort(ratios.begin(), ratios.end());
  std::cout << "axis 4 off by 0.02 deg, " << ratios.size() << " pairs: found in "
            << fixed(percent(found, count), 1) << " %, zero4 named in "
            << fixed(percent(named, count), 1) << " %, nothing else in "
            << fixed(percent(alone, count), 1) << " %; displacement right to 10 % in "
            << fixed(percent(right_by_ten, count), 1) << " %, " << fixed(ratios.front(), 3)
            << " to " << fixed(ratios.back(), 3) << " of the true one, in its band in "
            << fixed(percent(in_band, count), 1) << " %" << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Pairs of simulated campaigns, compared", "bench_compare");
  Options options;
  std::vector<std::string> names = {"smallest", "crash"};
  for (const Case& one : cases()) names.push_back(one.name);
  app.add_option("CASE", options.cases, "What to compare (default: all)")
      ->expected(-1)
      ->check(CLI::IsMember(names));
  app.add_option("--pairs", options.pairs, "Unchanged pairs of each kind; half as many changed")
      ->check(CLI::Range(2, 100000))
      ->capture_default_str();
  app.add_option("--arm", options.arm, "Arm")
      ->check(CLI::IsMember(coverage::all_arms()))
      ->capture_default_str();
  app.add_option("--level", options.level, "Level")->capture_default_str();
  app.add_option("--threads", options.threads, "0: as many as there are cores")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  std::string folder = (fs::temp_directory_path() / "sweepd-compare-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) return 1;
  const auto wanted = [&](const std::string& name) {
    return options.cases.empty() ||
           std::find(options.cases.begin(), options.cases.end(), name) != options.cases.end();
  };
  std::cout << options.arm
            << ", a tracker of 0.02 mm beside told angles, sweeps there and back, twice\n"
            << left("case", 8) << right("pairs", 6) << right("T2 %", 9) << right("Holm %", 9)
            << right("exit 3 %", 9) << right("numbers", 9) << right("T2/n", 8) << right("rms z", 8)
            << '\n';
  for (const Case& one : cases()) {
    if (!wanted(one.name)) continue;
    print_alarms(one,
                 run_all(
                     options, folder,
                     [&](std::size_t i) -> std::optional<Pair> {
                       const auto seed = static_cast<std::uint32_t>(i + 1);
                       Pair pair = unchanged(options.arm, seed);
                       one.set(pair, seed);
                       return pair;
                     },
                     options.pairs),
                 options.level);
  }
  if (wanted("smallest"))
    for (const bool anew : {false, true}) print_smallest(options, folder, options.pairs / 2, anew);
  if (wanted("crash")) print_crash(options, folder, options.pairs / 2);
  fs::remove_all(folder);
}
