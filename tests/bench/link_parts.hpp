#pragma once

// What the parts of the link's bench share: the bare server to compare with, the service, the
// telegrams, and what the system says of a process.

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "rsi/asio.hpp"

#include "daemon/plan/simulated_robot.hpp"
#include "daemon/settings/settings.hpp"
#include "rsi/telegram/ethernet_config.hpp"
#include "rsi/telegram/telegram_writer.hpp"

namespace bench {

inline constexpr std::chrono::milliseconds kCycle{4};
inline constexpr std::uint32_t kLoopback = 0x7f000001;

[[nodiscard]] const std::filesystem::path& ethernet_file();

/// A robot as `sweepd run` serves it, on any port of the loopback interface, without real time.
[[nodiscard]] sweepd::RobotSettings settings(const std::filesystem::path& output,
                                             const std::string& name);

/// Asio's usual server: receive, send, receive again, on a thread of its own. It sends as many
/// bytes as sweepd does.
class EchoServer {
 public:
  /// `prepare` runs on its thread first.
  explicit EchoServer(std::function<void()> prepare = {});
  ~EchoServer();
  EchoServer(const EchoServer&) = delete;
  EchoServer& operator=(const EchoServer&) = delete;

  [[nodiscard]] std::uint16_t port() const { return socket_.local_endpoint().port(); }

 private:
  void receive();

  boost::asio::io_context context_{1};
  boost::asio::ip::udp::socket socket_;
  std::size_t reply_size_;
  std::array<char, 65536> buffer_{};
  boost::asio::ip::udp::endpoint source_;
  std::thread thread_;
};

/// Telegrams of a robot that runs the 90 degree plan, and then again or rests.
class Telegrams {
 public:
  enum class Then : std::uint8_t { again, rest };
  explicit Telegrams(Then then = Then::again);

  /// Valid until the next call.
  [[nodiscard]] std::string_view next();
  /// From 1,525,088 on in steps of 4.
  [[nodiscard]] std::uint64_t ipoc() const { return ipoc_; }

 private:
  static sweepd::SimulatedRobot start();

  Then then_;
  rsi::TelegramWriter writer_;
  sweepd::SimulatedRobot robot_;
  rsi::SignalValues values_;
  std::uint64_t ipoc_;
  std::string telegram_;
};

/// The smallest of `times` that the share `q` of all does not exceed, in microseconds; sorts them.
[[nodiscard]] double quantile_us(std::vector<std::chrono::nanoseconds>& times, double q);

/// Time on a processor of a process's threads, by their names.
[[nodiscard]] std::map<std::string, std::chrono::nanoseconds> processor_times(int process);
[[nodiscard]] double resident_mb(int process);
[[nodiscard]] std::size_t open_files(int process);

/// A server in a process of its own, so that its time and memory are its alone.
class Child {
 public:
  /// `serve` runs in the child; it calls `ready` with what the parent is to know, and returns when
  /// that returns.
  using Ready = std::function<void(const std::vector<int>& numbers)>;
  explicit Child(const std::function<void(const Ready& ready)>& serve);
  ~Child();  ///< as stop(), but does not throw
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  [[nodiscard]] int process() const { return process_; }
  [[nodiscard]] const std::vector<int>& numbers() const { return numbers_; }
  /// Lets it end. Throws std::runtime_error if it failed.
  void stop();

 private:
  int end() noexcept;

  int process_ = -1;
  int to_child_ = -1;
  std::vector<int> numbers_;
};

/// As many processes that do nothing but take time as there are processors.
class Load {
 public:
  Load();
  ~Load();
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

 private:
  std::vector<int> processes_;
};

/// Sum over all run.json below a folder of a number in "since_start_of_sweepd".
[[nodiscard]] std::uint64_t counted(const std::filesystem::path& output, const char* name);

/// The benches; see link_bench.cpp.
void turnaround(std::chrono::seconds time);
void endpoint(std::chrono::seconds time);
void fleet(const std::vector<std::size_t>& robots, std::chrono::seconds time);
void soak(std::uint64_t telegrams, std::uint64_t per_stream);

}  // namespace bench
