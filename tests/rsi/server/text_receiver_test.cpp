#include "rsi/server/text_receiver.hpp"

#include <string>
#include <thread>
#include <vector>

#include "rsi/asio.hpp"

#include "rsi/server/server.hpp"
#include "tests/catch.hpp"
#include "tests/eventually.hpp"

using namespace rsi;
using boost::asio::ip::tcp;

namespace {

constexpr Endpoint kAnyPort{0x7f000001, 0};

class Receiving {
 public:
  explicit Receiving(Transport transport)
      : receiver(transport, kAnyPort), thread_([this] { receiver.run(); }) {}
  ~Receiving() {
    receiver.stop();
    thread_.join();
  }

  /// All that came so far.
  const std::string& text() {
    Datagram datagram;
    while (receiver.datagrams().pop(datagram)) {
      text_ += datagram.payload;
      times.push_back(datagram.time);
      destination = datagram.destination;
    }
    return text_;
  }

  TextReceiver receiver;
  std::vector<Timestamp> times;
  Endpoint destination;

 private:
  std::string text_;
  std::thread thread_;
};

tcp::socket connected(boost::asio::io_context& context, const Receiving& receiving) {
  tcp::socket socket(context);
  socket.connect(to_asio<tcp>(receiving.receiver.local()));
  return socket;
}

}  // namespace

TEST_CASE("Datagrams of a device come with the kernel's time, in order", "[text_receiver]") {
  Receiving receiving(Transport::udp);
  boost::asio::io_context context;
  boost::asio::ip::udp::socket socket(context, boost::asio::ip::udp::v4());
  const auto to = to_asio<boost::asio::ip::udp>(receiving.receiver.local());
  const auto send = [&](const std::string& line) {
    socket.send_to(boost::asio::buffer(line), to);
    return now();
  };
  // Linux begins to stamp a little after the first socket asked for it: until then a datagram's
  // time is that of its reading.
  std::size_t sent = 0;
  REQUIRE(sweepd::test::eventually([&] {
    const auto after = send("0\n");
    ++sent;
    return sweepd::test::eventually([&] { return receiving.text().size() == 2 * sent; }) &&
           receiving.times.back() <= after;
  }));
  const auto before = now();
  for (const char* line : {"1,2,3\n", "4,5,6\n"}) send(line);
  const auto after = send("7,8,9\n");
  const std::string lines = "1,2,3\n4,5,6\n7,8,9\n";
  REQUIRE(
      sweepd::test::eventually([&] { return receiving.text().size() == 2 * sent + lines.size(); }));
  CHECK(receiving.text().substr(2 * sent) == lines);
  REQUIRE(receiving.times.size() == sent + 3);
  CHECK(receiving.times[sent] >= before - std::chrono::milliseconds(1));
  CHECK(receiving.times.back() <= after + std::chrono::milliseconds(1));
  CHECK(receiving.destination == receiving.receiver.local());
}

