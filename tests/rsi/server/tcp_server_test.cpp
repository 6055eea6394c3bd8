#include "rsi/server/tcp_server.hpp"

#include <chrono>
#include <string>
#include <thread>

#include <linux/sockios.h>
#include <sys/ioctl.h>

#include "rsi/asio.hpp"

#include "rsi/server/udp_server.hpp"
#include "tests/catch.hpp"
#include "tests/rsi/running_server.hpp"
#include "tests/rsi/with_length.hpp"

using namespace std::chrono_literals;
using namespace rsi::test;
using boost::asio::ip::tcp;
using rsi::Datagram;
using rsi::LengthPrefix;
using rsi::TcpServer;

namespace {

using TcpRunning = RunningServer<TcpServer>;

/// A controller's end of a connection.
struct TcpController {
  explicit TcpController(const TcpServer& server, std::uint32_t address = kLoopback,
                         int receive_buffer = 65536)
      : socket(context) {
    socket.open(tcp::v4());
    socket.set_option(tcp::socket::receive_buffer_size(receive_buffer));
    socket.bind({boost::asio::ip::address_v4(address), 0});
    socket.connect({boost::asio::ip::address_v4(server.local().address), server.local().port});
    socket.set_option(tcp::no_delay(true));
    wait_ten_seconds(socket);
  }
  void send(const std::string& bytes) { socket.send(boost::asio::buffer(bytes)); }
  /// So many bytes; fewer if the connection is closed or nothing comes for ten seconds.
  std::string receive(std::size_t bytes) { return received_by(socket, bytes, MSG_WAITALL); }
  /// Sends a telegram and takes the reply; whether it is the right one.
  bool answered(std::uint64_t ipoc) {
    send(telegram(ipoc));
    return receive(reply(ipoc).size()) == reply(ipoc);
  }
  /// Whether the server ends the connection within ten seconds, reset or not.
  bool closed_by_server() {
    char byte = 0;
    const auto size = ::recv(socket.native_handle(), &byte, 1, 0);
    return size == 0 || (size < 0 && errno == ECONNRESET);
  }
  boost::asio::io_context context;
  tcp::socket socket;
};

}  // namespace

TEST_CASE("over TCP each telegram is answered with its IPOC, and both are handed over",
          "[tcp_server]") {
  TcpRunning running(on_loopback());
  TcpController controller(running.server);
  const auto port = controller.socket.local_endpoint().port();
  for (std::uint64_t ipoc = 1000; ipoc < 1040; ipoc += 4) {
    CHECK(controller.answered(ipoc));
    check_handed_over(running, ipoc, {kLoopback, port});
  }
  running.stop();
  CHECK(running.server.counts().answered == 10);
  CHECK(running.server.counts().skipped == 0);
}

TEST_CASE("of two telegrams in one segment both are handed over and the newer is answered",
          "[tcp_server]") {
  TcpRunning running(on_loopback());
  TcpController controller(running.server);
  controller.send(telegram(4) + "\n" + telegram(8) + "\n");
  CHECK(controller.receive(reply(8).size()) == reply(8));
  CHECK(running.next().payload == telegram(4));
  CHECK(running.next().payload == telegram(8));
  CHECK(running.next().payload == reply(8));
  CHECK(controller.answered(12));
  running.stop();
  CHECK(running.server.counts().superseded == 1);
  CHECK(running.server.counts().answered == 2);
}

TEST_CASE("a telegram in many segments is answered when it is whole", "[tcp_server]") {
  TcpRunning running(on_loopback());
  TcpController controller(running.server);
  for (const char byte : telegram(4)) controller.send(std::string(1, byte));
  CHECK(controller.receive(reply(4).size()) == reply(4));
  CHECK(running.next().payload == telegram(4));
}

