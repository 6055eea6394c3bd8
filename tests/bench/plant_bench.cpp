// Publishers of many robots in one program: what a broker and a collector get of a plant in an
// hour.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "daemon/plant/robot_publisher.hpp"
#include "daemon/system/log.hpp"
#include "daemon/text/utc.hpp"

namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;
using Steady = std::chrono::steady_clock;
namespace fs = std::filesystem;

struct BenchOptions {
  std::string broker;
  std::string result;
  std::string folder;
  std::size_t robots = 1000;
  std::size_t minutes = 60;
  double per_second = 20'000;  ///< states; else the broker has them in memory
};

/// What /api/state tells of a robot that streams at 4 ms, so many seconds after the start.
Json state_of(const std::string& robot, std::size_t second) {
  const auto telegrams = 250 * second;
  const auto at = std::chrono::sys_days(std::chrono::year(2026) / 1 / 1).time_since_epoch() +
                  std::chrono::seconds(second);
  return {{"schema", "sweepd.state/1"},
          {"at", sweepd::utc_text(at)},
          {"version", "bench"},
          {"started", "2026-01-01T00:00:00.000Z"},
          {"phase", "serving"},
          {"robots",
           {{{"robot", robot},
             {"listen", "0.0.0.0:49152"},
             {"transport", "UDP"},
             {"stream", {{"session", "20260101T000000Z"}, {"reply_latency", {{"max_us", 312.5}}}}},
             {"telegrams", {{"received", telegrams}, {"lost", second / 600}, {"duplicated", 0}}},
             {"replies", {{"sent", telegrams}, {"in_time", telegrams}, {"late", second / 1200}}},
             {"recording", {{"paused", false}, {"bytes", telegrams * 800}}},
             {"sweeps", Json::array()},
             {"result", nullptr}}}}};
}

int run(const BenchOptions& options) {
  std::ifstream stream(options.result, std::ios::binary);
  Json result = Json::parse(stream);
  std::vector<std::unique_ptr<sweepd::RobotPublisher>> robots;
  std::vector<std::string> names;
  const fs::path folder(options.folder);
  sweepd::BrokerSettings broker;
  broker.address = sweepd::parse_broker(options.broker).value();
  for (std::size_t i = 0; i < options.robots; ++i) {
    names.push_back("robot-" + std::to_string(i));
    robots.push_back(std::make_unique<sweepd::RobotPublisher>(
        sweepd::RobotPublisher::Options{{"bench", "cell-" + std::to_string(i / 10), names[i]},
                                        broker,
                                        folder / "spool",
                                        folder / "output" / names[i]}));
  }
  const auto begin = Steady::now();
  for (auto connected = 0U; connected < robots.size();) {
    connected = 0;
    for (auto& robot : robots) {
      robot->turn(Steady::now(), false);
      connected += robot->connected() ? 1U : 0U;
    }
    std::this_thread::sleep_for(10ms);
    if (Steady::now() - begin > 300s) throw std::runtime_error("not all connect");
  }
  std::printf("connected %zu robots in %.1f s\n", robots.size(),
              std::chrono::duration<double>(Steady::now() - begin).count());

  // An hour: a state of each robot every 10 s; each robot ends a campaign at another time of it.
  const auto start = Steady::now();
  const std::size_t rounds = options.minutes * 6;
  std::size_t states = 0, ended = 0;
  for (std::size_t round = 0; round < rounds; ++round) {
    const auto now = start + 10s * static_cast<int>(round);  // as the publishers see it
    for (; ended < robots.size() * (round + 1) / rounds; ++ended) {
      const auto session = folder / "output" / names[ended] / "20260101T000000Z";
      fs::create_directories(session);
      result["robot"] = names[ended];
      std::ofstream(session / "result.json") << result.dump(2) << '\n';
      std::ofstream(session / "run.json")
          << R"({"command": "run", "ended": "2026-01-01T01:00:00Z"})";
      robots[ended]->turn(now, true);
    }
    for (std::size_t i = 0; i < robots.size(); ++i, ++states) {
      robots[i]->hear(state_of(names[i], 10 * round), {}, now);
      const auto due =
          start + std::chrono::duration_cast<Steady::duration>(std::chrono::duration<double>(
                      static_cast<double>(states) / options.per_second));
      if (due > Steady::now()) std::this_thread::sleep_until(due);
    }
    for (auto& robot : robots) robot->turn(now, false);
  }
  const double took = std::chrono::duration<double>(Steady::now() - start).count();
  std::printf("%zu states and %zu results in %.1f s: %.0f messages a second\n", states, ended, took,
              static_cast<double>(states + 2 * ended) / took);
  std::fflush(stdout);
  const auto last = Steady::now();
  while (std::any_of(robots.begin(), robots.end(), [](auto& robot) { return robot->busy(); })) {
    for (auto& robot : robots) robot->turn(Steady::now(), false);
    std::this_thread::sleep_for(10ms);
    if (Steady::now() - last > 300s) throw std::runtime_error("not all is acknowledged");
  }
  std::printf("all acknowledged %.1f s later\n",
              std::chrono::duration<double>(Steady::now() - last).count());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  BenchOptions options;
  CLI::App app("Publishers of many robots in one program");
  app.add_option("--broker", options.broker)->required();
  app.add_option("--result", options.result, "A result.json")->required();
  app.add_option("--folder", options.folder)->required();
  app.add_option("--robots", options.robots);
  app.add_option("--minutes", options.minutes);
  app.add_option("--per-second", options.per_second);
  CLI11_PARSE(app, argc, argv);
  sweepd::log_at_once();
  try {
    return run(options);
  } catch (const std::exception& problem) {
    std::cerr << "bench_plant: " << problem.what() << '\n';
    return 1;
  }
}
