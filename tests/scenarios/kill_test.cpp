#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
#include <random>
#include <set>
#include <thread>

#include <nlohmann/json.hpp>

#include "daemon/text/numbers.hpp"
#include "tests/catch.hpp"
#include "tests/scenarios/recorded.hpp"
#include "tests/scenarios/streamer.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using namespace std::chrono_literals;
using Json = nlohmann::json;
using Clock = Streamer::Clock;
namespace fs = std::filesystem;

namespace {

int kills() {
  const char* const wanted = std::getenv("SWEEPD_KILLS");
  return wanted == nullptr ? 6 : std::max(1, std::atoi(wanted));
}

std::string output_of(const std::string& command) {
  std::string output;
  std::FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::array<char, 4096> part{};
  while (const auto size = std::fread(part.data(), 1, part.size(), pipe))
    output.append(part.data(), size);
  pclose(pipe);
  return output;
}

/// That tcpdump finds as many packets as there are; a cut end may be told.
void check_with_tcpdump(const Recorded& recording) {
  static const bool installed = output_of("tcpdump --version").find("libpcap") != std::string::npos;
  if (!installed) return;
  std::uint64_t packets = 0;
  for (const auto& trace : recording.traces) {
    const auto output = output_of("tcpdump -nn -q -t -r " + trace.string());
    INFO(output.substr(0, 500));
    for (std::size_t at = 0; (at = output.find("\nIP ", at)) != std::string::npos; ++at) ++packets;
  }
  CHECK(packets == recording.telegrams.size() + recording.replies);
}

/// What the kill left of one session. Returns whether it had ended before.
bool check_session(const fs::path& session, const Recorded& recording, const fs::path& config,
                   const fs::path& replayed) {
  INFO(session);
  bool ended = false;
  if (fs::exists(session / "run.json"))
    ended = Json::parse(content(session / "run.json")).contains("ended");
  if (ended) REQUIRE(fs::exists(session / "result.json"));
  if (fs::exists(session / "result.json"))
    CHECK(Json::parse(content(session / "result.json"))["schema"] == "sweepd.result/1");
  if (recording.traces.empty()) {
    CHECK_FALSE(ended);
    return ended;
  }
  CHECK(std::is_sorted(recording.telegrams.begin(), recording.telegrams.end()));
  check_with_tcpdump(recording);

  std::vector<std::string> arguments{"replay"};
  for (const auto& trace : recording.traces) arguments.push_back(trace.string());
  for (const auto& word : {"--config", config.c_str(), "--output", replayed.c_str(), "--quiet"})
    arguments.emplace_back(word);
  const auto run = run_sweepd(arguments);
  INFO(run.errors);
  CHECK(run.code <= 1);  // 1: not one axis
  CHECK(Json::parse(content(replayed / "result.json"))["source"]["telegrams"] ==
        recording.telegrams.size());
  if (ended) {
    CHECK(recording.notes.empty());
    CHECK(content(replayed / "result.json") == content(session / "result.json"));
    CHECK(recording.samples == recording.telegrams.size());
  }
  return ended;
}

}  // namespace

TEST_CASE("kill -9 at any moment leaves traces that open and replay, less than a second short",
          "[kill]") {
  const TemporaryFolder folder;
  // About 1 MB/s, so that files change in the middle; and silence now and then, so that sessions
  // end and results are written.
  Daemon daemon(folder.path(), {"silence_ms = 100\n[robot.recording]\nrotate_bytes = 1048576\n"
                                "keep_free_bytes = 0\n",
                                {}});
  Streamer robot(daemon.port(), {4ms, 3000, [](std::uint64_t cycle) { return cycle % 460 < 400; }});
  std::mt19937 random(4669);
  std::set<fs::path> checked;
  std::map<bool, int> sessions;  // by whether they had ended
  std::size_t parts = 0;
  Clock::duration worst{};
  const int all = kills();
  for (int k = 0; k < all; ++k) {
    if (k > 0) daemon.start();
    INFO("kill " << k);
    std::this_thread::sleep_for(std::chrono::milliseconds(20 + random() % 1500));
    const auto killed = Clock::now();
    daemon.kill();

    std::set<std::uint64_t> kept;
    for (const auto& entry : fs::directory_iterator(folder / "output/kr5-arc")) {
      if (!checked.insert(entry.path()).second) continue;
      const auto recording = recorded(entry.path(), daemon.port());
      kept.insert(recording.telegrams.begin(), recording.telegrams.end());
      parts += recording.traces.size();
      const auto replayed = folder / ("replayed-" + entry.path().filename().string());
      ++sessions[check_session(entry.path(), recording, daemon.config(), replayed)];
    }
    if (kept.empty()) continue;  // killed before anything was there to be lost
    for (const auto& telegram : robot.sent()) {
      if (telegram.ipoc < *kept.begin() || telegram.at > killed || kept.contains(telegram.ipoc))
        continue;
      CHECK(telegram.ipoc > *kept.rbegin());  // nothing is missing in the middle
      worst = std::max(worst, killed - telegram.at);
    }
  }
  CHECK(worst < 1s);
  CHECK(sessions[false] > 0);
  std::cout << "kill -9, " << all << " times: " << sessions[true] << " sessions had ended, "
            << sessions[false] << " were cut, in " << parts << " traces; at most "
            << sweepd::fixed(std::chrono::duration<double, std::milli>(worst).count(), 0)
            << " ms missing\n";
}
