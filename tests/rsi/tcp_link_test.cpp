// A simulated controller over TCP, with a server or with one that misbehaves.

#include <chrono>
#include <optional>
#include <string>
#include <thread>

#include "rsi/controller/controller_link.hpp"
#include "rsi/server/tcp_server.hpp"
#include "tests/catch.hpp"
#include "tests/eventually.hpp"
#include "tests/rsi/link_program.hpp"
#include "tests/rsi/running_server.hpp"

using namespace std::chrono_literals;
using boost::asio::ip::tcp;
using Catch::Matchers::ContainsSubstring;
using End = rsi::ControllerLink::End;
using rsi::EthernetConfig;
using rsi::LengthPrefix;
using rsi::ReplyFault;
using rsi::TcpServer;
using rsi::test::cycles;
using rsi::test::kLoopback;
using rsi::test::link_options;
using rsi::test::RunningServer;
using Type = EthernetConfig::Element::Type;

namespace {

EthernetConfig tcp_config(bool length_first = false, bool only_send = false) {
  EthernetConfig ethernet;
  ethernet.sentype = "KMC";
  ethernet.only_send = only_send;
  ethernet.protocol = EthernetConfig::Protocol::TCP;
  ethernet.length_first = length_first;
  ethernet.send = {{"DEF_RIst", Type::DOUBLE, 0, false, 0}, {"DEF_Delay", Type::LONG, 0, false, 0}};
  ethernet.receive = {{"RKorr.X", Type::DOUBLE, 1, true, 0}};
  return ethernet;
}

rsi::Server::Options serving(const EthernetConfig& ethernet, std::uint16_t port = 0) {
  rsi::Server::Options options;
  options.listen = {kLoopback, port};
  if (!ethernet.only_send) options.reply.emplace(ethernet);
  return options;
}

/// Takes one connection, and sends `answer` as soon as something comes.
class Misbehaving {
 public:
  explicit Misbehaving(std::string answer) {
    thread_ = std::thread([this, answer = std::move(answer)] {
      tcp::socket socket(context_);
      acceptor_.accept(socket);
      std::array<char, 2000> telegram{};
      boost::system::error_code error;
      socket.receive(boost::asio::buffer(telegram), 0, error);
      socket.send(boost::asio::buffer(answer), 0, error);
      while (!error) socket.receive(boost::asio::buffer(telegram), 0, error);
    });
  }
  ~Misbehaving() { thread_.join(); }
  rsi::Endpoint endpoint() const { return {kLoopback, acceptor_.local_endpoint().port()}; }

 private:
  boost::asio::io_context context_;
  tcp::acceptor acceptor_{context_, {boost::asio::ip::address_v4::loopback(), 0}};
  std::thread thread_;
};

}  // namespace

TEST_CASE("a link over TCP streams a program and takes the replies, with lengths or without",
          "[tcp_link]") {
  const auto form =
      GENERATE(LengthPrefix::none, LengthPrefix::decimal, LengthPrefix::binary16_be,
               LengthPrefix::binary16_le, LengthPrefix::binary32_be, LengthPrefix::binary32_le);
  INFO(rsi::text(form));
  const auto ethernet = tcp_config(form != LengthPrefix::none);
  RunningServer<TcpServer> running(serving(ethernet));
  auto with_form = link_options(running.server.local());
  with_form.length = form;
  rsi::ControllerLink link(ethernet, with_form);
  const auto local = link.local();
  const auto report = link.run(cycles(50));
  // On a busy machine the last telegrams may still be on their way.
  CHECK(sweepd::test::eventually([&] {
    const auto counts = running.server.counts();
    return counts.answered + counts.superseded == report.controller.telegrams;
  }));
  running.stop();

  CHECK(report.end == End::done);
  CHECK(report.controller.telegrams + report.skipped == 50);
  CHECK(report.send_failures == 0);
  // A busy machine may make replies late, but nothing else may be wrong with them.
  CHECK(report.controller.accepted > 0);
  CHECK(report.controller.accepted + report.controller.unanswered == report.controller.telegrams);
  for (std::size_t kind = 0; kind < rsi::kReplyFaults; ++kind)
    if (kind != static_cast<std::size_t>(ReplyFault::late))
      CHECK(report.controller.faults[kind] == 0);
  CHECK(running.server.counts().skipped == 0);
  rsi::Datagram datagram;
  REQUIRE(running.server.datagrams().pop(datagram));
  CHECK(datagram.payload.starts_with("<Rob"));
  CHECK(datagram.source == local);
}

TEST_CASE("a link over TCP that only sends gets nothing and ends as planned", "[tcp_link]") {
  const auto ethernet = tcp_config(false, true);
  RunningServer<TcpServer> running(serving(ethernet));
  rsi::ControllerLink link(ethernet, link_options(running.server.local()));
  const auto report = link.run(cycles(50));
  CHECK(report.end == End::done);
  CHECK(report.controller.replies == 0);
  std::uint64_t telegrams = 0;
  const auto deadline = std::chrono::steady_clock::now() + 10s;
  for (rsi::Datagram datagram;
       telegrams < report.controller.telegrams && std::chrono::steady_clock::now() < deadline;)
    telegrams += running.server.datagrams().pop(datagram);
  CHECK(telegrams == report.controller.telegrams);
}

TEST_CASE("over TCP somebody must listen", "[tcp_link]") {
  std::optional<RunningServer<TcpServer>> running(serving(tcp_config()));
  const auto address = running->server.local();
  running.reset();
  CHECK_THROWS_WITH(rsi::ControllerLink(tcp_config(), link_options(address)),
                    ContainsSubstring("cannot connect to " + rsi::text(address)) &&
                        ContainsSubstring("start `sweepd run` there first"));
}

TEST_CASE("a connection that breaks ends the link, and a new link goes on with a new server",
          "[tcp_link]") {
  const auto ethernet = tcp_config();
  std::optional<RunningServer<TcpServer>> running(serving(ethernet));
  const auto address = running->server.local();
  rsi::ControllerLink link(ethernet, link_options(address));
  const auto report = link.run([&](std::uint64_t cycle, rsi::SignalValues&) {
    if (cycle == 10) running.reset();
    return cycle < 10'000;
  });
  CHECK(report.end == End::disconnected);
  CHECK_FALSE(report.disconnection.empty());
  CHECK(report.controller.telegrams + report.skipped >= 10);
  CHECK(report.controller.telegrams < 10'000);
  CHECK(report.send_failures == 0);

  running.emplace(serving(ethernet, address.port));
  rsi::ControllerLink again(ethernet, link_options(address));
  CHECK(again.run(cycles(10)).end == End::done);
}

TEST_CASE("what cannot be told apart as replies ends a link over TCP, with the reason",
          "[tcp_link]") {
  const std::string reply = "<Sen Type=\"KMC\"><IPOC>7000</IPOC></Sen>";
  const auto [length_first, answer, reason] = GENERATE_COPY(table<bool, std::string, std::string>(
      {{true, reply, "expected decimal digits, found none"},
       {false, std::to_string(reply.size()) + reply, "expected none, found decimal digits"},
       {false, std::string(50, '?'), "what is no reply"}}));
  const auto ethernet = tcp_config(length_first);
  Misbehaving server(answer);
  rsi::ControllerLink link(ethernet, link_options(server.endpoint()));
  const auto report = link.run(cycles(10'000));
  CHECK(report.end == End::disconnected);
  CHECK_THAT(report.disconnection, ContainsSubstring(reason));
}
