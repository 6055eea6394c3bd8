#include "daemon/service/robot_service.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "rsi/asio.hpp"

#include "daemon/commands/replay_command.hpp"
#include "daemon/record/session_folder.hpp"
#include "daemon/results/run_json.hpp"
#include "rsi/capture/capture_reader.hpp"
#include "rsi/controller/controller_link.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/said_lines.hpp"
#include "tests/daemon/telegrams.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/eventually.hpp"

using Catch::Matchers::ContainsSubstring;
using Json = nlohmann::json;
using sweepd::RobotService;
using namespace sweepd::test;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

namespace {

sweepd::RobotSettings settings(const fs::path& output) {
  spdlog::set_level(spdlog::level::off);
  sweepd::RobotSettings robot;
  robot.name = "kr5-arc";
  robot.description = kConfig / "robots/kr5_arc.toml";
  robot.listen = {*rsi::parse_address("127.0.0.1"), 0};
  robot.ethernet_config = kEthernet;
  robot.output = output;
  robot.silence = 150ms;
  return robot;
}

rsi::ControllerLink::Options at(const rsi::Endpoint& server) {
  rsi::ControllerLink::Options options;
  options.controller.server = server;
  options.controller.cycle = 2ms;
  options.controller.timeout = 100'000;
  options.controller.rule = rsi::ReplyRule::sweepd;
  options.local = {*rsi::parse_address("127.0.0.1"), 0};
  return options;
}

/// Joint 1 goes from 0 to 60 degrees and rests, in 0.8 s.
bool stroke(std::uint64_t cycle, rsi::SignalValues& values) {
  static const auto angles = stroke_deg(0, 60);
  if (cycle >= angles.size()) return false;
  const double angle = -angles[cycle] * 3.14159265358979323846 / 180;
  values.RIst = {500 * std::cos(angle), 500 * std::sin(angle), 900, 0, 90, 0};
  values.AIPos = {angles[cycle], -90, 90, 0, 90, 0};
  return true;
}

rsi::ControllerLink::Report stream(const rsi::Endpoint& server, std::uint64_t cycles = 400,
                                   const fs::path& ethernet = kEthernet) {
  rsi::ControllerLink link(rsi::EthernetConfig::load(ethernet), at(server));
  return link.run([&](std::uint64_t cycle, rsi::SignalValues& values) {
    return cycle < cycles && stroke(cycle, values);
  });
}

/// Waits for the work of other threads; false if it takes unreasonably long.
std::set<fs::path> sessions(const fs::path& output) {
  std::set<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(output / "kr5-arc")) folders.insert(entry.path());
  return folders;
}

Json json_in(const fs::path& file) {
  return Json::parse(content(file));
}

/// An Ethernet file that asks for TCP.
fs::path over_tcp(const TemporaryFolder& folder) {
  auto xml = content(kEthernet);
  xml.insert(xml.find("<SENTYPE>"), "<PROTOCOL>TCP</PROTOCOL>");
  return folder.write("ethernet.xml", xml);
}

/// Whether all files of a session are final.
bool has_ended(const fs::path& session) {
  return fs::exists(session / "run.json") && json_in(session / "run.json").contains("ended");
}

/// The folder of a session that was served to its end.
fs::path recorded_session(const fs::path& output) {
  RobotService service(settings(output));
  service.start();
  static_cast<void>(stream(service.local()));
  service.stop();
  return *sessions(output).begin();
}

/// As after kill -9: run.json is without its end.
fs::path killed_session(const fs::path& output) {
  const auto session = recorded_session(output);
  auto run = json_in(session / "run.json");
  run.erase("ended");
  std::ofstream(session / "run.json") << run.dump();
  return session;
}

struct Traced {
  std::uint64_t telegrams = 0;
  std::uint64_t replies = 0;
};

Traced traced(const fs::path& folder, std::uint16_t port) {
  Traced counts;
  rsi::CaptureReader trace(folder / "trace.pcap");
  while (const auto datagram = trace.next()) {
    CHECK(rsi::address_text(datagram->source.address) == "127.0.0.1");
    CHECK(rsi::address_text(datagram->destination.address) == "127.0.0.1");
    ++(datagram->destination.port == port ? counts.telegrams : counts.replies);
  }
  CHECK(trace.notes().empty());
  return counts;
}

