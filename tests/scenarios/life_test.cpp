#include <algorithm>
#include <atomic>
#include <csignal>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <unistd.h>

#include "rsi/capture/capture_reader.hpp"
#include "rsi/controller/controller_link.hpp"
#include "rsi/telegram/ipoc.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/scenarios/streamer.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using Json = nlohmann::json;
namespace fs = std::filesystem;

namespace {

/// A robot at rest, on a thread of its own, until it is stopped.
class Controller {
 public:
  explicit Controller(std::uint16_t port, std::uint64_t first_ipoc = 100'000, double lose = 0)
      : link_(rsi::EthernetConfig::load(kEthernet), options(port, first_ipoc, lose)),
        thread_([this] {
          report_ = link_.run([this](std::uint64_t cycle, rsi::SignalValues& values) {
            cycles_ = cycle;
            values.RIst = {500, 0, 900, 0, 90, 0};
            values.AIPos = {0, -90, 90, 0, 90, 0};
            return true;
          });
        }) {}
  ~Controller() { stop(); }

  /// Until so many more cycles began: a telegram each, but for those that the machine overslept.
  [[nodiscard]] bool streams(std::uint64_t more) const {
    const auto until = cycles_ + more;
    return eventually([&] { return cycles_ >= until; });
  }
  const rsi::ControllerLink::Report& stop() {
    link_.stop();
    if (thread_.joinable()) thread_.join();
    return report_;
  }

 private:
  static rsi::ControllerLink::Options options(std::uint16_t port, std::uint64_t first_ipoc,
                                              double lose) {
    rsi::ControllerLink::Options options;
    options.controller.server = {0x7f000001, port};
    options.controller.first_ipoc = first_ipoc;
    options.controller.timeout = 1'000'000;
    options.controller.rule = rsi::ReplyRule::sweepd;
    options.local = {0x7f000001, 0};
    options.faults.lose = lose;
    return options;
  }

  rsi::ControllerLink link_;
  rsi::ControllerLink::Report report_;
  std::atomic<std::uint64_t> cycles_{0};
  std::thread thread_;
};

struct Traced {
  std::uint64_t first_ipoc = 0;
  std::uint64_t telegrams = 0;
  std::uint64_t replies = 0;
  std::uint64_t replies_to_first = 0;
};

Traced traced(const fs::path& session, std::uint16_t port) {
  Traced traced;
  rsi::CaptureReader trace(session / "trace.pcap");
  while (const auto datagram = trace.next()) {
    const auto ipoc = rsi::ipoc_number(rsi::find_ipoc(datagram->payload));
    if (traced.first_ipoc == 0) traced.first_ipoc = ipoc.value_or(0);
    const bool telegram = datagram->destination.port == port;
    ++(telegram ? traced.telegrams : traced.replies);
    if (!telegram && ipoc == traced.first_ipoc) ++traced.replies_to_first;
  }
  return traced;
}

Json run_file(const fs::path& session) {
  return Json::parse(content(session / "run.json"));
}

/// The sessions, oldest first.
std::vector<fs::path> sessions(const fs::path& robot) {
  std::vector<fs::path> folders;
  if (fs::exists(robot))
    for (const auto& entry : fs::directory_iterator(robot)) folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  return folders;
}

bool said(Daemon& daemon, const std::string& words, int times = 1) {
  return eventually([&] {
    const std::string all = daemon.process().errors();
    std::size_t at = 0;
    for (int k = 0; k < times && at != std::string::npos; ++k)
      at = all.find(words, k == 0 ? 0 : at + words.size());
    return at != std::string::npos;
  });
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

/// A pipe that sweepd writes its log into, whose reader this is.
class LogPipe {
 public:
  explicit LogPipe(const fs::path& folder) : path_(folder / "log") {
    REQUIRE(::mkfifo(path_.c_str(), 0600) == 0);
    reader_ = ::open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    REQUIRE(reader_ >= 0);
  }
  ~LogPipe() { leave(); }
  LogPipe(const LogPipe&) = delete;
  LogPipe& operator=(const LogPipe&) = delete;

  [[nodiscard]] SweepdProcess::Launch launch() const {
    return {{"sh", "-c", "exec \"$@\" 2>\"$0\"", path_.string()}, {}};
  }
  /// Not another byte fits.
  void fill() const {
    const std::string block(4096, '\n');
    while (::write(reader_, block.data(), block.size()) > 0) {
    }
    while (::write(reader_, block.data(), 1) > 0) {
    }
  }
  /// What was written by now, since the last time.
  [[nodiscard]] std::string read() const {
    std::string text;
    char part[4096];
    for (ssize_t size = 0; (size = ::read(reader_, part, sizeof part)) > 0;)
      text.append(part, static_cast<std::size_t>(size));
    return text;
  }
  void leave() {
    if (reader_ >= 0) ::close(reader_);
    reader_ = -1;
  }

 private:
  fs::path path_;
  int reader_ = -1;
};

/// The settings of a daemon that has ended.
fs::path settings_of_one(const TemporaryFolder& folder, std::uint16_t& port) {
  Daemon daemon(folder.path(), {.settings = "silence_ms = 300\n"});
  port = daemon.port();
  daemon.process().signal(SIGTERM);
  REQUIRE(daemon.process().wait() == 0);
  return daemon.config();
}

/// That a stream is answered, recorded and identified, and that the end is in order.
void check_serves(SweepdProcess& sweepd, const fs::path& robot, std::uint16_t port) {
  Streamer streamer(port, {});
  const auto answered = [&] {
    const auto sent = streamer.sent();
    return std::count_if(sent.begin(), sent.end(),
                         [](const auto& each) { return each.answered_after.has_value(); });
  };
  REQUIRE(eventually([&] { return answered() > 100; }));
  streamer.stop();
  REQUIRE(eventually([&] {
    return !sessions(robot).empty() && fs::exists(sessions(robot).back() / "run.json") &&
           run_file(sessions(robot).back()).contains("ended");
  }));
  CHECK(run_file(sessions(robot).back())["recording"]["not_recorded"]["memory_full"]["samples"] ==
        0);
  sweepd.signal(SIGTERM);
  CHECK(sweepd.wait() == 0);
}

}  // namespace

TEST_CASE("a sweepd that is started while RSI streams answers the first telegram that it gets",
          "[life]") {
  const TemporaryFolder folder;
  Daemon daemon(folder.path());
  Controller controller(daemon.port());
  REQUIRE(controller.streams(50));
  daemon.restart();
  REQUIRE(controller.streams(100));
  daemon.process().signal(SIGTERM);
  CHECK(daemon.process().wait() == 0);
  const auto overslept = controller.stop().skipped;

  const auto folders = sessions(folder / "output/kr5-arc");
  REQUIRE(folders.size() == 2);
  for (const auto& session : folders) {
    const auto counts = traced(session, daemon.port());
    CHECK(counts.telegrams + overslept >= 50);
    CHECK(counts.replies_to_first +
              run_file(session)["since_start_of_sweepd"]["superseded"].get<std::uint64_t>() >=
          1);
    CHECK(counts.replies +
              run_file(session)["since_start_of_sweepd"]["superseded"].get<std::uint64_t>() ==
          counts.telegrams);
  }
}

TEST_CASE("a controller that starts RSI again goes on in the same session, from its new port",
          "[life]") {
  const TemporaryFolder folder;
  Daemon daemon(folder.path());
  Controller first(daemon.port(), 5'000'000);
  REQUIRE(first.streams(50));
  const auto before = first.stop();
  Controller second(daemon.port(), 1000);
  REQUIRE(second.streams(50));
  const auto after = second.stop();
  daemon.process().signal(SIGTERM);
  CHECK(daemon.process().wait() == 0);
  const auto folders = sessions(folder / "output/kr5-arc");
  REQUIRE(folders.size() == 1);
  const auto source = Json::parse(content(folders[0] / "result.json"))["source"];
  CHECK(source["restarts"] == 1);
  CHECK(source["lost"].get<std::uint64_t>() <= before.skipped + after.skipped);
  const auto telegrams = before.controller.telegrams + after.controller.telegrams;
  CHECK(source["telegrams"] == telegrams);
  const auto superseded =
      run_file(folders[0])["since_start_of_sweepd"]["superseded"].get<std::uint64_t>();
  CHECK(before.controller.replies + after.controller.replies + superseded == telegrams);
}

TEST_CASE("SIGHUP takes over what it can, says what it cannot, and survives a mistake", "[life]") {
  const TemporaryFolder folder;
  Daemon daemon(folder.path());
  Controller controller(daemon.port());
  REQUIRE(said(daemon, "RSI from"));
  const auto sound = content(daemon.config());

  // A second robot comes, the first one changes.
  const auto other_port = free_port();
  auto changed = sound + "silence_ms = 300\nqueue_bytes = 1048576\n";
  const auto other = "[[robot]]\nname = \"other\"\ndescription = \"" +
                     (kConfig / "robots/kr5_arc.toml").string() +
                     "\"\nlisten = \"127.0.0.1:" + std::to_string(other_port) +
                     "\"\noutput = \"output\"\nsilence_ms = 60000\n";
  write(daemon.config(), changed + other);
  daemon.process().signal(SIGHUP);
  CHECK(said(daemon, "kr5-arc: taken over for the next session: silence_ms"));
  CHECK(said(daemon, "kr5-arc: only a restart of sweepd takes over queue_bytes"));
  CHECK(said(daemon, "other: listening on UDP 127.0.0.1:" + std::to_string(other_port)));
  {
    Controller second(other_port);
    CHECK(second.streams(20));
    CHECK(second.stop().controller.replies > 0);
  }

  // A mistake in the file, or in one that it names, changes nothing.
  write(daemon.config(), changed + "silence = 1\nrecrod = true\n");
  daemon.process().signal(SIGHUP);
  CHECK(said(daemon, "robot.silence"));
  CHECK(said(daemon, "robot.recrod"));
  CHECK(said(daemon, "nothing of " + daemon.config().string() +
                         " is taken over; sweepd goes on with the settings that it had"));
  daemon.process().signal(SIGHUP);
  CHECK(said(daemon, "robot.recrod", 2));  // each time
  write(daemon.config(), changed + "plan = \"missing.toml\"\n" + other);
  daemon.process().signal(SIGHUP);
  CHECK(said(daemon, "missing.toml"));
  const auto ethernet = content(folder / "ethernet.xml");
  write(folder / "ethernet.xml", "<ROOT");
  write(daemon.config(), changed + other);
  daemon.process().signal(SIGHUP);
  CHECK(said(daemon, "ethernet.xml"));
  CHECK(said(daemon, "kr5-arc: the robot goes on with the settings", 2));
  write(folder / "ethernet.xml", ethernet);
  {
    Controller second(other_port);
    CHECK(second.streams(20));
    CHECK(second.stop().controller.replies > 0);
  }

  // The Ethernet file is the reply thread's; the second robot goes.
  write(folder / "ethernet.xml", content(folder / "ethernet.xml") + "<!-- edited -->\n");
  write(daemon.config(), changed);
  daemon.process().signal(SIGHUP);
  CHECK(said(daemon, "kr5-arc: the Ethernet file has changed: restart sweepd"));
  CHECK(said(daemon, "other: no longer in the settings"));

  // The first robot was answered all the time, and its next session has the new silence.
  REQUIRE(controller.streams(10));
  const auto report = controller.stop();
  CHECK(report.controller.longest_unanswered < 50);
  CHECK(said(daemon, "silent for 2000 ms"));
  Controller again(daemon.port());
  REQUIRE(again.streams(10));
  again.stop();
  CHECK(said(daemon, "silent for 300 ms"));
  daemon.process().signal(SIGTERM);
  CHECK(daemon.process().wait() == 0);
}

TEST_CASE("SIGHUP refuses settings that became a pipe, at once", "[life]") {
  const TemporaryFolder folder;
  Daemon daemon(folder.path());
  const auto sound = content(daemon.config());
  REQUIRE(fs::remove(daemon.config()));
  REQUIRE(mkfifo(daemon.config().c_str(), 0600) == 0);
  daemon.process().signal(SIGHUP);
  CHECK(said(daemon, daemon.config().string() + ": expected a file, found a pipe"));
  REQUIRE(fs::remove(daemon.config()));
  write(daemon.config(), sound + "silence_ms = 300\n");
  daemon.process().signal(SIGHUP);
  CHECK(said(daemon, "kr5-arc: taken over for the next session: silence_ms"));
  daemon.process().signal(SIGTERM);
  CHECK(daemon.process().wait() == 0);
}

TEST_CASE("SIGUSR1 tells how the link does while RSI streams, and each session ends with it",
          "[life]") {
  const TemporaryFolder folder;
  Daemon daemon(folder.path());
  daemon.process().signal(SIGUSR1);
  CHECK(said(daemon, "kr5-arc: no RSI at the moment"));
  {
    Controller controller(daemon.port());
    REQUIRE(controller.streams(50));
    daemon.process().signal(SIGUSR1);
    CHECK(said(daemon, "kr5-arc: the link is "));
    CHECK(eventually([&] { return fs::exists(daemon.session() / "link.txt"); }));
    CHECK(content(daemon.session() / "link.txt").find("Reply latency") != std::string::npos);
  }
  CHECK(said(daemon, "silent for 2000 ms"));
  CHECK(eventually([&] { return run_file(daemon.session()).contains("ended"); }));
  const auto link = Json::parse(content(daemon.session() / "link.json"));
  CHECK(link["schema"] == "sweepd.link/1");
  daemon.process().signal(SIGTERM);
  CHECK(daemon.process().wait() == 0);
}

TEST_CASE("a session that ends badly leaves its last cycles beside the result", "[life]") {
  const TemporaryFolder folder;
  Daemon daemon(folder.path());
  Controller controller(daemon.port(), 100'000, 0.1);  // every tenth telegram is lost on its way
  REQUIRE(controller.streams(600));
  controller.stop();
  daemon.process().signal(SIGTERM);
  CHECK(daemon.process().wait() == 0);
  CHECK(said(daemon, "the stream ended badly"));
  const auto cycles = content(daemon.session() / "last_cycles.csv");
  CHECK(std::count(cycles.begin(), cycles.end(), '\n') == 257);  // a header and 256 cycles
  CHECK(content(daemon.session() / "link.txt").find("Verdict: bad") != std::string::npos);
}

TEST_CASE("a reader of the log that goes ends nothing", "[life][issue11][point_4]") {
  const TemporaryFolder folder;
  std::uint16_t port = 0;
  const auto config = settings_of_one(folder, port);
  LogPipe log(folder.path());
  SweepdProcess sweepd({"run", "--config", config.string()}, log.launch());
  std::string heard;
  CHECK(eventually([&] { return (heard += log.read()).find("listening on") != heard.npos; }));
  log.leave();
  sweepd.signal(SIGHUP);  // there is something to say
  check_serves(sweepd, folder / "output/kr5-arc", port);
}

TEST_CASE("a reader of the log that stands still stops nothing, not even the end",
          "[life][issue11][point_5]") {
  const TemporaryFolder folder;
  std::uint16_t port = 0;
  const auto config = settings_of_one(folder, port);
  LogPipe log(folder.path());
  log.fill();
  SweepdProcess sweepd({"run", "--config", config.string()}, log.launch());
  check_serves(sweepd, folder / "output/kr5-arc", port);
}

TEST_CASE("a limit of file size pauses the recording, and nothing else",
          "[life][issue11][point_4]") {
  const TemporaryFolder folder;
  Daemon daemon(folder.path(),
                {.settings = "silence_ms = 300\n",
                 .launch = {{"bash", "-c", "ulimit -f 16 && exec \"$0\" \"$@\""}, {}}});
  Streamer robot(daemon.port(), {});
  CHECK(said(daemon, "recording pauses, replies go on: cannot write"));
  const auto paused = robot.sent().size();
  CHECK(eventually([&] { return robot.sent().size() > paused + 100; }));
  const auto sent = robot.stop();
  CHECK(std::any_of(sent.begin() + static_cast<std::ptrdiff_t>(paused), sent.end(),
                    [](const auto& each) { return each.answered_after.has_value(); }));
  daemon.process().signal(SIGTERM);
  CHECK(daemon.process().wait() == 0);
}
