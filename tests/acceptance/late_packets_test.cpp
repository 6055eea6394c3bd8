// The recording with late packets, played again as its controller did: a telegram every 4 ms where
// SWEEPD_CYCLE_US says 4000, every 0.5 ms otherwise.

#include <array>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include "rsi/asio.hpp"

#include "daemon/commands/inspect_command.hpp"
#include "daemon/service/robot_service.hpp"
#include "rsi/link/latency_histogram.hpp"
#include "rsi/telegram/ethernet_config.hpp"
#include "rsi/telegram/ipoc.hpp"
#include "rsi/telegram/reply.hpp"
#include "tests/acceptance/acceptance.hpp"
#include "tests/catch.hpp"

using namespace acceptance;
using boost::asio::ip::udp;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;

namespace {

std::chrono::microseconds cycle() {
  const char* const text = std::getenv("SWEEPD_CYCLE_US");
  return std::chrono::microseconds(text == nullptr ? 500 : std::stoll(text));
}

/// Sends the telegrams one by one and checks that each gets its own reply. The next one leaves when
/// its time has come and the last one was answered; a real controller would not wait for that.
rsi::LatencyHistogram play(const std::vector<std::string>& telegrams, const rsi::Endpoint& server,
                           rsi::Reply expected) {
  boost::asio::io_context context;
  udp::socket socket(context, udp::v4());
  socket.connect({boost::asio::ip::address_v4(server.address), server.port});
  const timeval longest{10, 0};
  setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof longest);
  rsi::LatencyHistogram latency;
  std::array<char, 2048> buffer{};
  // Its file has corrections: answered only from a beginning, which is behind a second of silence.
  auto due = Clock::now() + std::chrono::milliseconds(1100);
  for (const auto& telegram : telegrams) {
    std::this_thread::sleep_until(due);
    due += cycle();
    const auto sent = Clock::now();
    socket.send(boost::asio::buffer(telegram));
    const auto size = recv(socket.native_handle(), buffer.data(), buffer.size(), 0);
    if (size < 0) throw std::runtime_error("no reply to " + telegram);
    latency.add(Clock::now() - sent);
    const std::string_view reply(buffer.data(), static_cast<std::size_t>(size));
    if (reply != expected.with_ipoc(rsi::find_ipoc(telegram)))
      FAIL("to " << telegram << " the reply " << reply);
  }
  CHECK(socket.available() == 0);
  return latency;
}

}  // namespace

TEST_CASE("A recorded controller with late packets is answered, and the report shows their runs",
          "[late_packets]") {
  const auto recordings = real_data("recordings");
  const auto ethernet_files = real_data("ethernet-configs");
  if (!recordings || !ethernet_files) return;
  auto telegrams = lines_of(*recordings / "a1-late-packets.txt");
  for (auto& telegram : telegrams) telegram += '\n';
  REQUIRE(telegrams.size() == 6523);

  spdlog::set_level(spdlog::level::off);
  const TemporaryFolder folder;
  sweepd::RobotSettings settings;
  settings.name = "kr5-arc";
  settings.description = shipped("robots/kr5_arc.toml");
  settings.listen = {*rsi::parse_address("127.0.0.1"), 0};
  settings.ethernet_config = *ethernet_files / "krc4-of-the-recordings.xml";
  const auto ethernet = rsi::EthernetConfig::load(*settings.ethernet_config);
  for (const auto& command : ethernet.commands())
    settings.answers_with_zeros.names.push_back(command.tag);
  settings.output = folder / "out";
  sweepd::RobotService service(settings);
  service.start();
  const auto latency = play(telegrams, service.local(), rsi::Reply(ethernet));
  service.stop();

  const auto us = [&](double q) {
    return right(std::chrono::duration<double, std::micro>(latency.quantile(q)).count(), 1, 8);
  };
  std::cout << "a1-late-packets.txt at " << cycle().count() << " us: " << latency.count()
            << " telegrams answered; latency in us p50" << us(0.5) << ", p99" << us(0.99)
            << ", p99.9" << us(0.999) << ", max" << us(1) << "\n\n";
  CHECK(latency.count() == telegrams.size());

  std::filesystem::path session;
  for (const auto& entry : std::filesystem::directory_iterator(settings.output / "kr5-arc"))
    session = entry.path();
  const auto link = Json::parse(text_of(session / "run.json"))["since_start_of_sweepd"];
  CHECK(link["answered"] == telegrams.size());
  for (const char* none : {"superseded", "unanswerable", "foreign", "send_failures", "overflows"}) {
    INFO(none);
    CHECK(link[none] == 0);
  }
  const auto source = Json::parse(text_of(session / "result.json"))["source"];
  CHECK(source["telegrams"] == telegrams.size());
  CHECK(source["lost"] == 0);
  CHECK(source["late_replies"] == 11);
  CHECK(source["late_runs"] == 9);

  sweepd::InspectOptions options;
  options.traces = {session / "trace.pcap"};
  options.json = folder / "link.json";
  std::ostringstream report;
  std::ostringstream errors;
  static_cast<void>(sweepd::inspect(options, report, errors));  // late replies are no good verdict
  std::cout << report.str() << '\n';
  CHECK(errors.str().empty());
  const auto inspected = Json::parse(text_of(folder / "link.json"));
  CHECK(inspected["telegrams"]["received"] == telegrams.size());
  CHECK(inspected["telegrams"]["late_runs"] == 9);
  CHECK(inspected["telegrams"]["worst_late_runs"].size() == 9);
  CHECK(inspected["replies"]["sent"] == telegrams.size());
  CHECK(inspected["replies"]["unanswered"] == 0);
}
