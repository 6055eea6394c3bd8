#include "rsi/udp_server.hpp"

#include <string>
#include <thread>

#include "tests/catch.hpp"

using namespace std::chrono_literals;
using boost::asio::ip::udp;
using rsi::Datagram;
using rsi::UdpServer;

namespace {

constexpr std::uint32_t kLoopback = 0x7f000001;

UdpServer::Options on_loopback() {
  UdpServer::Options options;
  options.listen = {kLoopback, 0};
  options.reply.emplace("ImFree");
  return options;
}

std::string telegram(std::uint64_t ipoc) {
  return std::string("<Rob Type=\"KUKA\"><DiL>0</DiL><IPOC>")
      .append(std::to_string(ipoc))
      .append("</IPOC></Rob>\n");
}

std::string ipoc_element(std::uint64_t ipoc) {
  return std::string("<IPOC>").append(std::to_string(ipoc)).append("</IPOC>");
}

/// A server on its thread, stopped at the end of the test.
struct Running {
  explicit Running(UdpServer::Options options) : server(std::move(options)) {
    thread = std::thread([this] { server.run(); });
  }
  ~Running() { stop(); }

  /// The counts are final then: a reply arrives before it is counted.
  void stop() {
    if (!thread.joinable()) return;
    server.stop();
    thread.join();
  }

  /// The next datagram that was handed over; fails the test after ten seconds without one.
  Datagram next() {
    Datagram datagram;
    for (int tries = 0; tries < 1000 && !server.datagrams().pop(datagram); ++tries)
      server.datagrams().wait(10ms);
    return datagram;
  }

  UdpServer server;
  std::thread thread;
};

/// A controller's socket that waits at most ten seconds for a reply.
struct Controller {
  explicit Controller(const UdpServer& server, std::uint32_t address = kLoopback)
      : socket(context, udp::endpoint(boost::asio::ip::address_v4(address), 0)),
        to(boost::asio::ip::address_v4(server.local().address), server.local().port) {
    const timeval ten_seconds{10, 0};
    setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &ten_seconds, sizeof ten_seconds);
  }
  void send(const std::string& text) { socket.send_to(boost::asio::buffer(text), to); }
  std::string receive() {
    std::string text(2000, '\0');
    // recv() by itself: Asio's own call would wait past the time-out.
    const auto size = ::recv(socket.native_handle(), text.data(), text.size(), 0);
    text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return text;
  }
  boost::asio::io_context context;
  udp::socket socket;
  udp::endpoint to;
};

}  // namespace

TEST_CASE("each telegram is answered with its IPOC, and both are handed over afterwards") {
  Running running(on_loopback());
  Controller controller(running.server);
  for (std::uint64_t ipoc = 1000; ipoc < 1040; ipoc += 4) {
    controller.send(telegram(ipoc));
    CHECK(controller.receive() == "<Sen Type=\"ImFree\">" + ipoc_element(ipoc) + "</Sen>");
    const Datagram received = running.next();
    CHECK(received.payload == telegram(ipoc));
    CHECK(received.source.port == controller.socket.local_endpoint().port());
    CHECK(received.destination == running.server.local());
    const auto received_at = received.time;
    const Datagram sent = running.next();
    CHECK(sent.payload.starts_with("<Sen"));
    CHECK(sent.source == running.server.local());
    CHECK(sent.time >= received_at);
  }
  running.stop();
  CHECK(running.server.counts().answered == 10);
}

TEST_CASE("a telegram that cannot be parsed is answered if its IPOC can be found") {
  Running running(on_loopback());
  Controller controller(running.server);
  controller.send("<Rob <<< GPIO 01=\"1 \xff<IPOC>77</IPOC>");
  CHECK(controller.receive() == "<Sen Type=\"ImFree\"><IPOC>77</IPOC></Sen>");
}

