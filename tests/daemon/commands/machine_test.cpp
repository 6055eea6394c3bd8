#include "daemon/commands/machine.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

#include "rsi/asio.hpp"

#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd;

namespace {

constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;

RobotSettings robot() {
  RobotSettings robot;
  robot.name = "arc";
  robot.listen = {0, 49152};
  robot.output = "/var/lib/sweepd";
  return robot;
}

rsi::EthernetConfig ethernet() {
  rsi::EthernetConfig config;
  config.name = "ethernet.xml";
  config.ip_number = "192.168.1.10";
  return config;
}

/// A machine that can do all that the robot above asks for.
Machine sound() {
  Machine machine;
  machine.receive_buffer = 4 << 20;
  machine.addresses = {0x7f000001, 0xc0a8010a};
  machine.real_time.granted = {"memory locked", "SCHED_FIFO 80"};
  machine.room = DiskRoom{900 * kGiB, 1000 * kGiB};
  return machine;
}

struct Judged {
  std::string text;
  bool not_ready = false;
};

Judged judged(const Machine& machine, const RobotSettings& settings = robot()) {
  std::ostringstream out;
  Findings findings(out);
  const auto config = ethernet();
  judge_machine(machine, settings, &config, findings);
  CHECK_FALSE(findings.wrong_file());
  return {out.str(), findings.not_ready()};
}

}  // namespace

TEST_CASE("a machine that can serve the robot gives no cause to complain", "[machine]") {
  const auto found = judged(sound());
  INFO(found.text);
  CHECK_FALSE(found.not_ready);
  CHECK_THAT(found.text, !ContainsSubstring("warning") && !ContainsSubstring("error"));
  CHECK_THAT(found.text, ContainsSubstring("966.4 GB free, enough for 56 days"));
}

TEST_CASE("a port that another program has is an error, one that sweepd has is not", "[machine]") {
  Machine machine = sound();
  machine.cannot_listen = "UDP 0.0.0.0:49152 is in use by RSIMonitor (process 7): stop it";
  machine.port_taken_by = "RSIMonitor (process 7)";
  CHECK(judged(machine).not_ready);
  CHECK_THAT(judged(machine).text, ContainsSubstring("error    " + machine.cannot_listen));
  machine.port_taken_by = "sweepd (process 8)";
  CHECK_FALSE(judged(machine).not_ready);
  CHECK_THAT(judged(machine).text, ContainsSubstring("sweepd (process 8) listens there"));
}

TEST_CASE("the address that the controller sends to has to be this machine's", "[machine]") {
  Machine machine = sound();
  machine.addresses = {0x7f000001, 0x0a000005};
  CHECK_FALSE(judged(machine).not_ready);
  CHECK_THAT(judged(machine).text,
             ContainsSubstring("warning  ethernet.xml: IP_NUMBER") &&
                 ContainsSubstring("192.168.1.10, it has 127.0.0.1, 10.0.0.5"));
}

TEST_CASE("the controller has to be reached the way it comes", "[machine]") {
  RobotSettings settings = robot();
  settings.controller = 0xc0a80114;
  Machine machine = sound();
  CHECK_THAT(judged(machine, settings).text, ContainsSubstring("there is no way to it"));
  machine.towards_controller = 0x0a000005;
  CHECK_THAT(judged(machine, settings).text,
             ContainsSubstring("sends to 192.168.1.10, but is reached from 10.0.0.5"));
  machine.towards_controller = 0xc0a8010a;
  CHECK_THAT(judged(machine, settings).text,
             ContainsSubstring("ok       controller 192.168.1.20: reached from 192.168.1.10"));
}

TEST_CASE("real time that is required and not to be had is an error, one that is tried a warning",
          "[machine]") {
  Machine machine = sound();
  machine.real_time = {{}, {"SCHED_FIFO 80 is not permitted: set LimitRTPRIO=80"}};
  CHECK_FALSE(judged(machine).not_ready);
  CHECK_THAT(judged(machine).text, ContainsSubstring("warning  realtime: SCHED_FIFO 80 is not"));
  RobotSettings settings = robot();
  settings.real_time.wish = RealTime::require;
  CHECK(judged(machine, settings).not_ready);
  settings.real_time.wish = RealTime::off;
  CHECK_THAT(judged(machine, settings).text, !ContainsSubstring("SCHED_FIFO"));
}

TEST_CASE("a disk that is nearly full is told before recording pauses", "[machine]") {
  Machine machine = sound();
  machine.room = DiskRoom{kGiB / 2, 1000 * kGiB};
  CHECK(judged(machine).not_ready);
  CHECK_THAT(judged(machine).text, ContainsSubstring("keep_free_bytes"));
  // Between them 8 GiB, at 17.3 GB a day.
  machine.room = DiskRoom{9 * kGiB, 1000 * kGiB};
  CHECK_THAT(judged(machine).text,
             ContainsSubstring("warning") && ContainsSubstring("9.7 GB free, enough for 12 hours"));
  RobotSettings settings = robot();
  settings.recording.keep_bytes = kGiB;
  CHECK_THAT(judged(machine, settings).text, !ContainsSubstring("warning"));
  settings.recording.rotate_bytes = 2 * kGiB;
  CHECK_THAT(judged(machine, settings).text,
             ContainsSubstring("warning") && ContainsSubstring("a trace grows to 2.1 GB"));
  machine.cannot_write = "/var/lib/sweepd/arc: cannot be written (Permission denied)";
  CHECK(judged(machine).not_ready);
}

TEST_CASE("looking at the machine finds who has the port, and its own addresses", "[machine]") {
  namespace asio = boost::asio;
  asio::io_context context;
  const sweepd::test::TemporaryFolder folder;
  RobotSettings settings = robot();
  settings.output = folder.path() / "not" / "made" / "yet";
  const asio::ip::udp::socket other(context, {asio::ip::address_v4::loopback(), 0});
  settings.listen = {0x7f000001, other.local_endpoint().port()};
  settings.controller = 0x7f000001;
  const Machine machine = look_at_machine(settings, rsi::Transport::udp);
  CHECK_THAT(machine.cannot_listen, ContainsSubstring("in use"));
  CHECK_THAT(machine.port_taken_by, ContainsSubstring("daemon_tests"));
  CHECK(std::count(machine.addresses.begin(), machine.addresses.end(), 0x7f000001) == 1);
  CHECK(machine.towards_controller == 0x7f000001);
  CHECK(machine.cannot_write.empty());
  CHECK(machine.room.has_value());
  CHECK(machine.real_time.granted.size() + machine.real_time.refused.size() == 2);
  CHECK_FALSE(std::filesystem::exists(settings.output));

  // A file where the folder ought to be is no question of rights.
  settings.output = folder.path() / "file";
  std::ofstream(settings.output) << "x";
  CHECK_THAT(look_at_machine(settings, rsi::Transport::tcp).cannot_write,
             ContainsSubstring("file: is no folder: move it away"));

  // The same port over TCP is free.
  const Machine tcp = look_at_machine(settings, rsi::Transport::tcp);
  CHECK(tcp.cannot_listen.empty());
  CHECK(tcp.receive_buffer > 0);
}
