#include "daemon/simulate_command.hpp"

#include <array>
#include <csignal>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <thread>

#include <catch2/catch.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "daemon/config_error.hpp"
#include "daemon/simulated_robot.hpp"
#include "daemon/units.hpp"
#include "rsi/capture_reader.hpp"
#include "rsi/controller_link.hpp"
#include "rsi/ipoc.hpp"
#include "rsi/reply.hpp"
#include "rsi/telegram.hpp"

using boost::asio::ip::udp;
using Catch::Matchers::Contains;
using sweepd::simulate;
using sweepd::SimulateOptions;
namespace fs = std::filesystem;

namespace {

const fs::path kConfig = fs::path(SWEEPD_SOURCE_DIR) / "config";

/// A folder of its own, with what a simulation needs.
class Folder {
 public:
  Folder() { fs::create_directories(path_); }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  fs::path operator/(const char* name) const { return path_ / name; }
  fs::path write(const char* name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }
  /// One joint turns through five degrees there and back, in `seconds` and 0.1 s more.
  fs::path plan(const std::string& speed_deg_s) const {
    return write("plan.toml",
                 "home_deg = [90, -90, 90, 0, 90, 0]\n"
                 "positioning_speed_deg_s = 1000\nacceleration_deg_s2 = 100000\ndwell_ms = 20\n"
                 "[[sweep]]\njoint = 6\nstart_deg = 0\nend_deg = 5\nspeed_deg_s = " +
                     speed_deg_s + "\n");
  }

