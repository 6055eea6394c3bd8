#include <algorithm>
#include <csignal>

#include <nlohmann/json.hpp>

#include "tests/catch.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("a live campaign and the replay of its own recording leave the same files",
          "[live_equals_replay]") {
  const TemporaryFolder folder;
  Daemon daemon(folder.path());
  const auto simulated = run_sweepd(
      {"simulate", "--robot", (kConfig / "robots/kr5_arc.toml").string(), "--plan",
       write_short_plan(folder).string(), "--to", daemon.address(), "--check", "sweepd"});
  INFO(simulated.out << simulated.errors);
  // Whether replies were in time is up to this machine; that they were right is not.
  CHECK_THAT(simulated.out, ContainsSubstring("played to its end") &&
                                ContainsSubstring("replies refused                  0"));
  daemon.process().signal(SIGTERM);
  REQUIRE(daemon.process().wait() == 0);
  INFO(daemon.process().errors());
  const auto session = daemon.session();

  const auto result = nlohmann::json::parse(content(session / "result.json"));
  CHECK(result["status"] == "complete");
  CHECK(result["source"]["lost"].get<std::uint64_t>() <=
        figure(simulated.out, "\ncycles overslept "));
  CHECK(result["source"]["malformed"] == 0);
  for (const auto& joint : result["joints"]) CHECK(joint["sweeps"].size() == 2);  // there and back

  const auto replayed =
      run_sweepd({"replay", (session / "trace.pcap").string(), "--config", daemon.config().string(),
                  "--output", (folder / "replayed").string()});
  CHECK(replayed.code == 0);
  CHECK(replayed.errors.empty());
  for (const char* name : {"result.json", "dh.csv", "sweeps.csv", "report.txt", "samples.csv"}) {
    INFO(name);
    CHECK(content(session / name) == content(folder / "replayed" / name));
  }

  const auto exported = run_sweepd({"export", (session / "trace.pcap").string(), "--csv", "-"});
  CHECK(exported.code == 0);
  CHECK_THAT(exported.out, Catch::Matchers::StartsWith("t_s,ipoc,RIst.X,"));
  CHECK(static_cast<std::uint64_t>(std::count(exported.out.begin(), exported.out.end(), '\n')) ==
        1 + result["source"]["telegrams"].get<std::uint64_t>());
}