/// What a replay of the recording leaves.
std::string replayed(const fs::path& session, const fs::path& output) {
  sweepd::ReplayOptions options;
  options.traces = {session / "trace.pcap"};
  options.config = kConfig / "sweepd.toml";
  options.output = output;
  options.quiet = true;
  std::ostringstream text;
  CHECK(sweepd::replay(options, text, text) == 0);
  CHECK(text.str().empty());
  return content(output / "result.json");
}

}  // namespace

TEST_CASE("each stream gets a folder of its own, and silence completes it",
          "[robot_service][live]") {
  const TemporaryFolder folder;
  const auto output = folder / "out";
  RobotService service(settings(output));
  CHECK(fs::is_directory(output / "kr5-arc"));
  service.start();
  std::set<fs::path> seen;
  std::uint64_t sent = 0;
  for (int k = 0; k < 2; ++k) {
    const auto report = stream(service.local());
    CHECK(report.end == rsi::ControllerLink::End::done);
    const auto telegrams = report.controller.telegrams;
    CHECK(telegrams + report.skipped == 400);
    sent += telegrams;
    fs::path session;
    REQUIRE(eventually([&] {
      for (const auto& path : sessions(output))
        if (!seen.contains(path)) session = path;
      return !session.empty() && has_ended(session) && fs::exists(session / "result.json");
    }));
    seen.insert(session);

    const auto result = json_in(session / "result.json");
    CHECK(result["status"] == "partial");
    CHECK(result["source"]["telegrams"] == telegrams);
    CHECK(result["source"]["lost"] <= report.skipped);
    REQUIRE(result["joints"][0]["sweeps"].size() == 1);
    CHECK(result["joints"][0]["circle"]["radius_mm"].get<double>() == Approx(500).margin(1e-3));
    for (const char* name : {"samples.csv", "sweeps.csv", "dh.csv", "report.txt"}) {
      INFO(name);
      CHECK(fs::file_size(session / name) > 0);
    }
    const auto counts = traced(session, service.local().port);
    CHECK(counts.telegrams == telegrams);
    const auto recording = json_in(session / "run.json")["recording"];
    CHECK(recording["files"] == 2);
    CHECK(recording["bytes"] ==
          fs::file_size(session / "trace.pcap") + fs::file_size(session / "samples.csv"));
    CHECK(recording["datagrams"] == counts.telegrams + counts.replies);
    CHECK(recording["samples"] == telegrams);
    CHECK(recording["not_recorded"]["memory_full"]["datagrams"] == 0);
    CHECK(recording["not_recorded"]["disk"]["samples"] == 0);
    CHECK(recording["paused"] == 0);
    // On a machine that stalls several telegrams wait, and only the newest is answered.
    const auto link = json_in(session / "run.json")["since_start_of_sweepd"];
    CHECK(link["answered"].get<std::uint64_t>() + link["superseded"].get<std::uint64_t>() == sent);
    CHECK(counts.replies > 0);
    CHECK(counts.replies == report.controller.replies);
    CHECK(report.controller.of(rsi::ReplyFault::malformed) == 0);
    CHECK(report.controller.of(rsi::ReplyFault::wrong_ipoc) == 0);
    CHECK(replayed(session, folder / ("replay" + std::to_string(k))) ==
          content(session / "result.json"));
  }
  service.stop();
  CHECK(sessions(output).size() == 2);
}

