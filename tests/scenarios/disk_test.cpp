#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <iostream>

#include <nlohmann/json.hpp>

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

std::size_t occurrences(const std::string& text, const std::string& words) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(words, at)) != std::string::npos; ++at) ++count;
  return count;
}

std::uint64_t replies(const std::vector<Streamer::Sent>& sent) {
  return static_cast<std::uint64_t>(std::count_if(
      sent.begin(), sent.end(), [](const auto& each) { return each.answered_after.has_value(); }));
}

fs::path only_entry(const fs::path& folder) {
  fs::path found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    REQUIRE(found.empty());
    found = entry.path();
  }
  return found;
}

/// That everything that was sent is recorded or counted as missing for `reason`. Returns how many
/// datagrams are missing.
std::uint64_t check_counts(const fs::path& session, std::uint16_t port,
                           const std::vector<Streamer::Sent>& sent, const std::string& reason) {
  const auto run = Json::parse(content(session / "run.json"));
  const auto& recording = run["recording"];
  INFO(run.dump(2));
  const auto kept = recorded(session, port);
  CHECK(kept.notes.empty());
  CHECK(recording["datagrams"] == kept.telegrams.size() + kept.replies);
  CHECK(recording["samples"] == kept.samples);
  const auto& missing = recording["not_recorded"][reason];
  const auto lost = missing["datagrams"].get<std::uint64_t>();
  CHECK(kept.telegrams.size() + kept.replies + lost == sent.size() + replies(sent));
  CHECK(kept.samples + missing["samples"].get<std::uint64_t>() == sent.size());
  const std::string other = reason == "disk" ? "memory_full" : "disk";
  CHECK(recording["not_recorded"][other]["datagrams"] == 0);

  const auto result = Json::parse(content(session / "result.json"));
  CHECK(result["source"]["kind"] == (lost == 0 ? "trace" : "live"));
  CHECK(result["source"]["telegrams"] == sent.size());
  const auto& link = run["since_start_of_sweepd"];
  CHECK(link["answered"] == replies(sent));
  CHECK(link["answered"].get<std::uint64_t>() + link["superseded"].get<std::uint64_t>() ==
        sent.size());
  CHECK(link["overflows"] == 0);
  return lost;
}

/// Waits until so many more telegrams were sent.
bool streams(const Streamer& robot, std::size_t more) {
  const auto until = robot.sent().size() + more;
  return eventually([&] { return robot.sent().size() >= until; });
}

void check_answers(const char* when, const std::vector<Streamer::Sent>& sent,
                   Clock::time_point from, Clock::time_point to) {
  const auto during = answers(sent, from, to);
  const auto before = answers(sent, sent.front().at, from);
  std::cout << "before: " << before.text() << "\n" << when << ": " << during.text() << '\n';
  // A reply that waited for the disk would take seconds. Of a machine with other work more than
  // 20 ms is not expected in one of a hundred cycles.
  CHECK(during.telegrams > 0);
  CHECK(during.latency.quantile(0.99) < 20ms);
}

/// A small disk of the daemon's own, at its output folder.
SweepdProcess::Launch on_small_disk(const fs::path& output) {
  const std::string script = "mount -t tmpfs -o size=16m sweepd-test \"$0\" && exec \"$@\"";
  return {{"unshare", "-m", "sh", "-c", script, output.string()}, {}};
}

bool small_disks_are_possible(const fs::path& folder) {
  const std::string command =
      "unshare -m mount -t tmpfs -o size=16m sweepd-test '" + folder.string() + "' >/dev/null 2>&1";
  return std::system(command.c_str()) == 0;
}

void fill_up_to(const fs::path& disk, std::uint64_t free) {
  std::ofstream filler(disk / "filler", std::ios::binary | std::ios::app);
  while (fs::space(disk).available > free) {
    const std::string block(4096, 'x');
    if (!filler.write(block.data(), static_cast<std::streamsize>(block.size())).flush()) break;
  }
}

}  // namespace

