#include "daemon/commands/simulate_command.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <map>

#include <sys/resource.h>

#include "daemon/plan/simulated_robot.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/text/units.hpp"
#include "rsi/capture/capture_reader.hpp"
#include "rsi/telegram/decimal.hpp"
#include "rsi/telegram/telegram.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/simulations.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd::test;
namespace fs = std::filesystem;

namespace {

struct Recorded {
  rsi::Timestamp time;
  rsi::Endpoint source;
  rsi::Endpoint destination;
  std::string payload;
};

std::vector<Recorded> read(const fs::path& file) {
  std::vector<Recorded> all;
  rsi::CaptureReader reader(file);
  while (const auto datagram = reader.next())
    all.push_back(
        {datagram->time, datagram->source, datagram->destination, std::string(datagram->payload)});
  CHECK(reader.notes().empty());
  return all;
}

std::uint64_t ipoc_of(const Recorded& recorded) {
  rsi::Telegram telegram;
  REQUIRE(telegram.parse(recorded.payload) == rsi::Defect::none);
  return telegram.ipoc();
}

}  // namespace

TEST_CASE("a capture holds each cycle's telegram with the time, IPOC and addresses of a controller",
          "[simulate_command]") {
  const TemporaryFolder folder;
  auto simulation = simulation_of();
  simulation.write = folder / "trace.pcap";
  simulation.cycle_ms = 12;
  simulation.first_ipoc = 777;
  const auto outcome = run(simulation);
  CHECK(outcome.code == 0);
  CHECK(outcome.errors.empty());

  const auto telegrams = read(folder / "trace.pcap");
  sweepd::SimulatedRobot robot(
      sweepd::load_robot(simulation.robot), sweepd::load_plan(simulation.plan),
      {.cycle = std::chrono::milliseconds(12), .wobble_deg = 1e-4, .seed = 1, .tool_mm = {}});
  REQUIRE(telegrams.size() == robot.cycles());
  CHECK_THAT(outcome.report,
             ContainsSubstring(std::to_string(telegrams.size()) + " one every 12 ms"));

  rsi::Telegram telegram;
  rsi::SignalValues values;
  for (std::size_t k = 0; k < telegrams.size(); ++k) {
    REQUIRE(robot.next(values));
    const auto& recorded = telegrams[k];
    REQUIRE(recorded.time - telegrams[0].time == k * std::chrono::milliseconds(12));
    REQUIRE(rsi::text(recorded.source) == "192.168.1.20:49153");
    REQUIRE(rsi::text(recorded.destination) == "192.168.1.10:49152");
    REQUIRE(telegram.parse(recorded.payload) == rsi::Defect::none);
    REQUIRE(telegram.ipoc() == 777 + 12 * k);
    const auto check = [&](std::string_view element, std::array<const char*, 6> attributes,
                           const std::array<double, 6>& expected) {
      for (std::size_t i = 0; i < 6; ++i) {
        const auto at = telegram.find(element, attributes[i]);
        REQUIRE(at);
        const auto text = telegram.signals()[*at].text;
        REQUIRE(rsi::decimals(text) == 4);
        // Half a unit of the fourth decimal, and the rounding of the comparison.
        REQUIRE(std::abs(*rsi::number(text) - expected[i]) <= 0.5e-4 + 1e-9);
      }
    };
    check("RIst", {"X", "Y", "Z", "A", "B", "C"}, values.RIst);
    check("RSol", {"X", "Y", "Z", "A", "B", "C"}, values.RSol);
    check("AIPos", {"A1", "A2", "A3", "A4", "A5", "A6"}, values.AIPos);
    check("ASPos", {"A1", "A2", "A3", "A4", "A5", "A6"}, values.ASPos);
    const auto delay = telegram.find("Delay", "D");
    REQUIRE(delay);
    REQUIRE(telegram.signals()[*delay].text == "0");
  }
}

