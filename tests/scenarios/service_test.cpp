#include <algorithm>
#include <csignal>
#include <cstring>
#include <deque>
#include <fstream>
#include <iostream>
#include <optional>

#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "rsi/asio.hpp"

#include "tests/catch.hpp"
#include "tests/process_threads.hpp"
#include "tests/scenarios/streamer.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace std::chrono_literals;
using namespace sweepd::test;
using Clock = std::chrono::steady_clock;

namespace {

/// systemd's end of the notification protocol (sd_notify(3)).
class ServiceManager {
 public:
  explicit ServiceManager(const std::filesystem::path& folder)
      : path_(folder / "notify"), socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path_.c_str(), sizeof address.sun_path - 1);
    REQUIRE(::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
  }
  ~ServiceManager() { ::close(socket_); }
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  [[nodiscard]] SweepdProcess::Launch launch() const {
    return {{}, {"NOTIFY_SOCKET=" + path_.string()}};
  }

  /// The next assignment, "READY=1"; nothing if none comes in time.
  std::optional<std::string> next(Clock::duration longest) {
    const auto until = Clock::now() + longest;
    while (waiting_.empty() && Clock::now() < until) receive(until - Clock::now());
    if (waiting_.empty()) return std::nullopt;
    std::string first = waiting_.front();
    waiting_.pop_front();
    return first;
  }
  /// Whether this comes in time; what comes before it is passed over.
  bool hears(const std::string& assignment, Clock::duration longest = 30s) {
    const auto until = Clock::now() + longest;
    while (Clock::now() < until)
      if (const auto heard = next(until - Clock::now()); heard == assignment) return true;
    return false;
  }

 private:
  void receive(Clock::duration longest) {
    const auto us = std::chrono::duration_cast<std::chrono::microseconds>(longest).count() + 1;
    const timeval timeout{us / 1'000'000, us % 1'000'000};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
    char text[4096];
    const auto size = ::recv(socket_, text, sizeof text, 0);
    if (size <= 0) return;
    std::string_view left(text, static_cast<std::size_t>(size));
    while (!left.empty()) {
      const auto end = std::min(left.find('\n'), left.size());
      waiting_.emplace_back(left.substr(0, end));
      left.remove_prefix(std::min(end + 1, left.size()));
    }
  }

  std::filesystem::path path_;
  int socket_;
  std::deque<std::string> waiting_;
};

/// A thread of another process, held where it is.
class HeldThread {
 public:
  HeldThread(pid_t process, const std::string& name) {
    const bool found = eventually([&] {  // a thread names itself
      for (const auto& thread : sweepd::test::threads_of(std::to_string(process)))
        if (thread.name == name) id_ = thread.id;
      return id_ > 0;
    });
    REQUIRE(found);
    held_ = ::ptrace(PTRACE_SEIZE, id_, nullptr, nullptr) == 0 &&
            ::ptrace(PTRACE_INTERRUPT, id_, nullptr, nullptr) == 0 &&
            ::waitpid(id_, nullptr, __WALL) == id_;
  }
  ~HeldThread() {
    if (held_) ::ptrace(PTRACE_DETACH, id_, nullptr, nullptr);
  }
  HeldThread(const HeldThread&) = delete;
  HeldThread& operator=(const HeldThread&) = delete;

  [[nodiscard]] bool held() const { return held_; }

 private:
  pid_t id_ = 0;
  bool held_ = false;
};

/// What WatchdogSec is in the unit.
constexpr auto kWatchdog = 30s;

std::string port_taken(const std::filesystem::path& folder, std::uint16_t port) {
  const auto file = folder / "taken.toml";
  std::ofstream(file) << "[[robot]]\nname = \"arc\"\ndescription = \""
                      << (kConfig / "robots/kr5_arc.toml").string()
                      << "\"\nlisten = \"127.0.0.1:" << port << "\"\noutput = \"output\"\n";
  return file.string();
}

}  // namespace

TEST_CASE("systemd hears that sweepd is ready when it answers, and how it goes on", "[service]") {
  const TemporaryFolder folder;
  ServiceManager systemd(folder.path());
  Daemon daemon(folder.path(), {.settings = {}, .launch = systemd.launch()});
  REQUIRE(systemd.hears("READY=1"));
  {
    Streamer robot(daemon.port(), {});
    CHECK(eventually([&] { return robot.sent().size() >= 50; }));
    const auto sent = robot.stop();
    REQUIRE_FALSE(sent.empty());
    CHECK(sent.front().answered_after.has_value());
  }
  CHECK(systemd.hears("WATCHDOG=1"));
  CHECK(systemd.hears("WATCHDOG=1", kWatchdog / 2));

  daemon.process().signal(SIGHUP);
  CHECK(systemd.hears("RELOADING=1"));
  CHECK(systemd.hears("READY=1"));

  daemon.process().signal(SIGTERM);
  CHECK(systemd.hears("STOPPING=1"));
  CHECK(daemon.process().wait() == 0);
}

