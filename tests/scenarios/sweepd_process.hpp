#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <sys/types.h>

#include "tests/config_folder.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/eventually.hpp"

namespace sweepd::test {

/// The real sweepd as a process of its own, with its output in files.
class SweepdProcess {
 public:
  /// How it is started.
  struct Launch {
    std::vector<std::string> before = {};       ///< a program that becomes sweepd, and its words
    std::vector<std::string> environment = {};  ///< NAME=VALUE, beside the test's own
  };

  explicit SweepdProcess(const std::vector<std::string>& arguments)
      : SweepdProcess(arguments, Launch{}) {}
  SweepdProcess(const std::vector<std::string>& arguments, const Launch& launch);
  ~SweepdProcess();  ///< kills it if it still runs
  SweepdProcess(const SweepdProcess&) = delete;
  SweepdProcess& operator=(const SweepdProcess&) = delete;

  [[nodiscard]] pid_t id() const { return id_; }
  void signal(int number) const;
  [[nodiscard]] bool running() const;
  /// The exit code, or 128 and the number of the signal that killed it. Throws, with what it said,
  /// if it takes longer than `longest`.
  int wait(std::chrono::seconds longest = std::chrono::seconds(60));

  [[nodiscard]] std::string out() const { return content(folder_ / "out"); }
  [[nodiscard]] std::string errors() const { return content(folder_ / "errors"); }

 private:
  TemporaryFolder folder_;
  pid_t id_ = -1;
  int exit_code_ = -1;
};

struct Run {
  int code = 0;
  std::string out;
  std::string errors;
};
/// Runs sweepd to its end.
Run run_sweepd(const std::vector<std::string>& arguments);

/// `sweepd run` for a KR 5 arc on a port of the loopback interface that was free.
class Daemon {
 public:
  struct Options {
    std::string settings = {};  ///< lines that follow in [[robot]]
    SweepdProcess::Launch launch = {};
    std::string pages = "off";  ///< `listen` of [http]
  };

  /// Waits until it listens.
  explicit Daemon(const std::filesystem::path& folder) : Daemon(folder, Options{}) {}
  Daemon(const std::filesystem::path& folder, Options options);

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  [[nodiscard]] const std::filesystem::path& config() const { return config_; }
  /// The folder of the one session that there is; empty before it begins.
  [[nodiscard]] std::filesystem::path session() const;
  SweepdProcess& process() { return *process_; }
  /// Ends it by SIGTERM, and starts it again with the same settings.
  void restart();
  /// As an operating system that kills it, or a crash: at once.
  void kill();
  void start();

 private:
  Options options_;
  std::filesystem::path output_;
  std::uint16_t port_;
  std::filesystem::path config_;
  std::unique_ptr<SweepdProcess> process_;
};

/// The number that follows `label` in a report; 0 if it is not there. "\ncycles overslept " of a
/// simulation: telegrams that did not leave, which the other side finds lost.
std::uint64_t figure(const std::string& report, const std::string& label);

/// A UDP port of 127.0.0.1 that nobody uses.
std::uint16_t free_port();
/// The same of TCP.
std::uint16_t free_tcp_port();

/// Writes a plan in which each joint turns through 30 degrees and back within about a second.
std::filesystem::path write_short_plan(const TemporaryFolder& folder);

}  // namespace sweepd::test