TEST_CASE("a session whose last result was never written gets it at the next start",
          "[robot_service][live][issue11][point_10]") {
  const TemporaryFolder folder;
  const fs::path session = recorded_session(folder / "out");
  // As after kill -9: the recording, and run.json without its end.
  const auto result = content(session / "result.json");
  auto run = json_in(session / "run.json");
  run.erase("ended");
  for (const auto& entry : fs::directory_iterator(session))
    if (entry.path().filename() != "trace.pcap" && entry.path().filename() != "samples.csv")
      fs::remove(entry.path());
  static_cast<void>(folder.write("run.json", run.dump()));
  fs::copy(folder / "run.json", session / "run.json");
  const auto other = session.parent_path() / "20370101T000000Z";  // looked at first
  fs::copy(session, other);
  const sweepd::FolderLock written_by_another(other);
  const auto damaged = session.parent_path() / "20360101T000000Z";
  fs::copy(session, damaged);
  fs::resize_file(damaged / "run.json", fs::file_size(damaged / "run.json") / 2);
  // The disk took the result, but only the beginning of the recording.
  const auto cut = session.parent_path() / "20380101T000000Z";
  fs::copy(session, cut);
  static_cast<void>(folder.write("result.json", result));
  fs::copy(folder / "result.json", cut / "result.json");
  fs::resize_file(cut / "trace.pcap", fs::file_size(cut / "trace.pcap") / 2);

  RobotService service(settings(folder / "out"));
  service.start();
  REQUIRE(eventually([&] { return has_ended(session); }));
  CHECK(json_in(session / "run.json")["from_recording"] == true);
  CHECK(content(session / "result.json") == result);
  for (const char* name : {"sweeps.csv", "dh.csv", "report.txt"}) CHECK(fs::exists(session / name));
  service.stop();
  CHECK(content(damaged / "result.json") == result);
  CHECK(json_in(damaged / "run.json")["from_recording"] == true);
  CHECK_FALSE(json_in(damaged / "run.json").contains("damage"));
  REQUIRE(json_in(cut / "run.json")["damage"].size() == 1);
  CHECK_THAT(json_in(cut / "run.json")["damage"][0].get<std::string>(),
             ContainsSubstring("trace.pcap"));
  CHECK(has_ended(cut));
  CHECK_FALSE(json_in(cut / "run.json").contains("from_recording"));
  CHECK(content(cut / "result.json") == result);
  CHECK_FALSE(fs::exists(other / "result.json"));
  CHECK_FALSE(json_in(other / "run.json").contains("ended"));
}

TEST_CASE("a recovered session tells what made its result, and that its recording paused",
          "[robot_service][live]") {
  const TemporaryFolder folder;
  const auto session = recorded_session(folder / "out");
  const auto now = json_in(session / "run.json")["inputs"];
  auto run = json_in(session / "run.json");
  run.erase("ended");
  run["inputs"][0]["sha256"] = "another";
  run["recording_paused"] = true;
  std::ofstream(session / "run.json") << run.dump();
  // Nobody knows what this was made of.
  std::ofstream(session / "result.json") << R"({"source": {"telegrams": "many"}})";
  const auto more = session.parent_path() / "20370101T000000Z";
  fs::copy(session, more);
  std::ofstream(more / "result.json") << R"({"source": {"telegrams": 99999}})";
  const auto late = session.parent_path() / "20390101T000000Z";
  fs::copy(session, late);
  fs::rename(late / "trace.pcap", late / "trace-0003.pcap");
  const auto unreadable = session.parent_path() / "20380101T000000Z";
  fs::copy(session, unreadable);
  fs::resize_file(unreadable / "trace.pcap", 3);

  const SaidLines said;
  {
    RobotService service(settings(folder / "out"));
    spdlog::set_level(spdlog::level::info);
    service.start();
    REQUIRE(eventually([&] { return has_ended(session); }));
    service.stop();
    spdlog::set_level(spdlog::level::off);
  }
  run = json_in(session / "run.json");
  CHECK(run["inputs"][0]["sha256"] == "another");
  CHECK(run["recovered"]["inputs"][0] == now[0]);
  CHECK_FALSE(run.contains("since_start_of_sweepd"));
  CHECK_THAT(run["damage"][0].get<std::string>(), ContainsSubstring("the recording paused"));
  CHECK(run["damage"].size() == 1);
  CHECK_THAT(json_in(late / "run.json")["damage"][0].get<std::string>(),
             ContainsSubstring("before trace-0003.pcap are not there"));
  CHECK(json_in(session / "result.json")["source"]["telegrams"].is_number());
  CHECK(has_ended(more));
  CHECK_THAT(said.text(), ContainsSubstring("the result in " + more.string() + " stays"));
  CHECK_THAT(said.text(), !ContainsSubstring("see " + more.string()));
  CHECK_THAT(said.text(),
             ContainsSubstring("no result is made of the recording in " + unreadable.string()) &&
                 ContainsSubstring("the next start tries it again"));
}