TEST_CASE("a sweepd that cannot serve is never ready, and its exit code says why", "[service]") {
  const TemporaryFolder folder;
  ServiceManager systemd(folder.path());
  const auto never_ready = [&] {
    while (const auto heard = systemd.next(0s))
      if (*heard == "READY=1") return false;
    return true;
  };

  const boost::asio::ip::udp::endpoint any(boost::asio::ip::address_v4::loopback(), 0);
  boost::asio::io_context context;
  const boost::asio::ip::udp::socket other(context, any);
  SweepdProcess taken({"run", "--config", port_taken(folder.path(), other.local_endpoint().port())},
                      systemd.launch());
  CHECK(taken.wait() == 1);
  CHECK_THAT(taken.errors(), Catch::Matchers::ContainsSubstring("in use"));
  CHECK(never_ready());

  std::ofstream(folder.path() / "wrong.toml") << "[[robot]]\nnmae = \"arc\"\n";
  SweepdProcess wrong({"run", "--config", (folder.path() / "wrong.toml").string()},
                      systemd.launch());
  CHECK(wrong.wait() == 78);
  CHECK(never_ready());
}

TEST_CASE("the watchdog is not fed while a thread that serves the robot stands still",
          "[service]") {
  for (const std::string thread : {"acquisition", "reply"}) {
    INFO("thread " << thread);
    const TemporaryFolder folder;
    ServiceManager systemd(folder.path());
    Daemon daemon(folder.path(), {.settings = {}, .launch = systemd.launch()});
    REQUIRE(systemd.hears("WATCHDOG=1"));
    {
      const HeldThread held(daemon.process().id(), thread);
      if (!held.held()) {
        std::cout << "not permitted here: to hold a thread of another process\n";
        return;
      }
      // The last beat, and then none for long enough to be no accident.
      const auto began = Clock::now();
      auto last = began;
      while (Clock::now() < last + 4s && Clock::now() < began + kWatchdog)
        if (systemd.hears("WATCHDOG=1", 4s)) last = Clock::now();
      CHECK(last - began < kWatchdog / 2);
      // On a machine that is busy the beats may stop before that is said.
      const std::string said = "kr5-arc: the " + thread + " thread stands still: ";
      eventually([&] { return daemon.process().errors().find(said) != std::string::npos; });
      CHECK_THAT(daemon.process().errors(), Catch::Matchers::ContainsSubstring(said));
      if (thread == "acquisition") {
        // Replies don't need it.
        Streamer robot(daemon.port(), {});
        CHECK(eventually([&] { return robot.sent().size() >= 50; }));
        const auto sent = robot.stop();
        CHECK(sent.front().answered_after.has_value());
      }
    }
    CHECK(systemd.hears("WATCHDOG=1"));
    daemon.process().signal(SIGTERM);
    CHECK(daemon.process().wait() == 0);
  }
}

TEST_CASE("systemd hears beats while a robot whose disk stands still is let go",
          "[service][issue11][point_6]") {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  std::cout << "not permitted here: a library before a sanitizer's\n";
#else
  const TemporaryFolder folder;
  ServiceManager systemd(folder.path());
  const auto marker = folder / "stopped";
  auto launch = systemd.launch();
  launch.environment.push_back(std::string("LD_PRELOAD=") + SLOW_DISK_LIBRARY);
  launch.environment.push_back("SWEEPD_STOPPED_DISK=" + marker.string());
  Daemon daemon(folder.path(), {.settings = {}, .launch = launch});
  Streamer robot(daemon.port(), {});
  REQUIRE(eventually([&] { return robot.sent().size() > 100; }));
  static_cast<void>(folder.write("stopped", ""));

  auto settings = content(daemon.config());
  settings.replace(settings.find("kr5-arc"), 7, "another");
  std::ofstream(daemon.config()) << settings;
  while (systemd.next(0s)) {
  }
  daemon.process().signal(SIGHUP);
  CHECK(systemd.hears("RELOADING=1"));
  CHECK(systemd.hears("READY=1"));
  // The disk is waited for longer than this.
  for (const auto until = Clock::now() + 5s; Clock::now() < until;)
    CHECK(systemd.hears("WATCHDOG=1", 4s));
  CHECK_THAT(daemon.process().errors(),
             Catch::Matchers::ContainsSubstring("kr5-arc: no longer in the settings"));
  std::filesystem::remove(marker);
  // Its port is free again for the other one.
  CHECK(eventually([&] {
    return daemon.process().errors().find("another: listening on UDP") != std::string::npos;
  }));
  robot.stop();
  daemon.process().signal(SIGTERM);
  CHECK(daemon.process().wait() == 0);
#endif
}
