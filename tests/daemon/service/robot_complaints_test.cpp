#include <string>

#include <spdlog/spdlog.h>

#include "rsi/asio.hpp"

#include "daemon/service/robot_service.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/said_lines.hpp"
#include "tests/daemon/telegrams.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/eventually.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::RobotService;
using namespace sweepd::test;
using namespace std::chrono_literals;

namespace {

sweepd::RobotSettings settings(const TemporaryFolder& folder) {
  spdlog::set_level(spdlog::level::info);
  sweepd::RobotSettings robot;
  robot.name = "kr5-arc";
  robot.description = kConfig / "robots/kr5_arc.toml";
  robot.listen = {*rsi::parse_address("127.0.0.1"), 0};
  robot.output = folder / "out";
  robot.silence = 500ms;
  return robot;
}

/// A controller that sends what it is told to, and reads nothing.
class Sender {
 public:
  explicit Sender(const rsi::Endpoint& server) {
    socket_.connect(rsi::to_asio<boost::asio::ip::udp>(server));
  }
  void send(const std::string& text) { socket_.send(boost::asio::buffer(text)); }
  void cycles(std::uint64_t first_ipoc, int count) {
    for (int k = 0; k < count; ++k) send(telegram(first_ipoc += 4, joint_1_at(0)));
  }

 private:
  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_{context_};
};

}  // namespace

TEST_CASE("what was not answered of one stream is not said of the next", "[robot_service][live]") {
  const TemporaryFolder folder;
  auto robot = settings(folder);
  auto xml = content(kEthernet);
  xml.insert(xml.rfind("</ELEMENTS>"),
             R"(<ELEMENT TAG="RKorr.X" TYPE="DOUBLE" INDX="1" HOLDON="1" />)");
  robot.ethernet_config = folder.write("ethernet.xml", xml);
  robot.answers_with_zeros = {{"RKorr.X"}};
  const SaidLines said;
  RobotService service(robot);
  service.start();
  Sender controller(service.local());
  const auto state = [&] { return service.status()->state.newest(); };
  controller.cycles(1000, 1);
  REQUIRE(eventually([&] { return state()->stream && state()->server.not_begun == 1; }));
  controller.cycles(1004, 20);
  REQUIRE(eventually([&] { return !state()->stream && state()->server.not_begun == 21; }));
  const auto behind_a_second = std::chrono::steady_clock::now() + 1200ms;
  REQUIRE(eventually([&] { return std::chrono::steady_clock::now() > behind_a_second; }));
  controller.cycles(1, 5);
  REQUIRE(eventually([&] { return state()->sessions == 2 && !state()->stream; }));
  CHECK(state()->server.answered > 0);
  CHECK(state()->server.not_begun == 21);
  service.stop();
  spdlog::set_level(spdlog::level::off);
  const auto text = said.text();
  const auto next = text.rfind("RSI from ");
  CHECK_THAT(text.substr(0, next), ContainsSubstring("1 telegram was not answered") &&
                                       ContainsSubstring("20 telegrams were not answered"));
  CHECK_THAT(text.substr(next), !ContainsSubstring("not answered"));
}

TEST_CASE("a controller that sends no IPOC is told of, as nothing else shows it",
          "[robot_service][live]") {
  const TemporaryFolder folder;
  auto robot = settings(folder);
  robot.controller = rsi::parse_address("127.0.0.1");
  const SaidLines said;
  RobotService service(robot);
  service.start();
  Sender controller(service.local());
  controller.send("<Rob Type=\"KUKA\">" + joint_1_at(0) + "</Rob>");
  REQUIRE(eventually([&] { return service.status()->state.newest()->server.unanswerable == 1; }));
  service.stop();
  spdlog::set_level(spdlog::level::off);
  CHECK_THAT(said.text(), ContainsSubstring(
                              "127.0.0.1 sends packets without an IPOC, which cannot be answered"));
}