TEST_CASE("a recovered session tells of its link as its recording does, and says so",
          "[robot_service][live]") {
  const TemporaryFolder folder;
  const auto session = killed_session(folder / "out");
  const auto known = session.parent_path() / "20370101T000000Z";
  fs::copy(session, known);
  const auto live = json_in(session / "link.json");
  for (const char* name : {"link.txt", "link.json", "last_cycles.csv"}) fs::remove(session / name);
  const auto deleted = session.parent_path() / "20380101T000000Z";
  fs::copy(session, deleted);
  sweepd::mark_recording_deleted(deleted);
  const auto late = session.parent_path() / "20390101T000000Z";
  fs::copy(session, late);
  fs::rename(late / "trace.pcap", late / "trace-0002.pcap");
  RobotService service(settings(folder / "out"));
  service.start();
  for (const auto& of : {session, known, deleted, late})
    REQUIRE(eventually([&] { return has_ended(of); }));
  service.stop();
  const auto told = json_in(session / "link.json");
  for (const char* part : {"controller", "start", "duration_s", "telegrams", "replies", "latency"})
    CHECK(told[part] == live[part]);
  CHECK(told["from_recording"] == true);
  CHECK_THAT(content(session / "link.txt"),
             ContainsSubstring("sweepd was cut off in this session"));
  CHECK_FALSE(fs::exists(session / "last_cycles.csv"));
  CHECK(json_in(known / "link.json") == live);
  CHECK_FALSE(fs::exists(deleted / "link.json"));
  CHECK_FALSE(fs::exists(late / "link.json"));
}

TEST_CASE("a session of which somebody deleted the beginning tells it after a restart",
          "[robot_service][live]") {
  const TemporaryFolder folder;
  const auto session = killed_session(folder / "out");
  sweepd::mark_recording_deleted(session);
  RobotService service(settings(folder / "out"));
  service.start();
  REQUIRE(eventually([&] { return has_ended(session); }));
  service.stop();
  const auto run = json_in(session / "run.json");
  REQUIRE(run["damage"].size() == 1);
  CHECK_THAT(run["damage"][0].get<std::string>(),
             ContainsSubstring("somebody deleted, moved or cut"));
}

TEST_CASE("a trace that was cut to nothing is told once, and costs nothing else",
          "[robot_service][live]") {
  const TemporaryFolder folder;
  const auto session = killed_session(folder / "out");
  const auto empty = session.parent_path() / "20370101T000000Z";
  fs::copy(session, empty);
  fs::resize_file(empty / "trace.pcap", 0);
  std::ofstream(session / "trace-0002.pcap").flush();
  RobotService service(settings(folder / "out"));
  service.start();
  REQUIRE(eventually([&] { return has_ended(session) && has_ended(empty); }));
  service.stop();
  CHECK(json_in(empty / "run.json")["damage"] ==
        Json{"there is no trace to make a last result of"});
  const auto run = json_in(session / "run.json");
  CHECK(run["from_recording"] == true);
  REQUIRE(run["damage"].size() == 1);
  CHECK_THAT(run["damage"][0].get<std::string>(), ContainsSubstring("trace-0002.pcap is empty"));
}

TEST_CASE("a session that was cut and has no trace is ended at the next start, and stays",
          "[robot_service][live]") {
  const TemporaryFolder folder;
  const auto session = folder / "out/kr5-arc/20250101T000000Z";
  fs::create_directories(session);
  static_cast<void>(folder.write("out/kr5-arc/20250101T000000Z/result.json", "as it was"));
  static_cast<void>(folder.write("out/kr5-arc/20250101T000000Z/run.json",
                                 R"({"command": "run", "robot": "kr5-arc"})"));
  for (const auto& [name, second] : {std::pair{"run.json", 100}, {"result.json", 200}})
    fs::last_write_time(
        session / name,
        std::chrono::file_clock::from_sys(
            std::chrono::sys_time<std::chrono::seconds>(std::chrono::seconds(second))));
  RobotService service(settings(folder / "out"));
  service.start();
  REQUIRE(eventually([&] { return has_ended(session); }));
  service.stop();
  const auto run = json_in(session / "run.json");
  CHECK(run["ended"] == "19700101T000320Z");
  CHECK(run["robot"] == "kr5-arc");
  CHECK(run["damage"] == Json{"there is no trace to make a last result of"});
  CHECK_FALSE(run.contains("from_recording"));
  CHECK(content(session / "result.json") == "as it was");
}

