#include <array>
#include <csignal>
#include <functional>
#include <thread>

#include <unistd.h>

#include "rsi/controller/controller_link.hpp"
#include "rsi/telegram/ipoc.hpp"
#include "rsi/telegram/reply.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/simulations.hpp"
#include "tests/eventually.hpp"

using boost::asio::ip::udp;
using Catch::Matchers::ContainsSubstring;
using namespace sweepd::test;

namespace {

/// Answers telegrams on a thread as long as it lives.
class ScriptedServer {
 public:
  /// What to answer to the telegram of this number, from 0; empty: nothing.
  using Answer = std::function<std::string_view(std::uint64_t number, std::string_view telegram)>;

  explicit ScriptedServer(Answer answer)
      : answer_(std::move(answer)), socket_(context_, udp::endpoint(kLoopback, 0)) {
    address_ = socket_.local_endpoint();
    thread_ = std::thread([this] { serve(); });
  }
  ~ScriptedServer() {
    udp::socket socket(context_, udp::v4());
    socket.send_to(boost::asio::buffer("quit", 4), address_);
    thread_.join();
  }
  ScriptedServer(const ScriptedServer&) = delete;
  ScriptedServer& operator=(const ScriptedServer&) = delete;

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

/// A cycle so slow that a busy machine is in time all the same.
sweepd::SimulateOptions live(const TemporaryFolder& folder, const rsi::Endpoint& server,
                             const std::string& speed_deg_s = "20") {
  auto result = simulation_of(write_plan(folder, speed_deg_s));
  result.to = server;
  result.cycle_ms = 100;
  return result;
}

}  // namespace

TEST_CASE("a plan is played to its end against a server that answers", "[simulate_live][live]") {
  const TemporaryFolder folder;
  RightReply right;
  ScriptedServer server([&](std::uint64_t, std::string_view telegram) { return right(telegram); });
  const auto outcome = run(live(folder, server.endpoint()));
  CHECK(outcome.errors == "");
  CHECK(outcome.code == 0);
  CHECK_THAT(outcome.report, ContainsSubstring("the plan was played to its end") &&
                                 ContainsSubstring("cycles unanswered                0") &&
                                 ContainsSubstring("latency p99.9"));
}

TEST_CASE("what was spoilt on purpose does not fail a server that answers everything",
          "[simulate_live][live]") {
  const TemporaryFolder folder;
  RightReply right;
  ScriptedServer server([&](std::uint64_t, std::string_view telegram) { return right(telegram); });
  auto simulation = live(folder, server.endpoint(), "3");
  simulation.lose_percent = simulation.duplicate_percent = simulation.swap_percent = 20;
  simulation.seed = 3;
  const auto outcome = run(simulation);
  CHECK(outcome.errors == "");
  CHECK(outcome.code == 0);
  for (const char* none :
       {"lost on purpose                0\n", "duplicated on purpose          0\n",
        "swapped on purpose             0 "})
    CHECK_THAT(outcome.report, !ContainsSubstring(none));
}

TEST_CASE("where nobody answers the controller stops, and says what to do", "[simulate_live]") {
  const TemporaryFolder folder;
  ScriptedServer server([](auto&&...) { return std::string_view(); });
  auto simulation = live(folder, server.endpoint(), "0.1");  // a busy machine skips cycles
  simulation.timeout_cycles = 5;
  simulation.cycle_ms = 1;
  const auto outcome = run(simulation);
  CHECK(outcome.code == 1);
  CHECK(outcome.errors == "sweepd: nobody answered at " + rsi::text(server.endpoint()) +
                              ": start `sweepd run` there, or check address and port\n");
  CHECK_THAT(outcome.report, ContainsSubstring("the controller stopped for want of replies") &&
                                 ContainsSubstring("telegrams                        5"));
}

TEST_CASE("a server that answers wrongly fails, and the first fault is said",
          "[simulate_live][live]") {
  const TemporaryFolder folder;
  RightReply right;
  ScriptedServer server([&](std::uint64_t number, std::string_view telegram) {
    return number == 2 ? "<Sen Type=\"Other\"><EStr></EStr><IPOC>1</IPOC></Sen>" : right(telegram);
  });
  const auto outcome = run(live(folder, server.endpoint()));
  CHECK(outcome.code == 1);
  CHECK_THAT(outcome.errors,
             ContainsSubstring("sweepd: 1 reply was refused") && ContainsSubstring("wrong Type"));
  CHECK_THAT(outcome.report,
             ContainsSubstring("1 wrong Type") && ContainsSubstring("played to its end"));
}

TEST_CASE("replies with tags left out are right by a controller's check, and wrong by sweepd's",
          "[simulate_live][live][issue11][point_18]") {
  const TemporaryFolder folder;
  std::string reply;
  ScriptedServer server([&](std::uint64_t, std::string_view telegram) {
    reply = "<Sen Type=\"ImFree\"><Tech T21=\"1.09\"/><IPOC>" +
            std::string(rsi::find_ipoc(telegram)) + "</IPOC></Sen>";
    return std::string_view(reply);
  });
  auto simulation = live(folder, server.endpoint());
  const auto by_controller = run(simulation);
  CHECK(by_controller.errors == "");
  CHECK(by_controller.code == 0);
  CHECK_THAT(by_controller.report, ContainsSubstring("replies refused                  0") &&
                                       ContainsSubstring("which controllers accept") &&
                                       ContainsSubstring("missing tag: DEF_EStr") &&
                                       !ContainsSubstring("correction"));
  simulation.check = rsi::ReplyRule::sweepd;
  simulation.timeout_cycles = 3;
  const auto by_sweepd = run(simulation);
  CHECK(by_sweepd.code == 1);
  CHECK_THAT(by_sweepd.errors, ContainsSubstring("missing tag: DEF_EStr"));
}

TEST_CASE("SIGINT and SIGTERM end a simulation in order, with its report",
          "[simulate_live][live]") {
  const TemporaryFolder folder;
  const int signal = GENERATE(SIGINT, SIGTERM);
  RightReply right;
  ScriptedServer server([&](std::uint64_t number, std::string_view telegram) {
    if (number == 3) kill(getpid(), signal);
    return right(telegram);
  });
  // Would take 500 s.
  const auto outcome = run(live(folder, server.endpoint(), "0.01"));
  CHECK(outcome.code == 1);
  CHECK_THAT(outcome.errors, ContainsSubstring("a signal stopped the simulation"));
  CHECK_THAT(outcome.report, ContainsSubstring("telegrams                        4") &&
                                 ContainsSubstring("a signal stopped it"));
}

TEST_CASE("a capture that a signal stops is not there, and that is said", "[simulate_live][live]") {
  const TemporaryFolder folder;
  // Half a million telegrams.
  auto simulation = simulation_of(write_plan(folder, "0.01"));
  simulation.cycle_ms = 1;
  simulation.write = folder / "trace.pcap";
  const std::jthread stops([&] {
    if (eventually([&] { return std::filesystem::exists(folder / ".trace.pcap.sweepd~"); }))
      kill(getpid(), SIGTERM);
  });
  const auto outcome = run(simulation);
  CHECK(outcome.code == 1);
  CHECK(outcome.errors == "sweepd: a signal stopped the simulation before the plan was over, and " +
                              (folder / "trace.pcap").string() + " is not written: run it again\n");
  CHECK_FALSE(std::filesystem::exists(folder / "trace.pcap"));
  CHECK_FALSE(std::filesystem::exists(folder / ".trace.pcap.sweepd~"));
}