TEST_CASE("A flood is dropped and counted, and memory stays bounded", "[text_receiver]") {
  Receiving receiving(Transport::udp);
  boost::asio::io_context context;
  boost::asio::ip::udp::socket socket(context, boost::asio::ip::udp::v4());
  const auto to = to_asio<boost::asio::ip::udp>(receiving.receiver.local());
  const std::string garbage(1000, 'x');
  for (int i = 0; i < 20'000; ++i) socket.send_to(boost::asio::buffer(garbage), to);
  CHECK(sweepd::test::eventually([&] { return receiving.receiver.dropped() > 1000; }));
}

TEST_CASE("Over TCP whole lines are handed over, of each connection", "[text_receiver]") {
  Receiving receiving(Transport::tcp);
  boost::asio::io_context context;
  auto first = connected(context, receiving);
  first.send(boost::asio::buffer(std::string("1,2")));
  first.send(boost::asio::buffer(std::string(",3\n4,5,6\nrest")));
  REQUIRE(sweepd::test::eventually([&] { return receiving.text() == "1,2,3\n4,5,6\n"; }));
  auto second = connected(context, receiving);
  second.send(boost::asio::buffer(std::string("7,8,9\n")));
  REQUIRE(sweepd::test::eventually([&] { return receiving.text() == "1,2,3\n4,5,6\n7,8,9\n"; }));

  second.send(boost::asio::buffer(std::string(10'000, 'x')));
  CHECK(sweepd::test::eventually([&] { return receiving.receiver.too_long() == 1; }));
}

TEST_CASE("Over TCP a device is heard whatever else connects", "[text_receiver]") {
  Receiving receiving(Transport::tcp);
  boost::asio::io_context context;
  auto device = connected(context, receiving);
  std::string sent;
  std::vector<tcp::socket> others;
  for (std::size_t i = 0; i < 3 * TextReceiver::kMostConnections; ++i) {
    sent += std::to_string(i) + ",2,3\n";
    device.send(boost::asio::buffer(std::to_string(i) + ",2,3\n"));
    REQUIRE(sweepd::test::eventually([&] { return receiving.text() == sent; }));
    connected(context, receiving).close();            // looks whether the port is open
    others.push_back(connected(context, receiving));  // and one that says nothing
  }
  // Those that said nothing for longest had to go.
  std::string bytes(1, ' ');
  boost::system::error_code error;
  others.front().receive(boost::asio::buffer(bytes), 0, error);
  CHECK(error == boost::asio::error::eof);
  // A device that comes again has left the connection before behind.
  auto again = connected(context, receiving);
  again.send(boost::asio::buffer(std::string("7,8,9\n")));
  CHECK(sweepd::test::eventually([&] { return receiving.text() == sent + "7,8,9\n"; }));
}

TEST_CASE("A line that is too long is left out to its end, and counted as what it is",
          "[text_receiver]") {
  const std::string lines = "1,2,3\n" + std::string(20'000, '9') + ",5,6\n7,8,9\n";
  const auto all = [](Receiving& receiving) {
    return sweepd::test::eventually([&] { return receiving.text() == "1,2,3\n7,8,9\n"; }) &&
           receiving.receiver.too_long() == 1 && receiving.receiver.dropped() == 0;
  };
  boost::asio::io_context context;
  SECTION("over TCP, in one piece") {
    Receiving receiving(Transport::tcp);
    connected(context, receiving).send(boost::asio::buffer(lines));
    CHECK(all(receiving));
  }
  SECTION("over TCP, in pieces") {
    Receiving receiving(Transport::tcp);
    auto socket = connected(context, receiving);
    socket.send(boost::asio::buffer(lines.substr(0, 15'000)));
    REQUIRE(sweepd::test::eventually([&] { return receiving.receiver.too_long() == 1; }));
    socket.send(boost::asio::buffer(lines.substr(15'000)));
    CHECK(all(receiving));
  }
  SECTION("over UDP") {
    Receiving receiving(Transport::udp);
    boost::asio::ip::udp::socket socket(context, boost::asio::ip::udp::v4());
    socket.send_to(boost::asio::buffer(lines),
                   to_asio<boost::asio::ip::udp>(receiving.receiver.local()));
    CHECK(all(receiving));
  }
}

TEST_CASE("Over TCP every line of a new connection comes once, whatever the one before it sent",
          "[text_receiver]") {
  Receiving receiving(Transport::tcp);
  boost::asio::io_context context;
  auto before = connected(context, receiving);
  before.send(boost::asio::buffer(std::string(20'000, '\n')));
  std::this_thread::sleep_for(std::chrono::milliseconds(2));  // it is read, and its reader pauses
  auto after = connected(context, receiving);
  std::string lines;
  for (int line = 0; line < 200'000; ++line) lines += std::to_string(line) + ",101598.25\n";
  std::thread sender([&] {
    for (std::size_t gone = 0; gone < lines.size();)
      gone += after.send(boost::asio::buffer(lines.data() + gone, lines.size() - gone));
  });
  CHECK(sweepd::test::eventually([&] { return receiving.text().ends_with("199999,101598.25\n"); }));
  sender.join();
  const auto& text = receiving.text();
  if (receiving.receiver.dropped() > 0) return;  // the machine is busy: nothing can be said
  REQUIRE(text.size() >= lines.size());
  CHECK((text.substr(text.size() - lines.size()) == lines));
}

TEST_CASE("A port that is taken is told", "[text_receiver]") {
  const TextReceiver one(Transport::udp, kAnyPort);
  CHECK_THROWS_AS(TextReceiver(Transport::udp, one.local()), std::runtime_error);
}