TEST_CASE("what waits when the server starts is all handed over, more than fits one batch too",
          "[tcp_server]") {
  TcpServer server(on_loopback());
  TcpController controller(server);
  constexpr std::uint64_t kTelegrams = 300;
  std::string all;
  for (std::uint64_t k = 1; k <= kTelegrams; ++k) all += telegram(1000 + k);
  controller.send(all);
  std::thread thread([&] { server.run(); });
  std::string replies;
  while (replies.find(reply(1000 + kTelegrams)) == std::string::npos) {
    const auto byte = controller.receive(1);
    REQUIRE_FALSE(byte.empty());
    replies += byte;
  }
  server.stop();
  thread.join();
  std::uint64_t telegrams = 0;
  for (Datagram datagram; server.datagrams().pop(datagram);)
    telegrams += datagram.payload.starts_with("<Rob");
  CHECK(telegrams == kTelegrams);
  CHECK(server.counts().answered + server.counts().superseded == kTelegrams);
  CHECK(server.counts().answered < kTelegrams / 2);
}

TEST_CASE("a telegram that waited came when the kernel got it, and not when it was read",
          "[tcp_server]") {
  const TcpServer first(
      on_loopback());  // after the first wish for stamps the kernel needs a moment
  bool stamped = false;
  for (int attempt = 0; attempt < 100 && !stamped; ++attempt) {
    TcpServer server(on_loopback());
    TcpController controller(server);
    controller.send(telegram(4));
    for (int waits = 1; waits > 0; std::this_thread::yield())
      REQUIRE(ioctl(controller.socket.native_handle(), SIOCOUTQ, &waits) == 0);
    const auto started = rsi::now();
    std::thread thread([&] { server.run(); });
    CHECK(controller.receive(reply(4).size()) == reply(4));
    server.stop();
    thread.join();
    Datagram datagram;
    REQUIRE(server.datagrams().pop(datagram));
    CHECK(datagram.payload == telegram(4));
    stamped = datagram.time <= started;
  }
  CHECK(stamped);
}

TEST_CASE("a reply has a length before it if the telegram had one, in the same form",
          "[tcp_server]") {
  TcpRunning running(on_loopback());
  TcpController controller(running.server);
  for (const auto form : {LengthPrefix::decimal, LengthPrefix::binary32_le,
                          LengthPrefix::binary16_be, LengthPrefix::none}) {
    const auto expected = with_length(form, reply(4));
    controller.send(with_length(form, telegram(4)));
    CHECK(controller.receive(expected.size()) == expected);
    CHECK(running.next().payload == telegram(4));
    CHECK(running.next().payload == reply(4));
  }
}

TEST_CASE("garbage on a connection costs nothing but its count", "[tcp_server]") {
  TcpRunning running(on_loopback());
  TcpController controller(running.server);
  controller.send("<IPOC>77</IPOC>");
  CHECK(controller.receive(reply(77).size()) == reply(77));
  controller.send("GET / HTTP/1.1\r\n\r\n" + telegram(4));
  CHECK(controller.receive(reply(4).size()) == reply(4));
  controller.send("<Rob><IPOC>x</IPOC></Rob>");  // whole, but there is no answer to it
  CHECK(controller.answered(8));
  running.stop();
  CHECK(running.server.counts().skipped == std::string("GET/HTTP/1.1").size());
  CHECK(running.server.counts().unanswerable == 1);
}

TEST_CASE("connections of others than the configured controller are closed and counted",
          "[tcp_server]") {
  auto options = on_loopback();
  options.controller = 0x7f000002;  // 127.0.0.2 is this machine too
  TcpRunning running(std::move(options));
  TcpController controller(running.server, 0x7f000002);
  CHECK(controller.answered(4));
  TcpController stranger(running.server);
  CHECK(stranger.closed_by_server());
  CHECK(controller.answered(8));
  running.stop();
  CHECK(running.server.counts().foreign == 1);
}

TEST_CASE("without a configured controller one that says nothing does not keep out the first",
          "[tcp_server]") {
  TcpRunning running(on_loopback());
  TcpController silent(running.server, 0x7f000003);
  TcpController first(running.server, 0x7f000002);
  for (std::uint64_t ipoc : {4U, 8U, 12U, 16U}) CHECK(first.answered(ipoc));
  CHECK(silent.closed_by_server());
  TcpController stranger(running.server);
  CHECK(stranger.closed_by_server());
  CHECK(first.answered(20));
  running.server.forget_controller();
  TcpController next(running.server);
  CHECK(next.answered(4));
  CHECK(first.closed_by_server());
  running.stop();
  CHECK(running.server.counts().foreign == 1);
}

