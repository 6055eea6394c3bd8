// Whether `sweepd history` dates and names what happened to a robot over many campaigns, how often
// its alarms are false, and how long it takes: simulated histories with a crash, a slow drift and a
// cycle of temperature. Fixed seeds; figures, not a test.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "daemon/history/history.hpp"
#include "daemon/history/history_words.hpp"
#include "daemon/results/change.hpp"
#include "daemon/results/change_test.hpp"
#include "daemon/results/result_formats.hpp"
#include "daemon/text/units.hpp"
#include "daemon/text/utc.hpp"
#include "identify/geometry/angle.hpp"
#include "tests/bench/coverage_cases.hpp"
#include "tests/bench/table.hpp"
#include "tests/daemon/history/drawn_campaigns.hpp"

using bench::left;
using bench::right;
using identify::kDegree;
using sweepd::CampaignRecord;
using sweepd::ChangeKind;
using sweepd::History;
namespace fs = std::filesystem;

namespace {

struct Options {
  int histories = 40;
  std::size_t campaigns = 160;
  std::size_t marked = 24;
  unsigned threads = 0;
  bool folders = true;
  std::optional<fs::path> folder;  ///< where to write the campaigns, and leave them
};

/// What happens to a robot over its campaigns, one a month.
struct Life {
  bool temperature = true;
  bool remounting = true;
  bool crash = true;
  bool drift = true;
  std::size_t crash_at = 80;
  std::size_t drift_from = 110;
  double crash_deg = 0.02;
  double drift_deg_a_year = 0.004;

  [[nodiscard]] std::size_t unchanged() const {
    return crash ? crash_at : drift ? drift_from : 100000;
  }
};

constexpr double kYears = 1.0 / 12;  // from one campaign to the next

std::chrono::nanoseconds time_of(std::size_t campaign) {
  using namespace std::chrono;
  const auto first = sys_days(year(2013) / January / 15).time_since_epoch();
  return first + duration_cast<nanoseconds>(
                     duration<double>(static_cast<double>(campaign) * kYears * sweepd::kYear_s));
}

/// What a campaign finds the arm's rows off by; thetas along positive rotation.
class Wandering {
 public:
  Wandering(const Life& life, std::size_t joints, std::uint32_t seed) : life_(life), random_(seed) {
    std::normal_distribution<> normal;
    for (std::size_t j = 0; j < joints; ++j) {
      zero_per_K_.push_back(0.0002 * kDegree * normal(random_));
      twist_per_K_.push_back(0.00005 * kDegree * normal(random_));
    }
  }

  /// In the order of time.
  void move(std::vector<identify::DhRow>& rows, const std::vector<int>& positive,
            std::size_t campaign) {
    std::normal_distribution<> normal;
    const double time = kYears * static_cast<double>(campaign);
    const double warmer_K =
        life_.temperature ? 7 * std::sin(2 * sweepd::kPi * time) + 2 * normal(random_) : 0;
    const double scatter = life_.remounting ? 1 : 0;
    constexpr double kExpansion = 11.5e-6;
    for (std::size_t j = 0; j < rows.size(); ++j) {
      rows[j].a_mm += rows[j].a_mm * kExpansion * warmer_K + scatter * 0.004 * normal(random_);
      rows[j].b_mm += rows[j].b_mm * kExpansion * warmer_K + scatter * 0.004 * normal(random_);
      rows[j].theta_rad +=
          positive[j] * (zero_per_K_[j] * warmer_K + scatter * 0.0005 * kDegree * normal(random_));
      rows[j].alpha_rad +=
          twist_per_K_[j] * warmer_K + scatter * 0.0002 * kDegree * normal(random_);
    }
    if (life_.crash && campaign >= life_.crash_at)
      rows[3].theta_rad += positive[3] * life_.crash_deg * kDegree;
    if (life_.drift && campaign >= life_.drift_from)
      rows[1].theta_rad += positive[1] * life_.drift_deg_a_year * kDegree * kYears *
                           static_cast<double>(campaign - life_.drift_from);
  }