TEST_CASE("what has no IPOC is handed over unanswered, and what follows is answered") {
  Running running(on_loopback());
  Controller controller(running.server);
  controller.send(telegram(4));
  controller.receive();
  for (const std::string& junk : {std::string(), std::string("junk"), std::string(60'000, 'x'),
                                  std::string("\0\1\2", 3), std::string("<Rob><IPOC></IPOC>")})
    controller.send(junk);
  controller.send(telegram(8));
  CHECK(controller.receive().find(">8<") != std::string::npos);
  for (int skip = 0; skip < 2; ++skip) running.next();
  CHECK(running.next().payload.empty());
  CHECK(running.next().payload == "junk");
  CHECK(running.next().payload.size() == 60'000);
  running.stop();
  CHECK(running.server.counts().unanswerable == 5);
  CHECK(running.server.counts().answered == 2);
}

TEST_CASE("of several telegrams that wait all are handed over and the newest is answered") {
  UdpServer server(on_loopback());
  Controller controller(server);
  for (std::uint64_t ipoc = 4; ipoc <= 40; ipoc += 4) controller.send(telegram(ipoc));
  std::thread thread([&] { server.run(); });
  CHECK(controller.receive() == "<Sen Type=\"ImFree\"><IPOC>40</IPOC></Sen>");
  server.stop();
  thread.join();
  CHECK(server.counts().answered == 1);
  CHECK(server.counts().superseded == 9);
  Datagram datagram;
  int telegrams = 0;
  while (server.datagrams().pop(datagram)) telegrams += datagram.payload.starts_with("<Rob");
  CHECK(telegrams == 10);
}

TEST_CASE("only the configured controller is answered, others are counted") {
  auto options = on_loopback();
  options.controller = 0x7f000002;  // 127.0.0.2 is this machine too
  Running running(std::move(options));
  Controller stranger(running.server);
  Controller controller(running.server, 0x7f000002);
  stranger.send(telegram(4));
  controller.send(telegram(8));
  CHECK(controller.receive().find(">8<") != std::string::npos);
  CHECK(running.next().payload == telegram(8));
  running.stop();
  CHECK(running.server.counts().foreign == 1);
}

TEST_CASE(
    "without a configured controller the first that sends an IPOC is served until forgotten") {
  Running running(on_loopback());
  Controller stranger(running.server);
  Controller first(running.server, 0x7f000002);
  stranger.send("no telegram");
  first.send(telegram(4));
  CHECK(first.receive().find(">4<") != std::string::npos);
  stranger.send(telegram(5));
  first.send(telegram(8));
  CHECK(first.receive().find(">8<") != std::string::npos);
  CHECK(running.server.counts().foreign == 2);
  running.server.forget_controller();
  stranger.send(telegram(12));
  CHECK(stranger.receive().find(">12<") != std::string::npos);
}

TEST_CASE("a controller that only sends gets no reply") {
  auto options = on_loopback();
  options.reply.reset();
  Running running(std::move(options));
  Controller controller(running.server);
  controller.send(telegram(4));
  CHECK(running.next().payload == telegram(4));
  controller.send(telegram(8));
  CHECK(running.next().payload == telegram(8));
  running.stop();
  CHECK(running.server.counts().answered == 0);
  CHECK(controller.socket.available() == 0);
}

TEST_CASE("a full queue does not keep a telegram from being answered") {
  auto options = on_loopback();
  options.queue_bytes = 400;
  Running running(std::move(options));
  Controller controller(running.server);
  for (std::uint64_t ipoc = 4; ipoc <= 80; ipoc += 4) {
    controller.send(telegram(ipoc));
    CHECK(controller.receive().find(ipoc_element(ipoc)) != std::string::npos);
  }
  running.stop();
  CHECK(running.server.counts().answered == 20);
  CHECK(running.server.counts().overflows > 0);
}

TEST_CASE("a port belongs to one server alone, and the message says what to do") {
  UdpServer first(on_loopback());
  auto options = on_loopback();
  options.listen = first.local();
  CHECK_THROWS_WITH(UdpServer(std::move(options)),
                    Catch::Matchers::ContainsSubstring("in use by another program") &&
                        Catch::Matchers::ContainsSubstring("choose another port"));
  auto elsewhere = on_loopback();
  elsewhere.listen = {0x08080808, 49152};
  CHECK_THROWS_WITH(UdpServer(std::move(elsewhere)),
                    Catch::Matchers::ContainsSubstring("use an address of this machine"));
}

TEST_CASE("this machine's address towards a peer is known") {
  CHECK(rsi::local_address_towards({0x7f000001, 4000}) == kLoopback);
}