TEST_CASE("where nobody has spoken, who comes third takes the place of who came first",
          "[tcp_server]") {
  TcpRunning running(on_loopback());
  TcpController silent(running.server, 0x7f000002);
  TcpController controller(running.server);
  { TcpController probe(running.server, 0x7f000003); }
  CHECK(silent.closed_by_server());
  for (std::uint64_t ipoc : {4U, 8U, 12U}) CHECK(controller.answered(ipoc));
  running.stop();
}

TEST_CASE("a new connection of the controller takes the place of the one left behind",
          "[tcp_server]") {
  TcpRunning running(on_loopback());
  TcpController old(running.server);
  CHECK(old.answered(4));
  old.send("<Rob><IPOC>9");  // cut off: must not become part of the new stream
  TcpController restarted(running.server);
  CHECK(restarted.answered(1000));
  CHECK(old.closed_by_server());
  CHECK(restarted.answered(1004));
  running.stop();
  CHECK(running.server.counts().foreign == 0);
}

TEST_CASE("a second connection takes the place of the one that is served with its first telegram",
          "[tcp_server][issue11][point_9]") {
  auto options = on_loopback();
  HandClock::time = 1h;
  options.clock = HandClock::now;
  TcpRunning running(std::move(options));
  TcpController controller(running.server);
  CHECK(controller.answered(4));
  TcpController silent(running.server);
  for (std::uint64_t ipoc = 8; ipoc < 100; ipoc += 4) REQUIRE(controller.answered(ipoc));
  SECTION("a part of one does not do") {
    silent.send("<Rob><IPOC>9</IPOC><A></Rob");
    CHECK(controller.answered(100));
    silent.send(">");
    CHECK(silent.receive(reply(9).size()) == reply(9));
    CHECK(controller.closed_by_server());
    CHECK(silent.answered(10));
  }
  SECTION("one that never speaks is closed") {
    running.look_at(1h + 9s);
    CHECK(controller.answered(100));
    running.look_at(1h + 11s);
    CHECK(silent.closed_by_server());
    CHECK(controller.answered(104));
  }
  SECTION("one more takes the place of the one that waits") {
    TcpController third(running.server);
    CHECK(silent.closed_by_server());
    CHECK(controller.answered(100));
    CHECK(third.answered(4));
    CHECK(controller.closed_by_server());
  }
  running.stop();
  CHECK(running.server.counts().foreign == 0);
}

TEST_CASE("over TCP, too, the recording has the addresses that were used",
          "[tcp_server][issue11][point_3]") {
  auto options = on_loopback();
  options.listen.address = 0;
  TcpRunning running(std::move(options));
  boost::asio::io_context context;
  tcp::socket socket(context);
  socket.connect({boost::asio::ip::make_address_v4("127.0.0.3"), running.server.local().port});
  socket.send(boost::asio::buffer(telegram(4)));
  const rsi::Endpoint here{0x7f000003, running.server.local().port};
  CHECK(running.next().destination == here);
  CHECK(running.next().source == here);
}

TEST_CASE("a controller that closes its end is answered to the last telegram, and may come again",
          "[tcp_server]") {
  TcpRunning running(on_loopback());
  for (std::uint64_t ipoc : {4U, 8U}) {
    TcpController controller(running.server);
    controller.send(telegram(ipoc));
    controller.socket.shutdown(tcp::socket::shutdown_send);
    CHECK(controller.receive(reply(ipoc).size()) == reply(ipoc));
    CHECK(controller.closed_by_server());
  }
}

TEST_CASE("over TCP, too, a stream whose beginning was not heard is not answered",
          "[tcp_server][issue11][point_1]") {
  TcpRunning running(from_the_beginning());
  TcpController controller(running.server);
  for (std::uint64_t ipoc : {4U, 8U}) {
    controller.send(telegram(ipoc));
    CHECK(running.next().payload == telegram(ipoc));
  }
  CHECK(running.server.counts().not_begun == 2);
  running.look_at(1h + 999ms);
  controller.send(telegram(12));
  CHECK(running.next().payload == telegram(12));
  CHECK(running.server.counts().not_begun == 3);
  CHECK(running.server.counts().answered == 0);
  running.look_at(1h + 2s);
  CHECK(controller.answered(16));
  TcpController restarted(running.server);  // from another port, within the second
  CHECK(restarted.answered(4));
  running.stop();
  CHECK(running.server.counts().answered == 2);
  CHECK(running.server.counts().not_begun == 3);
}