 private:
  Life life_;
  std::mt19937 random_;
  std::vector<double> zero_per_K_, twist_per_K_;
};

simulation::World tracker() {
  simulation::World world;
  world.placed = true;
  world.angles = true;
  world.decimals = 4;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  return world;
}

simulation::Strokes strokes() {
  simulation::Strokes how;
  how.there_and_back = true;
  how.repeats = 2;
  how.samples = 150;
  return how;
}

/// A campaign that is simulated and identified, as result.json.
std::string measured(const simulation::Robot& robot, std::uint32_t seed) {
  const simulation::Simulation simulation(robot, strokes(), tracker(), seed);
  const auto campaign = simulation.campaign();
  sweepd::Outcome outcome;
  outcome.robot = "simulated";
  outcome.source_kind = "points";
  outcome.points = sweepd::PointCounts{};
  outcome.identification = identify::identify(simulation.sweeps(), campaign);
  outcome.positive = robot.specified.positive;
  outcome.angle_step_rad = campaign.resolution.angle_rad;
  return sweepd::result_json(outcome);
}

std::vector<CampaignRecord> draw(const sweepd::test::DrawnCampaigns& drawn, const Life& life,
                                 std::size_t campaigns, std::uint32_t seed) {
  Wandering wandering(life, drawn.rows().size(), seed);
  std::mt19937 random(seed + 1000000);
  std::vector<CampaignRecord> all;
  for (std::size_t i = 0; i < campaigns; ++i) {
    auto rows = drawn.rows();
    wandering.move(rows, drawn.record().arm->arm.positive, i);
    all.push_back(drawn.draw(rows, random));
    all.back().name = "campaign " + std::to_string(i);
    all.back().time = time_of(i);
  }
  return all;
}

struct Score {
  double tested = 0, alarms = 0;           // unmarked campaigns before anything happened
  double alone = 0;                        // alarms by the covariances of two fits, as compare has
  double dated = 0, named = 0, drift = 0;  // histories
  double invented = 0;                     // histories with a change that never was
  std::vector<double> slopes;
};

void judge(const History& history, const Life& life, Score& score) {
  for (std::size_t i = 0; i < std::min(life.unchanged(), history.campaigns.size()); ++i) {
    if (!history.campaigns[i].tested || !history.campaigns[i].state.empty()) continue;
    ++score.tested;
    score.alarms += history.campaigns[i].changed;
    const auto &one = history.campaigns[i], &first = history.campaigns[history.reference];
    score.alone +=
        sweepd::test_change(one.values - first.values, one.fit_covariance + first.fit_covariance,
                            0.05, sweepd::Smallest::left_out)
            .changed;
  }
  bool invented = false, dated = false, named = false, drifting = false;
  for (const sweepd::DatedChange& change : history.changes) {
    const std::string name = sweepd::name_of(history.numbers[change.number]);
    if (life.crash && name == "zero4" && change.kind == ChangeKind::jump &&
        change.earliest <= life.crash_at && change.latest + 1 >= life.crash_at) {
      named = true;
      dated = change.at == life.crash_at;
    } else if (life.drift && name == "zero2" && change.kind == ChangeKind::drift) {
      drifting = true;
      score.slopes.push_back(sweepd::degrees(change.size));
    } else {
      invented = true;
    }
  }
  score.named += named;
  score.dated += dated;
  score.drift += drifting;
  score.invented += invented;
}

/// `marked` of the first `spread` campaigns, or as many of the first.
Score run(const sweepd::test::DrawnCampaigns& drawn, const Life& life, const Options& options,
          std::size_t marked, std::size_t spread) {
  std::vector<Score> scores(static_cast<std::size_t>(options.histories));
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> threads;
  const unsigned wanted =
      options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency());
  for (unsigned t = 0; t < wanted; ++t)
    threads.emplace_back([&] {
      for (std::size_t h = next++; h < scores.size(); h = next++) {
        sweepd::FoundCampaigns found;
        found.records = draw(drawn, life, options.campaigns, static_cast<std::uint32_t>(h + 1));
        for (std::size_t i = 0; i < marked; ++i) {
          CampaignRecord& record = found.records[i * std::max(marked, spread) / marked];
          record.notes.push_back({record.time, "", "new", false});
        }
        judge(sweepd::history_of(std::move(found), {}), life, scores[h]);
      }
    });
  for (auto& thread : threads) thread.join();
  Score all;
  for (const Score& one : scores) {
    all.tested += one.tested;
    all.alarms += one.alarms;
    all.alone += one.alone;
    all.dated += one.dated;
    all.named += one.named;
    all.drift += one.drift;
    all.invented += one.invented;
    all.slopes.insert(all.slopes.end(), one.slopes.begin(), one.slopes.end());
  }
  return all;
}

