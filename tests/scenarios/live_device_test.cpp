#include <chrono>
#include <cmath>
#include <csignal>
#include <thread>

#include <nlohmann/json.hpp>

#include "rsi/asio.hpp"

#include "tests/catch.hpp"
#include "tests/daemon/device_play.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;
using Json = nlohmann::json;

namespace {

/// Sends lines as a device does, until it has sent them all.
class SendingDevice {
 public:
  SendingDevice(std::uint16_t port, std::vector<DeviceLine> lines)
      : thread_([port, lines = std::move(lines)] {
          boost::asio::io_context context;
          using boost::asio::ip::udp;
          udp::socket socket(context, udp::v4());
          const udp::endpoint to(boost::asio::ip::address_v4::loopback(), port);
          const auto begin = std::chrono::steady_clock::now();
          for (const auto& line : lines) {
            std::this_thread::sleep_until(begin + std::chrono::duration<double>(line.at_s));
            boost::system::error_code ignored;
            socket.send_to(boost::asio::buffer(line.text), to, 0, ignored);
          }
        }) {}
  ~SendingDevice() { thread_.join(); }

 private:
  std::thread thread_;
};

/// There and back at 40 degrees a second, with rests of half a second.
std::filesystem::path write_device_plan(const TemporaryFolder& folder) {
  std::string plan =
      "home_deg = [90, -90, 90, 0, 90, 0]\npositioning_speed_deg_s = 80\n"
      "acceleration_deg_s2 = 600\ndwell_ms = 400\n";
  const double centres[] = {90, -90, 90, 0, 90, 0};
  const double ranges[] = {20, 15, -20, 24, -18, 26};
  for (std::size_t j = 0; j < 6; ++j)
    plan += "[[sweep]]\njoint = " + std::to_string(j + 1) +
            "\nstart_deg = " + std::to_string(centres[j] - ranges[j]) +
            "\nend_deg = " + std::to_string(centres[j] + ranges[j]) + "\nspeed_deg_s = 40\n";
  return folder.write("device_plan.toml", plan);
}

}  // namespace

TEST_CASE("a live campaign with a device leaves what the replay of its recording leaves",
          "[live_device]") {
  for (const bool times : {true, false}) {
    const TemporaryFolder folder;
    const auto port = free_port();
    Daemon::Options options;
    options.settings = "[[robot.device]]\nlisten = \"udp://127.0.0.1:" + std::to_string(port) +
                       "\"\ncolumns = \"" + (times ? "t_s," : "") + "x_mm,y_mm,z_mm\"\n";
    Daemon daemon(folder.path(), options);
    const auto plan = write_device_plan(folder);
    DevicePlay play;
    play.ahead_s = 1234.5;
    play.rate = 5e-5;
    play.jitter_s = times ? 0.005 : 0;
    play.loss = 0.02;
    play.times = times;
    auto lines = device_play(kConfig / "robots/kr5_arc.toml", plan, play);
    std::erase_if(lines, [](const auto& line) { return line.at_s > 11 && line.at_s < 11.6; });
    lines[300].text = "garbage, that is no line\n";
    {
      const SendingDevice device(port, std::move(lines));
      const auto simulated =
          run_sweepd({"simulate", "--robot", (kConfig / "robots/kr5_arc.toml").string(), "--plan",
                      plan.string(), "--to", daemon.address()});
      INFO(simulated.out << simulated.errors);
      CHECK_THAT(simulated.out, ContainsSubstring("played to its end"));
    }
    daemon.process().signal(SIGTERM);
    REQUIRE(daemon.process().wait() == 0);
    INFO(daemon.process().errors());
    CHECK_THAT(daemon.process().errors(), ContainsSubstring("and 1 line that the columns"));
    const auto session = daemon.session();
    const auto result = Json::parse(content(session / "result.json"));
    CHECK(result["status"] == Json("complete"));
    CHECK(result["describes"] == Json("arm"));
    INFO(result["clocks"].dump());
    // How late device and controller began, and how late their threads were woken, nobody knows.
    const double ahead_s = result["clocks"]["ahead_s"];
    CHECK(std::abs(ahead_s - (times ? 1234.5 : 0)) < 1);
    CHECK(result["clocks"]["sigma_ms"].get<double>() < 1);

    const auto replayed =
        run_sweepd({"replay", (session / "trace.pcap").string(), "--config",
                    daemon.config().string(), "--output", (folder / "replayed").string()});
    CHECK(replayed.code == 0);
    CHECK(replayed.errors.empty());
    for (const char* name : {"result.json", "dh.csv", "sweeps.csv", "report.txt", "samples.csv"}) {
      INFO(name);
      CHECK(content(session / name) == content(folder / "replayed" / name));
    }
    // Who knows nothing of devices reads the trace as before.
    const auto inspected = run_sweepd({"inspect", (session / "trace.pcap").string()});
    CHECK(inspected.errors.empty());
    const auto plain = run_sweepd({"replay", (session / "trace.pcap").string(), "--robot",
                                   (kConfig / "robots/kr5_arc.toml").string()});
    CHECK(plain.code == 0);
    CHECK(plain.errors.empty());
    CHECK_THAT(plain.out, ContainsSubstring("the controller's model"));
  }
}