TEST_CASE("what is no telegram over TCP is said, and at the end what has come since",
          "[robot_service][live]") {
  using boost::asio::ip::tcp;
  const SaidLines said;
  const TemporaryFolder folder;
  auto robot = settings(folder / "out");
  robot.name = "asked-for-pages";
  robot.ethernet_config = over_tcp(folder);
  spdlog::set_level(spdlog::level::info);
  RobotService service(robot);
  service.start();
  const auto ask_for_page = [&](const std::string& request, std::uint64_t bytes_in_all) {
    boost::asio::io_context context;
    tcp::socket browser(context);
    browser.connect(rsi::to_asio<tcp>(service.local()));
    browser.send(boost::asio::buffer(request));
    browser.close();
    return eventually(
        [&] { return service.status()->state.newest()->server.skipped == bytes_in_all; });
  };
  REQUIRE(ask_for_page("GET/HTTP/1.1", 12));
  REQUIRE(ask_for_page("GET/result.json", 27));
  service.stop();
  spdlog::set_level(spdlog::level::off);
  const auto text = said.text();
  const std::regex sentence("asked-for-pages: (\\d+) bytes were left out of a TCP stream");
  int bytes = 0;
  for (std::sregex_iterator at(text.begin(), text.end(), sentence), end; at != end; ++at)
    bytes += std::stoi(at->str(1));
  CHECK(bytes == 27);
}

TEST_CASE("no recording is deleted before its session has a result",
          "[robot_service][live][retention][long]") {
  const TemporaryFolder folder;
  const fs::path session = recorded_session(folder / "out");
  const auto result = content(session / "result.json");
  auto run = json_in(session / "run.json");
  run.erase("ended");
  for (int day = 1; day <= 30; ++day) {
    const auto cut = session.parent_path() / fmt::format("202601{:02}T000000Z", day);
    fs::create_directory(cut);
    fs::copy(session / "trace.pcap", cut / "trace.pcap");
    std::ofstream(cut / "run.json") << run.dump();
  }
  auto of = settings(folder / "out");
  of.recording.keep_bytes = 1;
  RobotService service(of);
  service.start();
  static_cast<void>(stream(service.local()));  // meanwhile, recordings are looked at
  // One after the other: a busy machine has thirty seconds for each, not for all.
  for (const auto& one : sessions(folder / "out"))
    REQUIRE(eventually([&] { return has_ended(one); }));
  service.stop();
  CHECK(sessions(folder / "out").size() == 32);
  for (const auto& one : sessions(folder / "out"))
    if (one.filename().string().starts_with("202601"))
      CHECK(content(one / "result.json") == result);
}

TEST_CASE("a stray with an IPOC neither keeps out the controller nor shares its recording",
          "[live][robot_service][issue11][point_8]") {
  const SaidLines said;
  const TemporaryFolder folder;
  const auto output = folder / "out";
  auto robot = settings(output);
  robot.silence = 20s;
  spdlog::set_level(spdlog::level::info);
  RobotService service(robot);
  service.start();
  auto stray = at(service.local());
  stray.local.address = *rsi::parse_address("127.0.0.2");
  const auto send_one = [](std::uint64_t cycle, rsi::SignalValues&) { return cycle < 1; };
  static_cast<void>(rsi::ControllerLink(rsi::EthernetConfig::load(kEthernet), stray).run(send_one));
  REQUIRE(eventually([&] { return sessions(output).size() == 1; }));
  const auto of_stray = *sessions(output).begin();
  const auto report = stream(service.local(), 100);
  CHECK(report.controller.telegrams + report.skipped == 100);
  service.stop();
  spdlog::set_level(spdlog::level::off);
  CHECK_THAT(said.text(),
             ContainsSubstring("127.0.0.1 streams: it is the controller now; before it "
                               "was 127.0.0.2, with 1 telegram\n"));
  auto folders = sessions(output);
  folders.erase(of_stray);
  REQUIRE(folders.size() == 1);
  const auto counts = traced(*folders.begin(), service.local().port);
  CHECK(counts.telegrams == report.controller.telegrams);
  CHECK(counts.replies == report.controller.replies);
}

