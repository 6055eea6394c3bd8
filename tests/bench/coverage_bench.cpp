// Whether the stated uncertainties hold: campaigns of arms that are known exactly, with the errors
// that real arms, controllers and devices make. For each case, arm, arc and number of samples the
// share of DH numbers inside their 95 % interval, and how large errors are beside those of an
// earlier estimator on the same campaigns (coverage_reference.csv). Fixed seeds; figures, not a
// test. What misses its aim is marked with an asterisk.

#include <algorithm>
#include <atomic>
#include <iostream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <time.h>

#include "daemon/stream/kept_sweeps.hpp"
#include "daemon/text/numbers.hpp"
#include "tests/bench/coverage_cases.hpp"
#include "tests/bench/coverage_reference.hpp"
#include "tests/bench/coverage_score.hpp"
#include "tests/bench/table.hpp"

using namespace coverage;
using bench::left;
using bench::right;
using sweepd::fixed;

namespace {

constexpr double kMostRatio = 1.1;  // of errors, to the reference's
constexpr double kMostAccused = 1;  // percent of runs with perfect gears
constexpr double kLeastFound = 95;  // percent of runs with a gear that is not

struct Options {
  int runs = 200;
  unsigned threads = 0;
  std::vector<std::string> cases;
  std::vector<std::string> arms = {"kr5", "iiwa"};
  std::vector<int> arcs = {90, 30};
  std::vector<int> samples = {300, 1500};
  std::string record;
};

double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

Outcome run(const Case& what, const Cell& cell, std::uint32_t seed) {
  simulation::Strokes strokes = what.strokes;
  strokes.arc_deg = cell.arc_deg;
  strokes.samples = cell.samples;
  const simulation::Simulation simulation(robot_of(cell.arm, what.targets, seed, what.as_drawn),
                                          strokes, what.world, seed);
  auto sweeps = simulation.sweeps();
  if (what.kept < 1) {
    double memory = 0;
    for (const identify::Sweep& sweep : sweeps)
      memory += static_cast<double>(sweep.samples->size() + sweepd::KeptSweeps::kOfSweep);
    sweepd::KeptSweeps kept(static_cast<std::size_t>(what.kept * memory));
    for (const identify::Sweep& sweep : sweeps) kept.keep(sweep);
    sweeps = kept.sweeps();
  }
  const double start = cpu_ms();
  const auto found = identify::identify(std::move(sweeps), simulation.campaign());
  const double spent = cpu_ms() - start;
  Outcome outcome = judged(simulation, found);
  outcome.milliseconds = spent;
  return outcome;
}

std::vector<Outcome> run_all(const Case& what, const Cell& cell, const Options& options) {
  std::vector<Outcome> outcomes(static_cast<std::size_t>(options.runs));
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> threads;
  const unsigned wanted =
      options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency());
  for (unsigned t = 0; t < wanted; ++t)
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < outcomes.size(); i = next++)
        outcomes[i] = run(what, cell, static_cast<std::uint32_t>(i + 1));
    });
  for (auto& thread : threads) thread.join();
  return outcomes;
}

/// An asterisk where a figure is not what it should be.
std::string marked(const std::string& figure, bool holds, std::size_t width) {
  return right(figure + (holds ? " " : "*"), width);
}

void print_header(const Reference& reference) {
  std::cout << "Aims: covered as each case says; rmse / reference "
            << (reference.commit.empty() ? "(none)" : "(" + reference.commit + ")")
            << " <= " << fixed(kMostRatio, 1)
            << "; chain always; gears accused (transmission error, backlash) in "
            << "<= " << fixed(kMostAccused, 0)
            << " % of runs where they are perfect, >= " << fixed(kLeastFound, 0)
            << " % where the case is about them.\nknown: numbers identified, a run; c/d/p/f: runs "
               "complete, doubtful, partial, failed; rmse: median over the arm's numbers.\n\n"
            << left("", 29) << right("runs", 5) << right("covered %", 10) << right("rms z", 8)
            << right("worst %", 16) << right("a um", 9) << right("b um", 9) << right("alpha \"", 11)
            << right("theta \"", 11) << right("rmse/ref", 14) << right("no chain", 10)
            << right("c/d/p/f", 12) << right("trans %", 9) << right("backl %", 9)
            << right("known", 7) << right("ms", 8) << "\n";
}

/// The kind of number whose errors grew most, beside the reference's on as many runs.
std::string ratio(const Cell& cell, const std::vector<Outcome>& outcomes,
                  const Reference& reference, bool& holds) {
  holds = true;
  const auto* line = reference.find(cell);
  if (line == nullptr || line->runs > outcomes.size()) return "-";
  const Errors now = errors(outcomes, line->runs);
  double worst = 0;
  std::string kind;
  for (std::size_t k = 0; k < kKinds.size(); ++k) {
    if (!now.rms[k] || !line->errors.rms[k]) continue;
    const double here = *now.rms[k] / *line->errors.rms[k];
    if (here <= worst) continue;
    worst = here;
    kind = kKinds[k];
  }
  holds = worst <= kMostRatio;
  return fixed(worst, 2) + " " + kind;
}

