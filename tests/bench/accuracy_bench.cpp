// How accurate the engine is: errors of simulated campaigns against the Cramér-Rao bound of the
// true model, against the paper's circles on the same samples, and against the stated
// uncertainties. Fixed seeds; figures, not a test.

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/text/numbers.hpp"
#include "identify/identification.hpp"
#include "tests/bench/accuracy_campaign.hpp"
#include "tests/bench/table.hpp"
#include "tests/identify/simulated_campaign.hpp"

using namespace accuracy;
using identify::DhEstimate;
using identify::DhNumber;
using identify::Knowledge;
using simulation::World;
using sweepd::fixed;

namespace {

struct Options {
  int runs = 1000;
  unsigned threads = 0;
  bool details = false;
  std::vector<std::string> cases;
};

Simulated kr5(int arc_deg) {
  Simulated robot;
  robot.arm = identify::test::kr5_arc();
  robot.targets_mm = {robot.arm.tool_mm};
  if (arc_deg == 90)  // Table 2 of the paper; joint 2's is 70 degrees
    robot.ranges = {{-45, 45}, {-60, -130}, {120, 30}, {90, 0}, {90, 0}, {0, 90}};
  else if (arc_deg == 30)
    robot.ranges = {{-15, 15}, {-60, -90}, {120, 90}, {90, 60}, {90, 60}, {0, 30}};
  else
    robot.ranges = {{-7.5, 7.5}, {-60, -75}, {120, 105}, {90, 75}, {90, 75}, {0, 15}};
  return robot;
}

/// An arm from rows (b, theta, a, alpha; mm, degrees) whose home is zero, swept by +-45 degrees.
Simulated arm_of(const std::vector<std::array<double, 4>>& rows) {
  Simulated robot;
  for (const auto& [b, theta, a, alpha] : rows) {
    robot.arm.rows.push_back({b, theta * kDegree, a, alpha * kDegree});
    robot.ranges.push_back({-45, 45});
  }
  robot.arm.home_rad.assign(rows.size(), 0.0);
  robot.arm.positive.assign(rows.size(), 1);
  robot.targets_mm = {{150, 80, 120}};
  return robot;
}

/// KR 5s as they are built: every length off by 0.5 mm, every angle by 0.05 degrees, sigma.
Simulated built_kr5(int arc_deg, unsigned seed) {
  Simulated robot = kr5(arc_deg);
  std::mt19937 random(seed);
  std::normal_distribution<> normal;
  for (auto& row : robot.arm.rows) {
    row.b_mm += 0.5 * normal(random);
    row.theta_rad += 0.05 * kDegree * normal(random);
    row.a_mm += 0.5 * normal(random);
    row.alpha_rad += 0.05 * kDegree * normal(random);
  }
  return robot;
}

/// One number of a table, over all runs.
struct Score {
  std::string name;
  double bound = 0;
  double squares = 0;
  double circle_squares = 0;
  double sigmas = 0;
  double worst = 0;  ///< in its own standard uncertainties
  int inside = 0;
  int count = 0;

  [[nodiscard]] double rms() const { return std::sqrt(squares / count); }
  [[nodiscard]] double efficiency() const { return rms() / bound; }
  [[nodiscard]] double covered() const { return 100.0 * inside / count; }
  [[nodiscard]] double gain() const { return std::sqrt(circle_squares / squares); }
  /// a, b or alpha: what the paper's tables compare.
  [[nodiscard]] bool in_paper() const {
    return name[0] == 'a' || (name[0] == 'b' && name[1] != 'e');
  }
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

struct Result {
  std::vector<Score> scores;
  std::size_t trusted = 0;  ///< joints, over all runs
  std::size_t joints = 0;
  int runs = 0;
  int failures = 0;
  int other_relation = 0;  ///< rows that were called something else than the truth
  double samples_per_independent = 0;