TEST_CASE("where all addresses are listened at, the recording has those that were used",
          "[live][robot_service][issue11][point_3]") {
  const TemporaryFolder folder;
  auto robot = settings(folder / "out");
  robot.listen.address = 0;
  RobotService service(robot);
  service.start();
  const rsi::Endpoint server{*rsi::parse_address("127.0.0.3"), service.local().port};
  auto options = at(server);
  options.local.address = *rsi::parse_address("127.0.0.2");
  rsi::ControllerLink link(rsi::EthernetConfig::load(kEthernet), options);
  const auto report = link.run([](std::uint64_t cycle, auto&) { return cycle < 20; });
  CHECK(report.controller.of(rsi::ReplyFault::wrong_source) == 0);
  CHECK(report.controller.accepted > 0);
  service.stop();
  REQUIRE(sessions(folder / "out").size() == 1);
  rsi::CaptureReader trace(*sessions(folder / "out").begin() / "trace.pcap");
  std::uint64_t replies = 0;
  while (const auto datagram = trace.next()) {
    const bool reply = datagram->source == server;
    CHECK((reply || datagram->destination == server));
    replies += reply;
  }
  CHECK(replies == report.controller.replies);
}

TEST_CASE("a stop while RSI streams leaves a complete result at once, and answers until then",
          "[robot_service][live]") {
  const TemporaryFolder folder;
  auto robot = settings(folder / "out");
  const auto loopback = robot.listen.address;
  robot.listen.address = 0;  // every interface: the recording has the one that was used
  RobotService service(robot);
  service.start();
  const rsi::Endpoint server{loopback, service.local().port};
  rsi::ControllerLink link(rsi::EthernetConfig::load(kEthernet), at(server));
  std::atomic<std::uint64_t> cycles = 0;
  rsi::ControllerLink::Report report;
  std::thread controller([&] {
    report = link.run([&](std::uint64_t cycle, rsi::SignalValues& values) {
      cycles = cycle;
      return stroke(std::min<std::uint64_t>(cycle, 399), values);  // and then rests for ever
    });
  });
  const bool streamed = eventually([&] { return cycles > 410; });
  service.stop();
  const auto folders = sessions(folder / "out");
  const bool result_is_there = folders.size() == 1 && fs::exists(*folders.begin() / "result.json");
  link.stop();
  controller.join();

  REQUIRE(streamed);
  REQUIRE(result_is_there);
  const auto& session = *folders.begin();
  const auto result = json_in(session / "result.json");
  CHECK(result["status"] == "partial");
  CHECK(result["joints"][0]["sweeps"].size() == 1);
  const auto counts = traced(session, service.local().port);
  CHECK(result["source"]["telegrams"] == counts.telegrams);
  CHECK(counts.telegrams > 0);
  CHECK(has_ended(session));
  CHECK(replayed(session, folder / "replay") == content(session / "result.json"));
}

TEST_CASE("a service that is stopped before anything came leaves nothing, and may be stopped again",
          "[robot_service]") {
  const TemporaryFolder folder;
  RobotService service(settings(folder / "out"));
  service.stop();
  service.start();
  service.stop();
  service.stop();
  CHECK(sessions(folder / "out").empty());
}

TEST_CASE("a robot whose port is flooded leaves others their turns of a thread that they share",
          "[robot_service][live]") {
  const TemporaryFolder folder;
  const std::shared_ptr<sweepd::RobotThreads> threads(
      new sweepd::RobotThreads{.acquisition{"acquisition", 1, 1}});
  auto flooded = settings(folder / "flooded");
  flooded.record = false;
  RobotService first(flooded, threads);
  RobotService second(settings(folder / "out"), threads);
  first.start();
  second.start();
  std::atomic<bool> ends{false};
  std::thread flood([&] {
    boost::asio::io_context context;
    boost::asio::ip::udp::socket socket(context, {boost::asio::ip::address_v4::loopback(), 0});
    socket.connect({boost::asio::ip::address_v4::loopback(), first.local().port});
    boost::system::error_code error;
    std::string much;  // takes longer to be understood than to be answered
    for (int k = 0; k < 500; ++k) much += "<Sen" + std::to_string(k) + " A=\"1.0\"/>";
    for (std::uint64_t ipoc = 1; !ends; ++ipoc)
      socket.send(boost::asio::buffer(telegram(ipoc, much)), 0, error);
  });
  CHECK(eventually([&] { return first.status()->state.newest()->sessions == 1; }));
  stream(second.local());
  // Its stream is seen to begin and, by a turn that comes in time, to end.
  CHECK(eventually([&] {
    const auto state = second.status()->state.newest();
    return state->sessions == 1 && !state->stream;
  }));
  ends = true;
  flood.join();
  CHECK(first.stop());
  CHECK(second.stop());
}