TEST_CASE("the same options write the same bytes, another seed writes others",
          "[simulate_command]") {
  const TemporaryFolder folder;
  auto simulation = simulation_of(write_plan(folder, "5"));
  simulation.lose_percent = simulation.duplicate_percent = simulation.swap_percent = 2;
  const auto written = [&](const char* name, std::uint64_t seed) {
    simulation.write = folder / name;
    simulation.seed = seed;
    REQUIRE(run(simulation).code == 0);
    return content(folder / name);
  };
  const auto first = written("1.pcap", 8);
  CHECK(first.size() > 50'000);
  CHECK(first == written("2.pcap", 8));
  CHECK(first != written("3.pcap", 9));
}

TEST_CASE("faults on purpose are in the capture as they are reported", "[simulate_command]") {
  const TemporaryFolder folder;
  auto simulation = simulation_of();
  simulation.write = folder / "trace.pcap";
  simulation.lose_percent = 1;
  simulation.duplicate_percent = 0.5;
  simulation.swap_percent = 0.5;
  const auto outcome = run(simulation);
  CHECK(outcome.code == 0);

  const auto telegrams = read(folder / "trace.pcap");
  std::map<std::uint64_t, int> arrivals;
  std::uint64_t duplicated = 0;
  std::uint64_t swapped = 0;
  std::uint64_t newest = 0;
  for (const auto& recorded : telegrams) {
    const auto ipoc = ipoc_of(recorded);
    if (++arrivals[ipoc] == 2)
      ++duplicated;
    else if (ipoc < newest)
      ++swapped;
    newest = std::max(newest, ipoc);
  }
  const auto sent = (newest - arrivals.begin()->first) / 4 + 1;
  const auto lost = sent - arrivals.size();
  const auto row = [](const std::string& label, std::uint64_t count) {
    const auto digits = std::to_string(count);
    return label + std::string(34 - label.size() - digits.size(), ' ') + digits;
  };
  CHECK(lost > 0);
  CHECK(duplicated > 0);
  CHECK(swapped > 0);
  CHECK_THAT(outcome.report, ContainsSubstring(row("telegrams", sent)) &&
                                 ContainsSubstring(row("  lost on purpose", lost)) &&
                                 ContainsSubstring(row("  duplicated on purpose", duplicated)) &&
                                 ContainsSubstring(row("  swapped on purpose", swapped)));
}

TEST_CASE("the built-in Ethernet file is the one that is shipped", "[simulate_command]") {
  const TemporaryFolder folder;
  auto simulation = simulation_of(write_plan(folder, "100"));
  simulation.write = folder / "built-in.pcap";
  REQUIRE(run(simulation).code == 0);
  simulation.write = folder / "shipped.pcap";
  simulation.ethernet_config = kConfig / "controller/krc4/sweepd_ethernet.xml";
  REQUIRE(run(simulation).code == 0);
  CHECK(content(folder / "built-in.pcap") == content(folder / "shipped.pcap"));
}

TEST_CASE("an Ethernet file tells elements and port, the options decimals and tool point",
          "[simulate_command]") {
  const TemporaryFolder folder;
  auto simulation = simulation_of(write_plan(folder, "100"));
  simulation.write = folder / "trace.pcap";
  simulation.precision = 2;
  simulation.wobble_deg = 0;
  simulation.tool_mm = {0, 0, 0};
  simulation.ethernet_config = folder.write(
      "ethernet.xml",
      "<ROOT><CONFIG><IP_NUMBER>10.0.0.1</IP_NUMBER><PORT>6008</PORT><SENTYPE>X</SENTYPE>"
      "<ONLYSEND>TRUE</ONLYSEND></CONFIG><SEND><ELEMENTS>"
      "<ELEMENT TAG=\"DEF_RIst\" TYPE=\"DOUBLE\" INDX=\"INTERNAL\"/></ELEMENTS></SEND>"
      "<RECEIVE><ELEMENTS/></RECEIVE></ROOT>");
  REQUIRE(run(simulation).code == 0);
  const auto first = read(folder / "trace.pcap").front();
  CHECK(first.destination.port == 6008);
  CHECK_THAT(first.payload, ContainsSubstring("<Rob Type=\"KUKA\"><RIst X=\"") &&
                                ContainsSubstring("</IPOC></Rob>"));
  CHECK_THAT(first.payload, !ContainsSubstring("AIPos"));
  rsi::Telegram telegram;
  REQUIRE(telegram.parse(first.payload) == rsi::Defect::none);
  REQUIRE(telegram.signals().size() == 6);
  for (const auto& signal : telegram.signals()) CHECK(rsi::decimals(signal.text) == 2);

  // Home, and the tool point in the origin of the last frame.
  const auto arm = *sweepd::load_robot(simulation.robot).arm;
  std::vector<double> home_rad;
  for (const double angle_deg : sweepd::load_plan(simulation.plan).home_deg)
    home_rad.push_back(sweepd::radians(angle_deg));
  const Eigen::Vector3d flange = identify::forward_kinematics(arm, home_rad).translation();
  for (std::size_t i = 0; i < 3; ++i)
    CHECK(*rsi::number(telegram.signals()[i].text) ==
          Approx(flange(static_cast<Eigen::Index>(i))).margin(0.005 + 1e-9));
}

TEST_CASE("a quiet simulation says nothing unless something is wrong", "[simulate_command]") {
  const TemporaryFolder folder;
  auto simulation = simulation_of(write_plan(folder, "100"));
  simulation.write = folder / "trace.pcap";
  simulation.quiet = true;
  const auto outcome = run(simulation);
  CHECK(outcome.code == 0);
  CHECK(outcome.report.empty());
  CHECK(outcome.errors.empty());
}

TEST_CASE("a disk that is full in the middle ends the simulation, which says what to do",
          "[simulate_command]") {
  const TemporaryFolder folder;
  auto simulation = simulation_of();
  simulation.write = folder / "trace.pcap";
  rlimit before{};
  REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1'000'000, before.rlim_max};
  REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
  const auto outcome = run(simulation);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);

  CHECK(outcome.code == 1);
  CHECK_THAT(outcome.errors,
             ContainsSubstring("sweepd: cannot write capture") && ContainsSubstring("make room"));
  CHECK_THAT(outcome.report, ContainsSubstring("it ended before the plan was over"));
}

TEST_CASE("what is wrong with files or options is thrown before anything is sent or written",
          "[simulate_command]") {
  const TemporaryFolder folder;
  auto simulation = simulation_of(write_plan(folder, "10"));
  CHECK_THROWS_AS(run(simulation), std::invalid_argument);

  simulation.write = folder / "trace.pcap";
  simulation.lose_percent = 101;
  CHECK_THROWS_AS(run(simulation), std::invalid_argument);
  simulation.lose_percent = 0;
  simulation.precision = 16;
  CHECK_THROWS_AS(run(simulation), std::invalid_argument);
  simulation.precision = 4;
  simulation.cycle_ms = 0;
  CHECK_THROWS_AS(run(simulation), std::invalid_argument);
  simulation.cycle_ms = 4;
  simulation.plan = folder / "none.toml";
  CHECK_THROWS_AS(run(simulation), sweepd::ConfigError);
  simulation.plan = write_plan(folder, "10");
  simulation.ethernet_config = folder / "none.xml";
  CHECK_THROWS_AS(run(simulation), rsi::EthernetConfigError);
  CHECK_FALSE(fs::exists(folder / "trace.pcap"));

  simulation.ethernet_config.reset();
  simulation.write = folder / "no folder" / "trace.pcap";
  CHECK_THROWS_AS(run(simulation), std::runtime_error);
}
