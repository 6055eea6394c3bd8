#include "rsi/controller/controller_link.hpp"

#include <functional>
#include <future>
#include <stdexcept>
#include <thread>
#include <vector>

#include "rsi/telegram/ipoc.hpp"
#include "tests/catch.hpp"
#include "tests/rsi/link_program.hpp"

using namespace std::chrono_literals;
using boost::asio::ip::udp;
using End = rsi::ControllerLink::End;
using Catch::Matchers::ContainsSubstring;
using rsi::EthernetConfig;
using rsi::ReplyFault;
using rsi::test::cycles;
using rsi::test::link_options;
using Type = EthernetConfig::Element::Type;

namespace {

const auto kLoopbackAddress = boost::asio::ip::address_v4::loopback();

EthernetConfig udp_config(bool only_send = false) {
  EthernetConfig ethernet;
  ethernet.sentype = "ImFree";
  ethernet.only_send = only_send;
  ethernet.send = {{"DEF_RIst", Type::DOUBLE, 0, false, 0}, {"DEF_Delay", Type::LONG, 0, false, 0}};
  ethernet.receive = {{"AK.A1", Type::DOUBLE, 1, true, 0}};
  return ethernet;
}

/// Receives on a thread until join(); what came in may be read after that.
class Peer {
 public:
  using Answer = std::function<void(udp::socket&, const std::string&, const udp::endpoint&)>;

  explicit Peer(Answer answer = [](auto&&...) {}) : answer_(std::move(answer)) {
    thread_ = std::thread([this] { serve(); });
  }
  ~Peer() {
    if (thread_.joinable()) join();
  }

  rsi::Endpoint endpoint() const { return {kLoopbackAddress.to_uint(), address_.port()}; }

  void join() {
    // Comes after everything that was sent before: loopback keeps the order.
    udp::socket socket(context_, udp::v4());
    socket.send_to(boost::asio::buffer("quit", 4), address_);
    thread_.join();
  }

  std::vector<std::string> received;

 private:
  void serve() {
    std::array<char, 2048> buffer{};
    for (;;) {
      udp::endpoint source;
      boost::system::error_code error;
      const auto size = socket_.receive_from(boost::asio::buffer(buffer), source, 0, error);
      if (error) continue;  // the link's socket is gone already
      const std::string datagram(buffer.data(), size);
      if (datagram == "quit") return;
      received.push_back(datagram);
      answer_(socket_, datagram, source);
    }
  }

  Answer answer_;
  boost::asio::io_context context_;
  udp::socket socket_{context_, udp::endpoint(kLoopbackAddress, 0)};
  udp::endpoint address_ = socket_.local_endpoint();
  std::thread thread_;
};

void send(udp::socket& socket, std::string_view text, const udp::endpoint& to) {
  boost::system::error_code ignored;
  socket.send_to(boost::asio::buffer(text.data(), text.size()), to, 0, ignored);
}

/// Which cycle of cycles() this telegram is.
std::uint64_t cycle_of(const std::string& telegram) {
  constexpr std::string_view kBefore = "<RIst X=\"";
  return std::stoull(telegram.substr(telegram.find(kBefore) + kBefore.size()));
}

/// Nobody listens here: the port was free a moment ago.
rsi::Endpoint closed_port() {
  boost::asio::io_context context;
  const udp::socket socket(context, udp::endpoint(kLoopbackAddress, 0));
  return {kLoopbackAddress.to_uint(), socket.local_endpoint().port()};
}

}  // namespace

TEST_CASE("a link streams a program in real time and takes the replies", "[controller_link]") {
  rsi::Reply reply(udp_config());
  Peer peer([&](udp::socket& socket, const std::string& telegram, const udp::endpoint& source) {
    send(socket, reply.with_ipoc(rsi::find_ipoc(telegram)), source);
  });
  rsi::ControllerLink link(udp_config(), link_options(peer.endpoint(), 10ms));
  std::uint64_t progress_calls = 0;
  const auto start = std::chrono::steady_clock::now();
  const auto report =
      link.run(cycles(120), [&](const rsi::SimulatedController&) { ++progress_calls; });
  const auto elapsed = std::chrono::steady_clock::now() - start;
  peer.join();

  CHECK(report.end == End::done);
  // A busy machine may oversleep cycles and make replies late, but nothing else may be wrong.
  const auto telegrams = report.controller.telegrams;
  CHECK(telegrams + report.skipped == 120);
  CHECK(report.send_failures == 0);
  CHECK(progress_calls == 1);
  // The last telegram has its cycle too; how much longer it took is up to the machine.
  CHECK(elapsed >= 120 * 10ms);
  CHECK(report.controller.accepted > 0);
  CHECK(report.controller.accepted + report.controller.unanswered == telegrams);
  CHECK(report.latency.count() == report.controller.accepted);
  CHECK(report.latency.max() < 10ms);
  for (std::size_t kind = 0; kind < rsi::kReplyFaults; ++kind)
    if (kind != static_cast<std::size_t>(ReplyFault::late))
      CHECK(report.controller.faults[kind] == 0);

  CHECK(peer.received.size() == telegrams);
  for (const auto& telegram : peer.received)
    CHECK(rsi::find_ipoc(telegram) == std::to_string(7000 + 10 * cycle_of(telegram)));
}