TEST_CASE("a device's port that somebody else has costs the device, not the replies",
          "[robot_service][live]") {
  using boost::asio::ip::udp;
  const TemporaryFolder folder;
  boost::asio::io_context context;
  const udp::socket taken(context, udp::endpoint(boost::asio::ip::address_v4::loopback(), 0));
  auto robot = settings(folder.path());
  robot.device.listen.endpoint = rsi::from_asio(taken.local_endpoint());
  robot.device.columns.text = "x_mm,y_mm,z_mm";
  RobotService service(robot);
  service.start();
  CHECK(stream(service.local(), 50).controller.replies > 0);
}

TEST_CASE("a folder that cannot be made later costs the files, not the replies",
          "[robot_service][live]") {
  const TemporaryFolder folder;
  RobotService service(settings(folder / "out"));
  fs::remove(folder / "out/kr5-arc");
  static_cast<void>(folder.write("out/kr5-arc", "a file in its place"));
  service.start();
  const auto report = stream(service.local(), 50);
  CHECK(report.controller.replies > 0);  // a machine that stalls answers only the newest of several
  service.stop();
  CHECK(content(folder / "out/kr5-arc") == "a file in its place");
}

TEST_CASE("a session whose folder cannot be made goes to the output that a reload gives",
          "[robot_service][live]") {
  const TemporaryFolder folder;
  auto robot = settings(folder / "out");
  robot.silence = 1min;
  RobotService service(robot);
  fs::remove(folder / "out/kr5-arc");
  static_cast<void>(folder.write("out/kr5-arc", "a file in its place"));
  service.start();
  static_cast<void>(stream(service.local(), 50));
  robot.output = folder / "elsewhere";
  service.reload(robot);
  REQUIRE(eventually([&] { return sessions(folder / "elsewhere").size() == 1; }));
  CHECK(service.stop());
  const auto session = *sessions(folder / "elsewhere").begin();
  CHECK(fs::exists(session / "trace.pcap"));
  CHECK(fs::exists(session / "samples.csv"));
  CHECK(has_ended(session));
}

TEST_CASE("busy programs keep neither the result nor the end from coming",
          "[robot_service][live][issue11][point_17]") {
  const TemporaryFolder folder;
  std::atomic<bool> busy = true;
  std::vector<std::thread> programs;
  for (unsigned k = 0; k < 2 * std::max(2U, std::thread::hardware_concurrency()); ++k)
    programs.emplace_back([&] {
      while (busy) {
      }
    });
  {
    RobotService service(settings(folder / "out"));
    service.start();
    const auto report = stream(service.local());
    CHECK(report.end == rsi::ControllerLink::End::done);
    CHECK(report.controller.telegrams + report.skipped == 400);
    CHECK(eventually([&] {
      const auto all = sessions(folder / "out");
      return !all.empty() && has_ended(*all.begin());
    }));
    const auto asked = std::chrono::steady_clock::now();
    CHECK(service.stop());
    CHECK(std::chrono::steady_clock::now() - asked < 20s);
  }
  busy = false;
  for (auto& program : programs) program.join();
}

TEST_CASE("a controller that only sends gets nothing sent", "[robot_service][live]") {
  const TemporaryFolder folder;
  auto xml = content(kEthernet);
  const auto key = xml.find("<ONLYSEND>FALSE");
  REQUIRE(key != std::string::npos);
  xml.replace(key, 15, "<ONLYSEND>TRUE");
  auto robot = settings(folder / "out");
  robot.ethernet_config = folder.write("ethernet.xml", xml);
  RobotService service(robot);
  service.start();
  const auto report = stream(service.local(), 50, *robot.ethernet_config);
  REQUIRE(eventually([&] {
    const auto all = sessions(folder / "out");
    return !all.empty() && fs::exists(*all.begin() / "result.json");
  }));
  service.stop();
  CHECK(report.controller.replies == 0);
  const auto session = *sessions(folder / "out").begin();
  CHECK(traced(session, service.local().port).replies == 0);
  CHECK(json_in(session / "result.json")["source"]["telegrams"] == report.controller.telegrams);
}

