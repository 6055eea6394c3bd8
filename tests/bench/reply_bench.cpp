// How soon a telegram is answered, against an Asio server that does nothing but send as many bytes
// back.
//
// The real service runs in this process with all that it does: reply thread, recording, sweeps,
// identification. The echo server runs beside it on a thread of its own. One client sends each of
// them a telegram every 4 ms, in turn, 2 ms apart, so that the machine's noise meets both alike.

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <tuple>
#include <vector>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include "rsi/asio.hpp"

#include "daemon/robot_description.hpp"
#include "daemon/robot_service.hpp"
#include "daemon/simulated_robot.hpp"
#include "daemon/sweep_plan.hpp"
#include "rsi/capture_reader.hpp"
#include "rsi/ethernet_config.hpp"
#include "rsi/ipoc.hpp"
#include "rsi/reply.hpp"
#include "rsi/telegram_writer.hpp"
#include "tests/bench/table.hpp"
#include "tests/daemon/temporary_folder.hpp"

namespace {

using boost::asio::ip::udp;
using std::filesystem::path;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto kCycle = 4ms;

const path kConfig = path(SWEEPD_SOURCE_DIR) / "config";
const path kRobot = kConfig / "robots/kr5_arc.toml";
const path kPlan = kConfig / "plans/kr5_arc_90deg.toml";
const path kEthernet = kConfig / "controller/krc4/sweepd_ethernet.xml";

/// Asio's usual server: receive, send, receive again.
class EchoServer {
 public:
  explicit EchoServer(std::size_t reply_size)
      : socket_(context_, {boost::asio::ip::address_v4::loopback(), 0}), reply_size_(reply_size) {
    receive();
    thread_ = std::thread([this] { context_.run(); });
  }
  ~EchoServer() {
    context_.stop();
    thread_.join();
  }
  EchoServer(const EchoServer&) = delete;
  EchoServer& operator=(const EchoServer&) = delete;

  [[nodiscard]] std::uint16_t port() const { return socket_.local_endpoint().port(); }

 private:
  void receive() {
    socket_.async_receive_from(
        boost::asio::buffer(buffer_), source_,
        [this](const boost::system::error_code& error, std::size_t size) {
          if (!error)
            socket_.send_to(boost::asio::buffer(buffer_, std::min(size, reply_size_)), source_);
          receive();
        });
  }

  boost::asio::io_context context_{1};
  udp::socket socket_;
  std::size_t reply_size_;
  std::array<char, 65536> buffer_{};
  udp::endpoint source_;
  std::thread thread_;
};

/// The service as `sweepd run` has it.
class Service {
 public:
  explicit Service(const path& output) : service_(settings(output)) { service_.start(); }

  [[nodiscard]] std::uint16_t port() const { return service_.local().port; }
  void stop() { service_.stop(); }

 private:
  static sweepd::RobotSettings settings(const path& output) {
    sweepd::RobotSettings settings;
    settings.name = "bench";
    settings.description = kRobot;
    settings.listen = {0x7f000001, 0};  // loopback, any port
    settings.ethernet_config = kEthernet;
    settings.output = output;
    return settings;
  }

  sweepd::RobotService service_;
};

/// Sends to one server and waits for what it answers.
class Client {
 public:
  explicit Client(std::uint16_t port) : socket_(context_, udp::v4()) {
    socket_.connect({boost::asio::ip::address_v4::loopback(), port});
    const timeval longest{1, 0};
    setsockopt(socket_.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof longest);
  }

  /// The reply is valid until the next call.
  std::string_view exchange(std::string_view telegram) {
    const auto sent = Clock::now();
    socket_.send(boost::asio::buffer(telegram.data(), telegram.size()));
    const auto size = recv(socket_.native_handle(), buffer_.data(), buffer_.size(), 0);
    const auto received = Clock::now();
    if (size < 0)
      throw std::system_error(errno, std::generic_category(), "no answer within a second");
    turnarounds_.push_back(received - sent);
    return {buffer_.data(), static_cast<std::size_t>(size)};
  }