 private:
  fs::path path_ = fs::temp_directory_path() / ("sweepd-simulate-" + std::to_string(getpid()));
};

SimulateOptions options(const fs::path& plan = kConfig / "plans/kr5_arc_30deg.toml") {
  SimulateOptions result;
  result.robot = kConfig / "robots/kr5_arc.toml";
  result.plan = plan;
  return result;
}

struct Outcome {
  int code;
  std::string report;
  std::string errors;
};

Outcome run(const SimulateOptions& options) {
  std::ostringstream report;
  std::ostringstream errors;
  const int code = simulate(options, report, errors);
  return {code, report.str(), errors.str()};
}

std::string bytes(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

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

/// Answers telegrams on a thread as long as it lives.
class Server {
 public:
  /// What to answer to the telegram of this number, from 0; empty: nothing.
  using Answer = std::function<std::string_view(std::uint64_t number, std::string_view telegram)>;

  explicit Server(Answer answer)
      : answer_(std::move(answer)), socket_(context_, udp::endpoint(kLoopback, 0)) {
    address_ = socket_.local_endpoint();
    thread_ = std::thread([this] { serve(); });
  }
  ~Server() {
    udp::socket socket(context_, udp::v4());
    socket.send_to(boost::asio::buffer("quit", 4), address_);
    thread_.join();
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  rsi::Endpoint endpoint() const { return {kLoopback.to_uint(), address_.port()}; }

 private:
  static inline const auto kLoopback = boost::asio::ip::address_v4::loopback();

  void serve() {
    std::array<char, 2048> buffer{};
    for (std::uint64_t number = 0;;) {
      udp::endpoint source;
      boost::system::error_code error;
      const auto size = socket_.receive_from(boost::asio::buffer(buffer), source, 0, error);
      if (error) continue;  // the controller's socket is gone already
      const std::string_view telegram(buffer.data(), size);
      if (telegram == "quit") return;
      const auto reply = answer_(number++, telegram);
      if (!reply.empty())
        socket_.send_to(boost::asio::buffer(reply.data(), reply.size()), source, 0, error);
    }
  }

  Answer answer_;
  boost::asio::io_context context_;
  udp::socket socket_;
  udp::endpoint address_;
  std::thread thread_;
};

/// The reply that the built-in Ethernet file asks for.
class RightReply {
 public:
  std::string_view operator()(std::string_view telegram) {
    return reply_.with_ipoc(rsi::find_ipoc(telegram));
  }

 private:
  rsi::Reply reply_{rsi::EthernetConfig::load(kConfig / "controller/krc4/sweepd_ethernet.xml")};
};

/// A slow cycle, so that a busy machine is in time all the same.
SimulateOptions live(const Folder& folder, const rsi::Endpoint& server,
                     const std::string& speed_deg_s = "10") {
  auto result = options(folder.plan(speed_deg_s));
  result.to = server;
  result.cycle_ms = 20;
  return result;
}

}  // namespace

TEST_CASE(
    "a capture holds each cycle's telegram with the time, IPOC and addresses of a controller") {
  const Folder folder;
  auto simulation = options();
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
  CHECK_THAT(outcome.report, Contains(std::to_string(telegrams.size()) + " one each 12 ms"));

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

TEST_CASE("the same options write the same bytes, another seed writes others") {
  const Folder folder;
  auto simulation = options(folder.plan("5"));
  simulation.lose_percent = simulation.duplicate_percent = simulation.swap_percent = 2;
  const auto written = [&](const char* name, std::uint64_t seed) {
    simulation.write = folder / name;
    simulation.seed = seed;
    REQUIRE(run(simulation).code == 0);
    return bytes(folder / name);
  };
  const auto first = written("1.pcap", 8);
  CHECK(first.size() > 50'000);
  CHECK(first == written("2.pcap", 8));
  CHECK(first != written("3.pcap", 9));
}

TEST_CASE("faults on purpose are in the capture as they are reported") {
  const Folder folder;
  auto simulation = options();
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
  CHECK_THAT(outcome.report, Contains(row("telegrams", sent)) &&
                                 Contains(row("  lost on purpose", lost)) &&
                                 Contains(row("  duplicated on purpose", duplicated)) &&
                                 Contains(row("  swapped on purpose", swapped)));
}

TEST_CASE("the built-in Ethernet file is the one that is shipped") {
  const Folder folder;
  auto simulation = options(folder.plan("100"));
  simulation.write = folder / "built-in.pcap";
  REQUIRE(run(simulation).code == 0);
  simulation.write = folder / "shipped.pcap";
  simulation.ethernet_config = kConfig / "controller/krc4/sweepd_ethernet.xml";
  REQUIRE(run(simulation).code == 0);
  CHECK(bytes(folder / "built-in.pcap") == bytes(folder / "shipped.pcap"));
}

TEST_CASE("an Ethernet file tells elements and port, the options decimals and tool point") {
  const Folder folder;
  auto simulation = options(folder.plan("100"));
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
  CHECK_THAT(first.payload, Contains("<Rob Type=\"KUKA\"><RIst X=\"") && Contains("</IPOC></Rob>"));
  CHECK_THAT(first.payload, !Contains("AIPos"));
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

TEST_CASE("a quiet simulation says nothing unless something is wrong") {
  const Folder folder;
  auto simulation = options(folder.plan("100"));
  simulation.write = folder / "trace.pcap";
  simulation.quiet = true;
  const auto outcome = run(simulation);
  CHECK(outcome.code == 0);
  CHECK(outcome.report.empty());
  CHECK(outcome.errors.empty());
}

TEST_CASE("a disk that is full in the middle ends the simulation, which says what to do") {
  const Folder folder;
  auto simulation = options();
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
  CHECK_THAT(outcome.errors, Contains("sweepd: cannot write capture") && Contains("make room"));
  CHECK_THAT(outcome.report, Contains("it ended before the plan was over"));
}

TEST_CASE("a plan is played to its end against a server that answers") {
  const Folder folder;
  RightReply right;
  Server server([&](std::uint64_t, std::string_view telegram) { return right(telegram); });
  const auto outcome = run(live(folder, server.endpoint()));
  CHECK(outcome.errors == "");
  CHECK(outcome.code == 0);
  CHECK_THAT(outcome.report, Contains("the plan was played to its end") &&
                                 Contains("cycles unanswered                0") &&
                                 Contains("latency p99.9"));
}

TEST_CASE("what was spoilt on purpose does not fail a server that answers everything") {
  const Folder folder;
  RightReply right;
  Server server([&](std::uint64_t, std::string_view telegram) { return right(telegram); });
  auto simulation = live(folder, server.endpoint());
  simulation.lose_percent = simulation.duplicate_percent = simulation.swap_percent = 15;
  simulation.seed = 3;
  const auto outcome = run(simulation);
  CHECK(outcome.errors == "");
  CHECK(outcome.code == 0);
  for (const char* none :
       {"lost on purpose                0\n", "duplicated on purpose          0\n",
        "swapped on purpose             0 "})
    CHECK_THAT(outcome.report, !Contains(none));
}

TEST_CASE("where nobody answers the controller stops, and says what to do") {
  const Folder folder;
  Server server([](auto&&...) { return std::string_view(); });
  auto simulation = live(folder, server.endpoint());
  simulation.timeout_cycles = 5;
  simulation.cycle_ms = 1;
  const auto outcome = run(simulation);
  CHECK(outcome.code == 1);
  CHECK(outcome.errors == "sweepd: nobody answered at " + rsi::text(server.endpoint()) +
                              ": start `sweepd run` there, or check address and port\n");
  CHECK_THAT(outcome.report, Contains("the controller stopped for want of replies") &&
                                 Contains("telegrams                        5"));
}

TEST_CASE("a server that answers wrongly fails, and the first fault is said") {
  const Folder folder;
  RightReply right;
  Server server([&](std::uint64_t number, std::string_view telegram) {
    return number == 2 ? "<Sen Type=\"Other\"><EStr></EStr><IPOC>1</IPOC></Sen>" : right(telegram);
  });
  const auto outcome = run(live(folder, server.endpoint()));
  CHECK(outcome.code == 1);
  CHECK_THAT(outcome.errors, Contains("sweepd: 1 reply was refused") && Contains("wrong Type"));
  CHECK_THAT(outcome.report, Contains("1 wrong Type") && Contains("played to its end"));
}

TEST_CASE("SIGINT and SIGTERM end a simulation in order, with its report") {
  const Folder folder;
  const int signal = GENERATE(SIGINT, SIGTERM);
  RightReply right;
  Server server([&](std::uint64_t number, std::string_view telegram) {
    if (number == 3) kill(getpid(), signal);
    return right(telegram);
  });
  // Would take 500 s.
  const auto outcome = run(live(folder, server.endpoint(), "0.01"));
  CHECK(outcome.code == 1);
  CHECK_THAT(outcome.errors, Contains("a signal stopped the simulation"));
  CHECK_THAT(outcome.report,
             Contains("telegrams                        4") && Contains("a signal stopped it"));
}

TEST_CASE("what is wrong with files or options is thrown before anything is sent or written") {
  const Folder folder;
  auto simulation = options(folder.plan("10"));
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
  simulation.plan = folder.plan("10");
  simulation.ethernet_config = folder / "none.xml";
  CHECK_THROWS_AS(run(simulation), rsi::EthernetConfigError);
  CHECK_FALSE(fs::exists(folder / "trace.pcap"));

  simulation.ethernet_config.reset();
  simulation.write = folder / "no folder" / "trace.pcap";
  CHECK_THROWS_AS(run(simulation), std::runtime_error);
}