TEST_CASE("a full disk stops the recording, not the replies, until there is room again",
          "[disk_full]") {
  const TemporaryFolder folder;
  if (!small_disks_are_possible(folder.path())) {
    std::cout << "not permitted here: a mount in a namespace of its own\n";
    return;
  }
  // Once the room to be kept free, once the last byte.
  for (const std::string keep_free : {"2097152", "0"}) {
    INFO("keep_free_bytes " << keep_free);
    const TemporaryFolder own;
    fs::create_directory(own / "output");
    Daemon daemon(
        own.path(),
        {"silence_ms = 300\n[robot.recording]\nmemory_bytes = 1048576\nkeep_free_bytes = " +
             keep_free + "\n",
         on_small_disk(own / "output")});
    // As the daemon sees it.
    const auto disk = fs::path("/proc") / std::to_string(daemon.process().id()) / "root" /
                      (own / "output").relative_path();
    Streamer robot(daemon.port(), {4ms, 6000});
    REQUIRE(streams(robot, 150));
    const auto filled = Clock::now();
    fill_up_to(disk, keep_free == "0" ? 0 : 1 << 20);
    const auto said = [&](const char* words) {
      return eventually([&] { return daemon.process().errors().find(words) != std::string::npos; });
    };
    REQUIRE(said("recording pauses, replies go on: "));
    REQUIRE(streams(robot, 250));  // more than memory holds
    const auto emptied = Clock::now();
    fs::remove(disk / "filler");
    REQUIRE(said("recording goes on"));
    REQUIRE(streams(robot, 50));
    const auto sent = robot.stop();

    // The disk ends with the daemon: what it holds is kept.
    const auto session = only_entry(disk / "kr5-arc");
    REQUIRE(said("result "));
    REQUIRE(
        eventually([&] { return Json::parse(content(session / "run.json")).contains("ended"); }));
    const auto lost = check_counts(session, daemon.port(), sent, "disk");
    CHECK(lost > 0);
    CHECK(Json::parse(content(session / "run.json"))["recording"]["paused"] == 1);
    daemon.process().signal(SIGTERM);
    CHECK(daemon.process().wait() == 0);
    const auto log = daemon.process().errors();
    INFO(log);
    CHECK(occurrences(log, "recording pauses") == 1);
    CHECK(occurrences(log, "recording goes on") == 1);
    CHECK(occurrences(log, "has room again: " + std::to_string(lost) + " datagrams and ") == 1);
    CHECK(occurrences(log, "lacks " + std::to_string(lost) + " datagrams and ") == 1);
    CHECK(occurrences(log, "memory for the recording is full") == 0);
    check_answers("disk full", sent, filled, emptied);
  }
}

TEST_CASE("a disk that stands still for 5 s delays no reply, and costs what memory cannot hold",
          "[disk_stopped]") {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  std::cout << "not permitted here: a library before a sanitizer's\n";
#else
  const TemporaryFolder folder;
  const auto marker = folder / "stopped";
  const SweepdProcess::Launch launch{
      {},
      {std::string("LD_PRELOAD=") + SLOW_DISK_LIBRARY, "SWEEPD_STOPPED_DISK=" + marker.string()}};
  const TemporaryFolder own_folder;
  const TemporaryFolder small_folder;
  const std::string settings = "silence_ms = 300\n[robot.recording]\nkeep_free_bytes = 0\n";
  Daemon roomy(own_folder.path(), {settings, launch});
  Daemon small(small_folder.path(), {settings + "memory_bytes = 1048576\n", launch});
  Streamer roomy_robot(roomy.port(), {});
  Streamer small_robot(small.port(), {4ms, 6000});
  REQUIRE(streams(roomy_robot, 150));
  const auto stopped = Clock::now();
  static_cast<void>(folder.write("stopped", ""));
  REQUIRE(streams(roomy_robot, 1250));
  const auto going_on = Clock::now();
  CHECK(going_on - stopped > 4900ms);
  fs::remove(marker);
  REQUIRE(streams(roomy_robot, 100));

  for (auto* const each : {&roomy, &small}) {
    const bool is_small = each == &small;
    INFO((is_small ? "1 MiB of memory" : "enough memory"));
    const auto sent = (is_small ? small_robot : roomy_robot).stop();
    each->process().signal(SIGTERM);
    CHECK(each->process().wait() == 0);
    const auto log = each->process().errors();
    INFO(log);
    const auto lost = check_counts(each->session(), each->port(), sent, "memory_full");
    CHECK((lost > 0) == is_small);
    CHECK(occurrences(log, "memory for the recording is full") == (is_small ? 1 : 0));
    CHECK(occurrences(log, "were not recorded, as the disk") == (is_small ? 1 : 0));
    CHECK(occurrences(log, "recording pauses") == 0);
    check_answers(is_small ? "disk stopped, 1 MiB of memory" : "disk stopped", sent, stopped,
                  going_on);
  }
#endif
}