void print(const std::string& about, const Life& life, const Options& options, std::size_t marked,
           const Score& score) {
  const double histories = options.histories;
  double mean = 0, squares = 0;
  for (const double slope : score.slopes) mean += slope / static_cast<double>(score.slopes.size());
  for (const double slope : score.slopes)
    squares += (slope - mean) * (slope - mean) / static_cast<double>(score.slopes.size());
  std::cout << left(about, 44) << right(std::to_string(marked), 7)
            << right(100 * score.alarms / std::max(1.0, score.tested), 1, 9)
            << right(100 * score.alone / std::max(1.0, score.tested), 1, 9)
            << (life.crash ? right(100 * score.named / histories, 0, 8) +
                                 right(100 * score.dated / histories, 0, 7)
                           : right("-", 8) + right("-", 7))
            << (life.drift ? right(100 * score.drift / histories, 0, 8) + right(1e3 * mean, 2, 9) +
                                 " +- " + sweepd::fixed(1e3 * std::sqrt(squares), 2)
                           : right("-", 8) + right("-", 9) + "        ")
            << right(100 * score.invented / histories, 0, 12) << std::endl;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Motors of a robot whose joint 3 wears from campaign 60 on, and a link.
void add_motors_and_link(nlohmann::ordered_json& result, const fs::path& place,
                         std::size_t campaign) {
  std::mt19937 random(static_cast<std::uint32_t>(campaign + 1));
  std::normal_distribution<> normal;
  for (int joint = 1; joint <= 6; ++joint) {
    const double worn =
        joint == 3 && campaign > 60 ? 0.002 * static_cast<double>(campaign - 60) : 0;
    result["currents"].push_back({{"joint", joint},
                                  {"speed_deg_s", 20},
                                  {"places", 90},
                                  {"friction_a", 1.2 - 0.1 * joint + worn + 0.02 * normal(random)},
                                  {"scatter_a", 0.05}});
  }
  const nlohmann::ordered_json link = {
      {"schema", "sweepd.link/1"},
      {"verdict", "good"},
      {"telegrams",
       {{"received", 60000}, {"lost", campaign % 7 == 0 ? 2 : 0}, {"late_replies", campaign % 5}}},
      {"jitter", {{"p99_9_us", 140 + 10 * normal(random)}}},
      {"latency", {{"p99_9_us", 210 + 15 * normal(random)}}}};
  std::ofstream(place / "link.json") << link;
}

/// The whole way: simulated, identified, written, read with and without the index.
void print_folders(const Options& options) {
  std::string made = (fs::temp_directory_path() / "sweepd-history-XXXXXX").string();
  if (!options.folder && mkdtemp(made.data()) == nullptr) return;
  const fs::path folder = options.folder.value_or(made);
  const Life life;
  const auto robot = coverage::robot_of("kr5", 1, 1);
  Wandering wandering(life, robot.arm.rows.size(), 1);
  std::vector<simulation::Robot> robots(options.campaigns, robot);
  for (std::size_t i = 0; i < robots.size(); ++i)
    wandering.move(robots[i].arm.rows, robots[i].arm.positive, i);
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < std::max(1U, std::thread::hardware_concurrency()); ++t)
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < robots.size(); i = next++) {
        const fs::path place = folder / sweepd::utc_name(time_of(i));
        fs::create_directories(place);
        auto result =
            nlohmann::ordered_json::parse(measured(robots[i], static_cast<std::uint32_t>(i + 1)));
        add_motors_and_link(result, place, i);
        std::ofstream(place / "result.json") << result;
        if (i < options.marked)
          sweepd::append_note(place, {time_of(i), "", std::string("new"), false});
        if (i == life.crash_at)
          sweepd::append_note(folder, {time_of(i) - std::chrono::hours(24 * 12), "collision, A4",
                                       std::nullopt, false});
      }
    });
  for (auto& thread : threads) thread.join();
  const auto timed = [&](const std::string& what, const sweepd::IndexOptions& index) {
    const auto start = std::chrono::steady_clock::now();
    auto found = sweepd::campaigns_in({folder}, index);
    const double read = seconds_since(start);
    const History history = sweepd::history_of(std::move(found), {});
    const std::string text = sweepd::history_text(history);
    std::cout << left(what, 30) << right(1e3 * seconds_since(start), 0, 7)
              << " ms, of that reading " << right(1e3 * read, 0, 4) << " ms" << std::endl;
    return text;
  };
  std::cout << '\n' << options.campaigns << " campaigns, simulated, identified and written\n";
  const std::string text = timed("from folders, index written", {});
  static_cast<void>(timed("from the index", {}));
  std::cout << '\n' << text;
  if (!options.folder) fs::remove_all(folder);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Simulated histories", "bench_history");
  Options options;
  app.add_option("--histories", options.histories, "Of each kind")->capture_default_str();
  app.add_option("--campaigns", options.campaigns, "Of each history")
      ->check(CLI::Range(130, 100000))
      ->capture_default_str();
  app.add_option("--threads", options.threads, "0: as many as there are cores")
      ->capture_default_str();
  app.add_option("--folder", options.folder, "Write the campaigns there, and leave them");
  app.add_flag("!--no-folders", options.folders, "Only drawn histories");
  CLI11_PARSE(app, argc, argv);

  const sweepd::test::DrawnCampaigns drawn(measured(coverage::robot_of("kr5", 1, 1), 1));
  std::cout << options.histories << " histories of " << options.campaigns
            << " campaigns each, one a month; the first ones marked as one state\n"
            << left("what happens", 44) << right("marked", 7) << right("alarms %", 9)
            << right("alone %", 9) << right("named %", 8) << right("dated", 7)
            << right("drift %", 8) << right("1e-3 deg/a", 17) << right("invented %", 12) << '\n';
  Life all, quiet, none;
  quiet.crash = quiet.drift = false;
  none = quiet;
  none.temperature = none.remounting = false;
  const auto print_all = [&](std::size_t marked, std::size_t spread) {
    for (const auto& [about, life] :
         {std::pair("crash, drift, temperature, remounting", all),
          std::pair("temperature, remounting", quiet), std::pair("nothing", none)})
      print(about + std::string(spread > marked ? ", spread" : ""), life, options, marked,
            run(drawn, life, options, marked, spread));
  };
  for (const std::size_t marked : {0U, 3U, 6U, 12U, 24U, 48U}) print_all(marked, 0);
  for (const std::size_t marked : {3U, 6U, 12U}) print_all(marked, 24);
  if (options.folders) print_folders(options);
}