TEST_CASE("who connects again and again does not hide that the controller was silent",
          "[tcp_server]") {
  auto options = from_the_beginning();
  options.controller = 0x7f000002;
  TcpRunning running(std::move(options));
  for (auto time = 1h + 0ms; time < 1h + 2s; time += 10ms) {
    HandClock::time = time;
    CHECK(TcpController(running.server).closed_by_server());
  }
  TcpController controller(running.server, 0x7f000002);
  controller.send(telegram(4));
  CHECK(running.next().payload == telegram(4));
  running.stop();
  CHECK(running.server.counts().not_begun == 0);
  CHECK(running.server.counts().answered == 1);
}

TEST_CASE("over TCP a controller that only sends gets no reply", "[tcp_server]") {
  auto options = on_loopback();
  options.reply.reset();
  TcpRunning running(std::move(options));
  TcpController controller(running.server);
  controller.send(telegram(4));
  CHECK(running.next().payload == telegram(4));
  controller.send(telegram(8));
  CHECK(running.next().payload == telegram(8));
  running.stop();
  CHECK(running.server.counts().answered == 0);
  CHECK(controller.socket.available() == 0);
}

TEST_CASE("a controller that does not read its replies is disconnected, and nothing waits for it",
          "[tcp_server]") {
  TcpRunning running(on_loopback());
  TcpController controller(running.server, kLoopback, 4096);
  boost::system::error_code error;
  std::uint64_t sent = 0;
  const auto taken = [&] {
    const auto counts = running.server.counts();
    return counts.answered + counts.send_failures;
  };
  while (running.server.counts().send_failures == 0 && !error) {
    controller.socket.send(boost::asio::buffer(telegram(++sent)), 0, error);
    while (!error && taken() < sent) std::this_thread::yield();
  }
  CHECK_FALSE(error);
  CHECK(running.server.counts().send_failures == 1);
  CHECK(running.server.counts().answered == sent - 1);
  TcpController again(running.server);
  CHECK(again.answered(4));
}

TEST_CASE("a server stops at once, with or without a connection", "[tcp_server]") {
  const bool connected = GENERATE(false, true);
  constexpr int kTimes = 200;
  int late = 0;
  for (int k = 0; k < kTimes; ++k) {
    auto running = std::make_unique<TcpRunning>(on_loopback());
    std::optional<TcpController> controller;
    if (connected) {
      controller.emplace(running->server);
      REQUIRE(controller->answered(4));
    }
    late += running->stops_late();
    running.reset();
    if (connected) CHECK(controller->closed_by_server());
  }
  CHECK(late < kTimes / 4);
}

TEST_CASE("a TCP port belongs to one server alone, and is free again after it", "[tcp_server]") {
  auto options = on_loopback();
  {
    TcpRunning first(on_loopback());
    options.listen = first.server.local();
    CHECK_THROWS_WITH(TcpServer(options),
                      Catch::Matchers::ContainsSubstring("TCP " + rsi::text(first.server.local()) +
                                                         " is in use by this program itself: ") &&
                          Catch::Matchers::ContainsSubstring("choose another port"));
    auto everywhere = options;
    everywhere.listen.address = 0;
    CHECK_THROWS_WITH(TcpServer(everywhere),
                      Catch::Matchers::ContainsSubstring("is in use by this program itself"));
    // The server ends this connection, so its side of it lingers.
    TcpController controller(first.server);
    CHECK(controller.answered(4));
  }
  TcpServer second(options);
  CHECK(second.local() == options.listen);
  options.listen = {0x08080808, 6008};
  CHECK_THROWS_WITH(TcpServer(options),
                    Catch::Matchers::ContainsSubstring("use an address of this machine"));
}

TEST_CASE("one port number serves UDP and TCP side by side", "[tcp_server]") {
  const TcpServer tcp_server(on_loopback());
  auto options = on_loopback();
  options.listen = tcp_server.local();
  CHECK_NOTHROW(rsi::UdpServer(std::move(options)));
}