  [[nodiscard]] std::vector<double> sorted(double (Score::*what)() const,
                                           bool paper = false) const {
    std::vector<double> values;
    for (const Score& score : scores)
      if (!paper || score.in_paper()) values.push_back((score.*what)());
    std::sort(values.begin(), values.end());
    return values;
  }
  [[nodiscard]] const Score& worst() const {
    return *std::max_element(scores.begin(), scores.end(), [](const Score& a, const Score& b) {
      return a.efficiency() < b.efficiency();
    });
  }
};

/// What one campaign left of an identification.
struct Found {
  bool ok = false;
  std::vector<DhEstimate> dh;
  std::vector<DhEstimate> circle_dh;
  std::vector<double> at_home_rad;  ///< the true thetas there beyond those at the home meant
  std::size_t trusted = 0;
  double samples_per_independent = 0;
};

Found identified(const Simulated& robot, const Simulated& nominal, const World& world,
                 unsigned seed) {
  const auto simulation = simulation_of(robot, world, seed);
  const auto result = identify::identify(simulation.sweeps(), campaign_of(nominal, world));
  Found found;
  found.ok =
      result.estimator == identify::Estimator::chain && result.status == identify::Status::complete;
  if (!found.ok) return found;
  found.dh = result.dh;
  found.circle_dh = result.circle_dh;
  std::vector<double> home;
  for (const auto& angle : result.home_rad) home.push_back(*angle);
  const identify::Arm standing = simulation.arm_at(home);
  for (std::size_t j = 0; j < home.size(); ++j)
    found.at_home_rad.push_back(standing.rows[j].theta_rad - robot.arm.rows[j].theta_rad);
  found.samples_per_independent = result.chain->samples_per_independent;
  for (const auto& angles : result.chain->angles)
    if (angles.trust == identify::AngleTrust::trusted) ++found.trusted;
  return found;
}

/// Calls `work` for 0 to count - 1 in all threads.
void in_parallel(const Options& options, int count, const std::function<void(int)>& work) {
  std::atomic<int> next = 0;
  std::vector<std::thread> threads;
  const unsigned wanted =
      options.threads > 0 ? options.threads : std::thread::hardware_concurrency();
  for (unsigned t = 0; t < std::max(1U, wanted); ++t)
    threads.emplace_back([&] {
      for (int i = next++; i < count; i = next++) work(i);
    });
  for (auto& thread : threads) thread.join();
}

void add(Result& total, const Found& found, const std::vector<DhEstimate>& limit) {
  static const std::array<const char*, 5> kNames = {"b", "theta", "a", "alpha", "beta"};
  const auto truth = numbers(limit);
  ++total.runs;
  total.joints += limit.size();
  if (!found.ok) {
    ++total.failures;
    return;
  }
  total.trusted += found.trusted;
  total.samples_per_independent += found.samples_per_independent;
  const auto seen = numbers(found.dh);
  const auto circles = numbers(found.circle_dh);
  if (total.scores.empty())
    for (std::size_t k = 0; k < truth.size(); ++k)
      total.scores.push_back({kNames[k % 5] + std::to_string(k / 5 + 1)});
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const std::size_t j = k / 5;
    const auto parallel = [](const DhEstimate& row) {
      return row.relation == identify::Relation::parallel ||
             row.relation == identify::Relation::coincident;
    };
    if (parallel(found.dh[j]) != parallel(limit[j])) {
      total.other_relation += k % 5 == 0;
      continue;
    }
    if (truth[k]->knowledge != Knowledge::identified || truth[k]->sigma == 0) continue;
    if (seen[k]->knowledge != Knowledge::identified) continue;
    // Theta is stated at the home that the angles tell, not at the one that was meant.
    const double expected = truth[k]->value + (k % 5 == 1 ? found.at_home_rad[j] : 0);
    Score& score = total.scores[k];
    const double error = error_of(*seen[k], expected, k);
    ++score.count;
    score.bound = truth[k]->sigma;
    score.squares += error * error;
    score.sigmas += seen[k]->sigma;
    score.worst = std::max(score.worst, std::abs(error) / seen[k]->sigma);
    score.inside += std::abs(error) <= 1.96 * seen[k]->sigma;
    if (const double circle = error_of(*circles[k], expected, k);
        circles[k]->knowledge == Knowledge::identified)
      score.circle_squares += circle * circle;
  }
}

Result run(const Options& options, const Simulated& robot, const World& world, bool believed) {
  const auto limit = bound(robot, world, believed);
  std::vector<Found> found(static_cast<std::size_t>(options.runs));
  in_parallel(options, options.runs, [&](int i) {
    found[static_cast<std::size_t>(i)] =
        identified(robot, robot, world, 1 + static_cast<unsigned>(i));
  });
  Result total;
  for (const Found& one : found) add(total, one, limit);
  std::erase_if(total.scores, [](const Score& score) { return score.count == 0; });
  return total;
}

double median(const std::vector<double>& sorted) {
  return sorted[sorted.size() / 2];
}

using bench::left;
using bench::right;

void print_header() {
  std::cout << left("", 26) << right("runs", 6) << right("failed", 8) << right("believed", 10)
            << right("rmse/bound", 22) << right("covered %", 16) << right("circle/chain", 18)
            << right("indep", 8) << "\n"
            << left("", 50) << right("worst", 16) << right("median", 8) << right("from", 8)
            << right("to", 6) << right("least", 10) << right("median", 8) << "\n";
}

void print(const std::string& title, const Options& options, const Result& result) {
  if (result.scores.empty()) {
    std::cout << title << ": all runs failed\n";
    return;
  }
  const auto efficiency = result.sorted(&Score::efficiency);
  const auto covered = result.sorted(&Score::covered);
  const auto gain = result.sorted(&Score::gain, true);
  const Score& worst = result.worst();
  std::cout << left(title, 26) << right(std::to_string(result.runs), 6)
            << right(std::to_string(result.failures), 8)
            << right(fixed(100.0 * static_cast<double>(result.trusted) /
                               static_cast<double>(result.joints),
                           1) +
                         " %",
                     10)
            << right(fixed(efficiency.back(), 3) + " " + worst.name, 16)
            << right(fixed(median(efficiency), 3), 8) << right(fixed(covered.front(), 1), 8)
            << right(fixed(covered.back(), 1), 6) << right(fixed(gain.front(), 1), 10)
            << right(fixed(median(gain), 1), 8)
            << right(fixed(result.samples_per_independent / result.runs, 2), 8) << std::endl;
  if (!options.details) return;
  for (const Score& score : result.scores)
    std::cout << "    " << left(score.name, 8) << right(std::to_string(score.count), 6) << " rmse "
              << fixed(score.rms(), 9) << " bound " << fixed(score.bound, 9) << " ratio "
              << fixed(score.efficiency(), 3) << " sigma/rmse "
              << fixed(score.sigmas / score.count / score.rms(), 3) << " covered "
              << fixed(score.covered(), 1) << " circle/chain " << fixed(score.gain(), 1) << "\n";
}

std::string degrees(int arc) {
  return std::to_string(arc) + " deg";
}

void efficiency(const Options& options) {
  std::cout
      << "\nEfficiency: KR 5 arc, six sweeps of 400 samples; controller: wobble of 0.0005 deg, "
         "four decimals;\ntracker: 0.02 mm isotropic, no angles. circle/chain: RMS errors of "
         "a, b, alpha on the same samples.\n\n";
  print_header();
  for (const int arc : {90, 30, 15}) {
    print("controller " + degrees(arc), options, run(options, kr5(arc), controller(), true));
    print("tracker " + degrees(arc), options, run(options, kr5(arc), tracker(), false));
  }
}

void correlated(const Options& options) {
  std::cout << "\nCorrelated errors: tracker, AR(1) with coefficient 0.9, sweeps of 1,500 samples; "
               "the bound is that of white noise.\n\n";
  print_header();
  for (const int arc : {90, 30}) {
    World world = tracker();
    world.noise.correlation = 0.9;
    Simulated robot = kr5(arc);
    robot.samples = 1500;
    print("AR(1) " + degrees(arc), options, run(options, robot, world, false));
  }
}

void gears(const Options& options) {
  std::cout
      << "\nTransmission error of 100 arcsec once a turn in one joint, tracker with angles; the "
         "bound is that of free angles.\n\n";
  print_header();
  for (const int arc : {90, 30, 15})
    for (const std::size_t joint : {1U, 4U}) {
      World world = tracker();
      world.angles = true;
      world.gears.joint = joint;
      world.gears.first_arcsec = 100;
      print("joint " + std::to_string(joint + 1) + ", " + degrees(arc), options,
            run(options, kr5(arc), world, false));
    }
  std::cout << "\nThe same with exact positions of four decimals: that joint's angles are not "
               "believed, the others' "
               "are.\n\n";
  print_header();
  for (const int arc : {90, 30}) {
    World world = controller();
    world.controller = false;  // whose positions would know nothing of its gears
    world.noise.decimals = world.decimals;
    world.gears.joint = 1;
    world.gears.first_arcsec = 100;
    print("exact " + degrees(arc), options, run(options, kr5(arc), world, false));
  }
}

void outliers(const Options& options) {
  std::cout << "\nOutliers: 5 % of the points off by 5 mm in any direction.\n\n";
  print_header();
  for (const int arc : {90, 30, 15}) {
    World world = tracker();
    world.noise.outlier_share = 0.05;
    print("tracker " + degrees(arc), options, run(options, kr5(arc), world, false));
    world = controller();
    world.noise.outlier_share = 0.05;
    print("controller " + degrees(arc), options, run(options, kr5(arc), world, true));
  }
}

double rms_of(const Result& result, const std::string& name, bool circle) {
  for (const Score& score : result.scores)
    if (score.name == name)
      return std::sqrt((circle ? score.circle_squares : score.squares) / score.count);
  return 0;
}

void targets(const Options& options) {
  std::cout
      << "\nA second target point, tracker: RMS error of a3. How much it gains depends on how "
         "good the first one is.\n\n"
      << left("", 46) << right("circle, one", 14) << right("chain, one", 14)
      << right("chain, two", 14) << right("circle one/chain two", 22) << "\n";
  const std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> pairs = {
      {{150, 0, 30}, {100, 200, 300}}, {{200, 0, 215}, {-60, 160, 120}}};
  const auto name = [](const Eigen::Vector3d& point) {
    return "[" + fixed(point.x(), 0) + ", " + fixed(point.y(), 0) + ", " + fixed(point.z(), 0) +
           "]";
  };
  for (const auto& [first, second] : pairs)
    for (const int arc : {90, 30}) {
      Simulated robot = kr5(arc);
      robot.targets_mm = {first};
      const Result one = run(options, robot, tracker(), false);
      robot.targets_mm = {first, second};
      const Result two = run(options, robot, tracker(), false);
      const double circle = rms_of(one, "a3", true);
      const double chain = rms_of(two, "a3", false);
      std::cout << left(name(first) + " and " + name(second) + ", " + degrees(arc), 46)
                << right(fixed(circle, 4) + " mm", 14)
                << right(fixed(rms_of(one, "a3", false), 4) + " mm", 14)
                << right(fixed(chain, 4) + " mm", 14) << right(fixed(circle / chain, 1), 22)
                << std::endl;
    }
}

void print_sigmas(const std::string& title, const Result& result) {
  double worst = 0;
  int count = 0;
  int inside = 0;
  std::string name;
  for (const Score& score : result.scores) {
    count += score.count;
    inside += score.inside;
    if (score.worst > worst) {
      worst = score.worst;
      name = score.name;
    }
  }
  std::cout << left(title, 44) << right(std::to_string(result.runs), 6)
            << right(std::to_string(result.failures), 8) << right(std::to_string(count), 10)
            << right(fixed(100.0 * inside / std::max(1, count), 1), 11)
            << right(fixed(worst, 2) + " " + name, 14)
            << right(std::to_string(result.other_relation), 12) << std::endl;
}

void arms(const Options& options) {
  std::cout << "\nOther arms: errors in the stated standard uncertainties.\n\n"
            << left("", 44) << right("runs", 6) << right("failed", 8) << right("numbers", 10)
            << right("covered %", 11) << right("worst", 14) << right("relation*", 12) << "\n";
  const int runs = std::min(options.runs, 200);
  for (const bool from_controller : {true, false}) {
    const World world = from_controller ? controller() : tracker();
    const std::string suffix = from_controller ? ", controller" : ", tracker";
    std::vector<Found> found(static_cast<std::size_t>(runs));
    Result built;
    for (const int arc : {90, 30}) {
      in_parallel(options, runs, [&](int i) {
        const auto seed = static_cast<unsigned>(i);
        found[seed] = identified(built_kr5(arc, seed), kr5(arc), world, 1000 + seed);
      });
      built = {};
      for (int i = 0; i < runs; ++i) {
        const auto seed = static_cast<unsigned>(i);
        const Simulated robot = built_kr5(arc, seed);
        add(built, found[seed], bound(robot, world, from_controller));
      }
      print_sigmas("KR 5s off by 0.5 mm, 0.05 deg, " + degrees(arc) + suffix, built);
    }
    const std::vector<std::pair<std::string, Simulated>> others = {
        {"4 joints, three parallel (SCARA)",
         arm_of({{400, 0, 300, 0}, {0, 20, 250, 0}, {0, 30, 120, 90}, {150, 0, 0, 0}})},
        {"5 joints, parallel and meeting",
         arm_of(
             {{350, 0, 0, 90}, {0, 40, 400, 0}, {0, -70, 320, 0}, {0, 60, 0, 90}, {200, 0, 0, 0}})},
        {"6 joints, all skew", arm_of({{300, 10, 100, 70},
                                       {50, 40, 400, -50},
                                       {80, -70, 120, 60},
                                       {300, 60, 60, -80},
                                       {90, 30, 40, 75},
                                       {80, 0, 0, 0}})},
        {"7 joints, each meeting the next", arm_of({{340, 0, 0, -90},
                                                    {0, 30, 0, 90},
                                                    {400, 20, 0, -90},
                                                    {0, -60, 0, 90},
                                                    {400, 10, 0, -90},
                                                    {0, 50, 0, 90},
                                                    {126, 0, 0, 0}})},
        {"4 joints, two coincident",
         arm_of({{400, 0, 200, 90}, {0, 20, 0, 0}, {0, 30, 300, 60}, {100, 0, 0, 0}})}};
    for (const auto& [name, robot] : others) {
      Options some = options;
      some.runs = runs;
      print_sigmas(name + suffix, run(some, robot, world, from_controller));
    }
  }
  std::cout << "* rows that were called parallel where the bound says skew, or the other way; not "
               "compared.\n";
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::pair<std::string, void (*)(const Options&)>> cases = {
      {"efficiency", efficiency}, {"correlated", correlated}, {"gears", gears},
      {"outliers", outliers},     {"targets", targets},       {"arms", arms}};
  CLI::App app("Accuracy of the engine on simulated campaigns", "bench_accuracy");
  Options options;
  std::vector<std::string> names;
  for (const auto& [name, what] : cases) names.push_back(name);
  app.add_option("CASE", options.cases, "What to measure (default: all)")
      ->expected(-1)
      ->check(CLI::IsMember(names));
  app.add_option("--runs", options.runs, "Campaigns of each kind")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--threads", options.threads, "0: as many as there are cores")
      ->capture_default_str();
  app.add_flag("--details", options.details, "Every number by itself");
  CLI11_PARSE(app, argc, argv);
  for (const auto& [name, what] : cases)
    if (options.cases.empty() ||
        std::find(options.cases.begin(), options.cases.end(), name) != options.cases.end())
      what(options);
}