  /// The smallest turnaround that the share `q` of all does not exceed.
  [[nodiscard]] double quantile_us(double q) {
    std::sort(turnarounds_.begin(), turnarounds_.end());
    const auto rank = std::ceil(q * static_cast<double>(turnarounds_.size()));
    const auto at = std::max<std::size_t>(1, static_cast<std::size_t>(rank)) - 1;
    return std::chrono::duration<double, std::micro>(turnarounds_[at]).count();
  }

 private:
  boost::asio::io_context context_;
  udp::socket socket_;
  std::array<char, 65536> buffer_{};
  std::vector<Clock::duration> turnarounds_;
};

/// Telegrams of a robot that repeats the plan.
class Telegrams {
 public:
  explicit Telegrams(const rsi::EthernetConfig& config) : writer_(config, 4) {}

  [[nodiscard]] std::string_view next() {
    if (!robot_.next(values_)) {
      robot_ = start();
      static_cast<void>(robot_.next(values_));
    }
    telegram_.clear();
    ipoc_ += static_cast<std::uint64_t>(kCycle.count());
    writer_.append(telegram_, values_, ipoc_);
    return telegram_;
  }

 private:
  static sweepd::SimulatedRobot start() {
    return {sweepd::load_robot(kRobot), sweepd::load_plan(kPlan), {}};
  }

  rsi::TelegramWriter writer_;
  sweepd::SimulatedRobot robot_ = start();
  rsi::SignalValues values_;
  std::uint64_t ipoc_ = 1'525'084;
  std::string telegram_;
};

std::uint64_t recorded(const path& output) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(output)) {
    if (entry.path().filename() != "trace.pcap") continue;
    rsi::CaptureReader trace(entry.path());
    while (trace.next()) {
    }
    return trace.counters().udp;
  }
  return 0;
}

void print(const std::string& name, double ours, double echo, const std::string& aim) {
  using bench::right;
  std::cout << name << right(ours, 1, 20 - name.size()) << right(echo, 1, 12)
            << right(ours / echo, 2, 12) << right(aim, 9) << '\n';
}

void measure(std::chrono::seconds time) {
  const sweepd::test::TemporaryFolder temporary;
  const auto config = rsi::EthernetConfig::load(kEthernet);
  Telegrams telegrams(config);
  rsi::Reply reply(config);
  Service service(temporary.path());
  EchoServer echo(reply.with_ipoc("1525088").size());
  Client to_service(service.port());
  Client to_echo(echo.port());

  const auto cycles = time / kCycle;
  auto due = Clock::now();
  const auto wait = [&] {
    // What this machine oversleeps is not made up for: telegrams never come in bursts.
    due = std::max(due + kCycle / 2, Clock::now());
    std::this_thread::sleep_until(due);
  };
  for (auto cycle = cycles; cycle > 0; --cycle) {
    const auto telegram = telegrams.next();
    wait();
    if (to_service.exchange(telegram) != reply.with_ipoc(rsi::find_ipoc(telegram)))
      throw std::runtime_error("a wrong reply");
    wait();
    static_cast<void>(to_echo.exchange(telegram));
  }
  service.stop();

  std::cout << "reply turnaround at 250 Hz on loopback, " << cycles << " telegrams to each, in us\n"
            << "              sweepd        echo       ratio      aim\n";
  for (const auto& [name, q, aim] :
       {std::tuple("p50", 0.5, "<= 1.15"), std::tuple("p99", 0.99, ""),
        std::tuple("p99.9", 0.999, "<= 1.5"), std::tuple("max", 1.0, "")})
    print(name, to_service.quantile_us(q), to_echo.quantile_us(q), aim);
  std::cout << "sweepd recorded " << recorded(temporary.path()) << " of " << 2 * cycles
            << " datagrams meanwhile\n";
}

}  // namespace

int main(int argc, char** argv) {
  int seconds = 60;
  CLI::App app("Reply turnaround against a bare Asio echo server", "bench_reply");
  app.add_option("--seconds", seconds, "How long to measure")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.footer("The recording lies in TMPDIR, or /tmp.");
  CLI11_PARSE(app, argc, argv)
  spdlog::set_level(spdlog::level::warn);
  try {
    measure(std::chrono::seconds(seconds));
  } catch (const std::exception& error) {
    std::cerr << "bench_reply: " << error.what() << '\n';
    return 1;
  }
}