void print(const Case& what, const Cell& cell, const std::vector<Outcome>& outcomes,
           const Reference& reference) {
  const Score all = score(outcomes);
  const Errors sizes = errors(outcomes, outcomes.size());
  using Gears = Aim::Gears;
  const Gears gears = what.aim.gears;
  const auto accusation = [&](double share, Gears wanted) {
    const bool holds =
        gears == wanted ? share >= kLeastFound : gears != Gears::perfect || share <= kMostAccused;
    return marked(fixed(share, 0), holds, 9);
  };
  const auto size = [&](std::size_t kind, std::size_t width) {
    const double unit = kind < 2 ? 1000 : 3600;
    return right(sizes.rms[kind] ? fixed(unit * *sizes.rms[kind], 2) : "-", width);
  };
  bool ratio_holds = true;
  const std::string beside = ratio(cell, outcomes, reference, ratio_holds);
  std::cout << left("  " + cell.arm + ", " + std::to_string(cell.arc_deg) + " deg, " +
                        std::to_string(cell.samples),
                    29)
            << right(std::to_string(outcomes.size()), 5)
            << marked(fixed(all.covered, 1),
                      all.covered >= what.aim.least_covered && all.covered <= what.aim.most_covered,
                      10)
            << right(fixed(all.rms_z, 2), 8)
            << right(fixed(all.worst_covered, 0) + " " + left(all.worst, 7), 16) << size(0, 9)
            << size(1, 9) << size(2, 11) << size(3, 11) << marked(beside, ratio_holds, 14)
            << marked(std::to_string(all.unconverged), all.unconverged == 0, 10)
            << right(std::to_string(all.statuses[0]) + "/" + std::to_string(all.statuses[1]) + "/" +
                         std::to_string(all.statuses[2]) + "/" + std::to_string(all.statuses[3]),
                     12)
            << accusation(all.transmission, Gears::with_large)
            << accusation(all.backlash, Gears::with_backlash) << right(fixed(all.known, 1), 7)
            << right(fixed(all.milliseconds, 1), 8) << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Whether stated uncertainties hold, on simulated campaigns", "bench_coverage");
  Options options;
  std::vector<std::string> names;
  for (const Case& one : all_cases()) names.push_back(one.name);
  app.add_option("CASE", options.cases, "What to simulate (default: all)")
      ->expected(-1)
      ->check(CLI::IsMember(names));
  app.add_option("--runs", options.runs, "Campaigns of each kind")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--arm", options.arms, "Arms, separated by commas")
      ->delimiter(',')
      ->check(CLI::IsMember(all_arms()))
      ->capture_default_str();
  app.add_option("--arc", options.arcs, "Degrees that each joint sweeps")
      ->delimiter(',')
      ->check(CLI::Range(6, 180))
      ->capture_default_str();
  app.add_option("--samples", options.samples, "A sweep")
      ->delimiter(',')
      ->check(CLI::Range(10, 100000))
      ->capture_default_str();
  app.add_option("--threads", options.threads, "0: as many as there are cores")
      ->capture_default_str();
  app.add_option("--record", options.record,
                 "Write the errors as the reference, under the name of this commit");
  CLI11_PARSE(app, argc, argv);

  const std::string path = std::string(SWEEPD_SOURCE_DIR) + "/tests/bench/coverage_reference.csv";
  const Reference reference = read_reference(path);
  // What is not measured now stays, if it is of the same commit.
  Reference recorded{options.record, {}};
  if (reference.commit == options.record) recorded.lines = reference.lines;
  print_header(reference);
  for (const Case& what : all_cases()) {
    if (!options.cases.empty() &&
        std::find(options.cases.begin(), options.cases.end(), what.name) == options.cases.end())
      continue;
    std::cout << what.name << ": " << what.about << " (" << fixed(what.aim.least_covered, 0)
              << " to " << fixed(what.aim.most_covered, 0) << " % inside)\n";
    for (const auto& arm : options.arms)
      for (const int arc : options.arcs)
        for (const int samples : options.samples) {
          const Cell cell{what.name, arm, arc, samples};
          const auto outcomes = run_all(what, cell, options);
          print(what, cell, outcomes, reference);
          std::erase_if(recorded.lines, [&](const auto& line) { return line.cell == cell; });
          recorded.lines.push_back({cell, outcomes.size(), errors(outcomes, outcomes.size())});
        }
    if (!options.record.empty() && !write_reference(path, recorded)) {
      std::cerr << "bench_coverage: " << path << " cannot be written\n";
      return 1;
    }
  }
}
