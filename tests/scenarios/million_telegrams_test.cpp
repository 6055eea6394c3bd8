// As many telegrams as wanted go to the real service over a faulty network, and its counts are
// compared with what went out: 20,000 telegrams, or as many as SWEEPD_TELEGRAMS says.

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "daemon/commands/replay_command.hpp"
#include "daemon/service/robot_service.hpp"
#include "rsi/capture/capture_reader.hpp"
#include "rsi/capture/capture_writer.hpp"
#include "rsi/telegram/ipoc.hpp"
#include "rsi/telegram/reply.hpp"
#include "tests/catch.hpp"
#include "tests/scenarios/faulty_campaign.hpp"

using namespace sweepd::test;
using rsi::ReplyFault;
using Json = nlohmann::json;

namespace {

std::uint64_t wanted_telegrams() {
  const char* const text = std::getenv("SWEEPD_TELEGRAMS");
  return text == nullptr ? 20'000 : std::stoull(text);
}

Json replay(const std::filesystem::path& trace, const std::filesystem::path& folder) {
  sweepd::ReplayOptions options;
  options.traces = {trace};
  options.config = kConfig / "sweepd.toml";
  options.output = folder;
  options.quiet = true;
  REQUIRE(sweepd::replay(options) == 0);
  return Json::parse(content(folder / "result.json"));
}

/// A replay of the same telegrams as they were before the wire spoilt them, one every 4 ms: of
/// those that are `wanted`, by number.
Json replay_clean(const std::vector<bool>& wanted, const std::filesystem::path& folder) {
  constexpr std::chrono::seconds kStart{1'735'689'600};
  rsi::Datagram datagram{kStart,
                         *rsi::parse_endpoint("192.168.1.20:49153"),
                         *rsi::parse_endpoint("192.168.1.10:49152"),
                         {},
                         false};
  RestlessController controller(datagram.destination);
  rsi::Reply reply(rsi::EthernetConfig::load(kEthernet));
  const auto trace = folder.string() + ".pcap";
  {
    rsi::CaptureWriter capture(trace);
    for (std::size_t k = 0; k < wanted.size(); ++k, datagram.time += kCycle) {
      if (controller.next() && k > 0) {
        controller.restart();
        ++datagram.source.port;
      }
      datagram.payload = controller.telegram();
      if (wanted[k]) capture.write(datagram);
      const auto answer = reply.with_ipoc(rsi::find_ipoc(datagram.payload));
      controller.rsi().on_reply(answer, datagram.destination, {});
    }
    REQUIRE(capture.flush());
  }
  return replay(trace, folder);
}

/// A replay of the recorded trace as if each of its telegrams had come when the same one of the
/// clean trace does.
Json replay_at_due_times(const std::filesystem::path& recorded, const std::filesystem::path& clean,
                         const std::filesystem::path& folder) {
  constexpr std::size_t kBack = 2, kAhead = 50;  // telegrams that are swapped, or lost in a row
  std::vector<std::pair<std::string, rsi::Timestamp>> due;
  rsi::CaptureReader clean_reader(clean);
  while (const auto datagram = clean_reader.next())
    due.emplace_back(rsi::find_ipoc(datagram->payload), datagram->time);
  const auto trace = folder.string() + ".pcap";
  rsi::CaptureReader reader(recorded);
  rsi::CaptureWriter writer(trace);
  std::size_t at = 0;
  auto time = due.front().second;
  while (auto datagram = reader.next()) {
    const std::string_view ipoc = rsi::find_ipoc(datagram->payload);
    const auto begin = due.begin() + static_cast<std::ptrdiff_t>(at - std::min(at, kBack));
    const auto end = due.begin() + static_cast<std::ptrdiff_t>(std::min(at + kAhead, due.size()));
    const auto one =
        std::find_if(begin, end, [&](const auto& other) { return other.first == ipoc; });
    if (one != end) {
      at = static_cast<std::size_t>(one - due.begin());
      time = std::max(time, one->second);
    }
    datagram->time = time;
    writer.write(*datagram);
  }
  CHECK(at + kAhead > due.size());
  REQUIRE(writer.flush());
  return replay(trace, folder);
}

void check_samples(const std::filesystem::path& found, const std::filesystem::path& clean,
                   const std::vector<bool>& came) {
  std::ifstream found_file(found), clean_file(clean);
  std::string row, clean_row;
  const auto all_but_time = [](const std::string& line) { return line.substr(line.find(',')); };
  REQUIRE(std::getline(found_file, row));
  REQUIRE(std::getline(clean_file, clean_row));
  CHECK(row == clean_row);
  std::uint64_t differing = 0;
  for (const bool here : came) {
    REQUIRE(std::getline(clean_file, clean_row));
    if (!here) continue;
    REQUIRE(std::getline(found_file, row));
    differing += all_but_time(row) != all_but_time(clean_row);
  }
  CHECK(differing == 0);
  CHECK_FALSE(std::getline(found_file, row));
}

bool memory_was_full(const Json& result) {
  for (const auto& warning : result["warnings"])
    if (warning["code"] == "memory_limit") return true;
  return false;
}

/// Of samples whose times are alike: they tell where joints begin to move.
void check_sweeps(const Json& found, const Json& clean) {
  // Lost samples let the memory be full a little later: then other rounds of the program are kept.
  const bool full = memory_was_full(clean) || memory_was_full(found);
  for (std::size_t j = 0; j < 6; ++j) {
    const auto& sweeps = found["joints"][j]["sweeps"];
    const auto& expected = clean["joints"][j]["sweeps"];
    const auto count = std::min(sweeps.size(), expected.size());
    if (!full) REQUIRE(sweeps.size() == expected.size());
    CHECK(count > 0);
    for (std::size_t s = 0; s < count; ++s) {
      INFO("joint " << j + 1 << ", sweep " << s + 1);
      CHECK(sweeps[s]["direction"] == expected[s]["direction"]);
      CHECK(sweeps[s].contains("positioning") == expected[s].contains("positioning"));
      CHECK(sweeps[s]["used"] == expected[s]["used"]);
      // At 60 deg/s, the plan's fastest, a cycle of 4 ms is 0.24 degrees.
      CHECK(sweeps[s]["range_deg"].get<double>() ==
            Approx(expected[s]["range_deg"].get<double>()).margin(0.24));
    }
  }
}

}  // namespace

TEST_CASE("whatever a network does to a long stream is counted exactly, and answered once",
          "[million_telegrams]") {
  spdlog::set_level(spdlog::level::off);
  const auto telegrams = wanted_telegrams();
  const TemporaryFolder folder;
  sweepd::RobotSettings settings;
  settings.name = "kr5-arc";
  settings.description = kRobot;
  settings.listen = {*rsi::parse_address("127.0.0.1"), 0};
  settings.ethernet_config = kEthernet;
  settings.output = folder / "out";
  // Lockstep is faster than any controller; and the samples are to lie in one file.
  settings.queue_bytes = std::size_t{64} << 20;
  settings.recording.memory_bytes = std::size_t{1} << 30;
  settings.recording.rotate_bytes = std::uint64_t{1} << 40;
  settings.real_time.wish = sweepd::RealTime::off;
  settings.silence = std::chrono::minutes(10);  // the one stream ends with the service
  sweepd::RobotService service(settings);
  service.start();

  FaultyCampaign campaign(service.local());
  campaign.play(telegrams);
  service.stop();

  const auto& wire = campaign.wire();
  const auto& expected = campaign.expected();
  for (const auto count : {wire.lost, wire.duplicated, wire.swapped, wire.cut, wire.garbage,
                           wire.foreign, expected.restarts})
    CHECK(count >= telegrams / 10'000);

  std::vector<std::filesystem::path> sessions;
  for (const auto& entry : std::filesystem::directory_iterator(settings.output / "kr5-arc"))
    sessions.push_back(entry.path());
  REQUIRE(sessions.size() == 1);
  const auto result = Json::parse(content(sessions[0] / "result.json"));
  const auto& source = result["source"];
  CHECK(source["telegrams"] == expected.whole + expected.cut_known);
  CHECK(expected.whole == telegrams - wire.lost - wire.cut + wire.duplicated);
  CHECK(expected.cut_known > 0);
  CHECK(source["lost"] == expected.lost);
  CHECK(expected.lost <= wire.lost + wire.cut - expected.cut_known);
  CHECK(source["duplicated"] == wire.duplicated);
  CHECK(source["reordered"] == wire.swapped);
  CHECK(source["restarts"] == expected.restarts);
  CHECK(source["late_replies"] == expected.late);
  CHECK(source["late_runs"] == expected.late_runs);
  CHECK(source["longest_late_run"] == expected.longest_late_run);
  CHECK(source["malformed"] == wire.cut + wire.garbage);
  CHECK(source["malformed_by_kind"] == expected.malformed);
  CHECK(source["cycle_ms"].get<double>() < 4);  // they come as fast as the machine goes

  const auto run = Json::parse(content(sessions[0] / "run.json"));
  const auto& link = run["since_start_of_sweepd"];
  CHECK(link["answered"] == expected.answered);
  CHECK(link["unanswerable"] == expected.unanswerable);
  CHECK(link["foreign"] == wire.foreign);
  for (const char* none :
       {"superseded", "refused", "cut", "send_failures", "dropped", "overflows"}) {
    INFO(none);
    CHECK(link[none] == 0);
  }

  const auto& recording = run["recording"];
  CHECK(recording["samples"] == telegrams - wire.lost - wire.cut);
  CHECK(recording["datagrams"] ==
        expected.whole + wire.cut + wire.garbage + expected.answered);  // both directions

  // The controller's own verdict on the replies. To those that were swapped they come late, to the
  // doubled ones twice.
  auto faults = campaign.rsi().counts().faults;
  INFO(campaign.rsi().first_fault());
  CHECK(faults[static_cast<std::size_t>(ReplyFault::late)] == wire.swapped);
  CHECK(faults[static_cast<std::size_t>(ReplyFault::repeated)] == wire.duplicated);
  faults[static_cast<std::size_t>(ReplyFault::late)] = 0;
  faults[static_cast<std::size_t>(ReplyFault::repeated)] = 0;
  CHECK(faults == decltype(faults){});
  CHECK(campaign.rsi().counts().replies == expected.answered);

  const auto clean = replay_clean(std::vector<bool>(telegrams, true), folder / "clean");
  CHECK(clean["source"]["telegrams"] == telegrams);
  CHECK(clean["source"]["restarts"] == expected.restarts);
  for (const char* none : {"lost", "duplicated", "reordered", "malformed", "late_replies"}) {
    INFO(none);
    CHECK(clean["source"][none] == 0);
  }
  check_samples(sessions[0] / "samples.csv", folder / "clean/samples.csv", expected.came);
  // The samples are those of the clean stream, but for their times: they came as fast as the
  // machine goes, which is no controller's pace. Sweeps are compared where times are alike: at due
  // times, and as they came.
  const auto trace = sessions[0] / "trace.pcap";
  check_sweeps(replay_clean(expected.came, folder / "came"), clean);
  check_sweeps(replay_at_due_times(trace, folder / "clean.pcap", folder / "due"), clean);
  check_sweeps(result, replay(trace, folder / "recorded"));
  CHECK(result["status"] == "complete");
}