TEST_CASE("a controller over TCP is answered, and recorded as if over UDP",
          "[robot_service][live]") {
  const TemporaryFolder folder;
  auto robot = settings(folder / "out");
  robot.ethernet_config = over_tcp(folder);
  robot.silence = 10s;  // a machine that stalls must not split the stream
  RobotService service(robot);
  service.start();
  const auto report = stream(service.local(), 400, *robot.ethernet_config);
  service.stop();
  CHECK(report.end == rsi::ControllerLink::End::done);
  CHECK(report.controller.accepted > 0);
  const auto session = *sessions(folder / "out").begin();
  const auto trace = traced(session, service.local().port);
  CHECK(trace.telegrams == report.controller.telegrams);
  CHECK(trace.replies == report.controller.replies);
  CHECK(replayed(session, folder / "replayed") == content(session / "result.json"));
}

TEST_CASE("what makes serving impossible is said before anything is served", "[robot_service]") {
  const TemporaryFolder folder;
  SECTION("a port that is taken") {
    const RobotService first(settings(folder / "out"));
    auto robot = settings(folder / "out");
    robot.listen = first.local();
    CHECK_THROWS_WITH(RobotService(robot), ContainsSubstring("in use by this program itself"));
  }
  SECTION("an output folder that cannot be made") {
    const auto robot = settings(folder.write("file", "") / "out");
    CHECK_THROWS_WITH(RobotService(robot),
                      ContainsSubstring("cannot make the folder") &&
                          ContainsSubstring((folder / "file/out/kr5-arc").string()));
  }
}

TEST_CASE(
    "an output folder that may not be written is told at the start, not with the first telegram",
    "[robot_service]") {
  const TemporaryFolder folder;
  const auto inputs = sweepd::RobotInputs::read(settings(folder / "out"));
  const SaidLines said;
  spdlog::set_level(spdlog::level::info);
  inputs.make_folder(sweepd::Log("kr5-arc"));
  CHECK(said.text().empty());
  fs::permissions(folder.path(), fs::perms::all);
  fs::permissions(inputs.folder(), fs::perms::owner_read | fs::perms::owner_exec);
  constexpr ::uid_t kNobody = 65534;  // root may write everything
  const bool is_root = ::geteuid() == 0;
  if (is_root) REQUIRE(::seteuid(kNobody) == 0);
  inputs.make_folder(sweepd::Log("kr5-arc"));
  if (is_root) REQUIRE(::seteuid(0) == 0);
  fs::permissions(inputs.folder(), fs::perms::owner_all);
  spdlog::set_level(spdlog::level::off);
  CHECK_THAT(said.text(), ContainsSubstring(inputs.folder().string() +
                                            " cannot be written (Permission denied): "));
}

TEST_CASE("an output folder that cannot be made is refused by a reload, as at the start",
          "[robot_service][live]") {
  const TemporaryFolder folder;
  auto robot = settings(folder / "out");
  RobotService service(robot);
  service.start();
  robot.output = folder.write("file", "") / "out";
  CHECK_THROWS_WITH(service.reload(robot),
                    ContainsSubstring("cannot make the folder") &&
                        ContainsSubstring((folder / "file/out/kr5-arc").string()));
  static_cast<void>(stream(service.local(), 50));
  CHECK(service.stop());
  CHECK(fs::exists(*sessions(folder / "out").begin() / "trace.pcap"));
}

TEST_CASE("a service that does not record says so in its result, and leaves no trace",
          "[robot_service][live]") {
  const TemporaryFolder folder;
  auto robot = settings(folder / "out");
  robot.record = false;
  RobotService service(robot);
  service.start();
  static_cast<void>(stream(service.local(), 50));
  service.stop();
  const auto session = *sessions(folder / "out").begin();
  CHECK_FALSE(fs::exists(session / "trace.pcap"));
  CHECK(json_in(session / "result.json")["source"]["kind"] == "live");
}