TEST_CASE("while a machine oversleeps no telegram leaves, and robot and IPOC go on with time",
          "[controller_link][issue11][point_16]") {
  Peer peer;
  rsi::ControllerLink link(udp_config(true), link_options(peer.endpoint(), 5ms));
  // The program holds everything up until five cycles are over.
  std::vector<std::chrono::steady_clock::time_point> called;
  const auto program = cycles(20);
  const auto report = link.run([&](std::uint64_t cycle, rsi::SignalValues& values) {
    const auto now = std::chrono::steady_clock::now();
    called.push_back(now);
    if (cycle == 2)
      while (std::chrono::steady_clock::now() < now + 25ms) {
      }
    return program(cycle, values);
  });
  peer.join();
  CHECK(report.end == End::done);
  CHECK(report.skipped >= 5);
  CHECK(report.controller.telegrams + report.skipped == 20);
  REQUIRE(peer.received.size() == report.controller.telegrams);
  for (const auto& telegram : peer.received)
    CHECK(rsi::find_ipoc(telegram) == std::to_string(7000 + 5 * cycle_of(telegram)));
  // Cycle k is never early on the grid that begins with cycle 0, and no cycle is put in.
  REQUIRE(called.size() == 21);
  CHECK(called[20] - called[0] >= 20 * 5ms - 1ms);
}

TEST_CASE("a closed port is no error: the cycles go unanswered until the controller stops",
          "[controller_link]") {
  rsi::ControllerLink link(udp_config(), link_options(closed_port(), 1ms, 10));
  const auto report = link.run(cycles(1000));
  CHECK(report.end == End::timed_out);
  CHECK(report.controller.telegrams == 10);
  CHECK(report.controller.unanswered == 10);
  CHECK(report.controller.replies == 0);
}

TEST_CASE("a link that only sends needs nobody at the other end", "[controller_link]") {
  rsi::ControllerLink link(udp_config(true), link_options(closed_port(), 1ms, 3));
  const auto report = link.run(cycles(50));
  CHECK(report.end == End::done);
  CHECK(report.controller.telegrams + report.skipped == 50);
}

TEST_CASE("another thread stops a link", "[controller_link]") {
  rsi::ControllerLink link(udp_config(true), link_options(closed_port(), 1ms));
  std::promise<void> running;
  std::thread stopper([&] {
    running.get_future().wait();
    link.stop();
  });
  const auto report = link.run([&](std::uint64_t cycle, rsi::SignalValues&) {
    if (cycle == 3) running.set_value();
    return true;
  });
  stopper.join();
  CHECK(report.end == End::stopped);
  CHECK(report.controller.telegrams + report.skipped >= 4);
}

TEST_CASE("a stop before the run prevents it", "[controller_link]") {
  rsi::ControllerLink link(udp_config(true), link_options(closed_port(), 1ms));
  link.stop();
  CHECK(link.run(cycles(5)).controller.telegrams == 0);
}

TEST_CASE("replies from another socket are not the server's", "[controller_link]") {
  rsi::Reply reply(udp_config());
  boost::asio::io_context context;
  udp::socket elsewhere(context, udp::endpoint(kLoopbackAddress, 0));
  Peer peer([&](udp::socket&, const std::string& telegram, const udp::endpoint& source) {
    send(elsewhere, reply.with_ipoc(rsi::find_ipoc(telegram)), source);
  });
  rsi::ControllerLink link(udp_config(), link_options(peer.endpoint(), 10ms, 5));
  const auto report = link.run(cycles(1000));
  peer.join();
  CHECK(report.end == End::timed_out);
  CHECK(report.controller.accepted == 0);
  CHECK(report.controller.of(ReplyFault::wrong_source) > 0);
  CHECK_THAT(report.first_fault,
             ContainsSubstring("wrong source") && ContainsSubstring(rsi::text(peer.endpoint())));
}

TEST_CASE("the faults of the wire are on the wire as they are counted", "[controller_link]") {
  Peer peer;
  auto faulty = link_options(peer.endpoint(), 1ms);
  faulty.faults = {.lose = 0.1, .duplicate = 0.1, .swap = 0.1};
  faulty.seed = 4;
  rsi::ControllerLink link(udp_config(true), faulty);
  const auto report = link.run(cycles(200));
  peer.join();
  CHECK(report.wire.lost > 0);
  CHECK(report.wire.duplicated > 0);
  CHECK(report.wire.swapped > 0);
  CHECK(report.controller.telegrams + report.skipped == 200);
  CHECK(peer.received.size() ==
        report.controller.telegrams - report.wire.lost + report.wire.duplicated);
}

TEST_CASE("what a program throws comes out of the run", "[controller_link]") {
  rsi::ControllerLink link(udp_config(true), link_options(closed_port(), 1ms));
  CHECK_THROWS_WITH(link.run([](std::uint64_t, rsi::SignalValues&) -> bool {
    throw std::runtime_error("the robot is elsewhere");
  }),
                    "the robot is elsewhere");
}

TEST_CASE("a link that cannot be says so before it runs", "[controller_link]") {
  CHECK_THROWS_WITH(
      rsi::ControllerLink(udp_config(), link_options({kLoopbackAddress.to_uint(), 0}, 4ms)),
      ContainsSubstring("127.0.0.1:0") && ContainsSubstring("give address and port"));
  Peer peer;
  auto taken = link_options(peer.endpoint(), 4ms);
  taken.local = peer.endpoint();
  CHECK_THROWS_WITH(rsi::ControllerLink(udp_config(), taken),
                    ContainsSubstring("cannot send from " + rsi::text(peer.endpoint())));
}
