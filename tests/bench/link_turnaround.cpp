// One client sends the service and the echo server a telegram every 4 ms, in turn, 2 ms apart, so
// that the machine's noise meets both alike. The service does all that it does: recording, sweeps,
// identification.

#include <algorithm>
#include <atomic>
#include <iostream>
#include <optional>
#include <stdexcept>

#include "daemon/service/robot_service.hpp"
#include "daemon/system/realtime.hpp"
#include "rsi/telegram/ipoc.hpp"
#include "rsi/telegram/reply.hpp"
#include "tests/bench/link_client.hpp"
#include "tests/bench/link_parts.hpp"
#include "tests/bench/table.hpp"
#include "tests/daemon/temporary_folder.hpp"

namespace bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kServerPriority = 80;
/// Below the servers, above the load: what is measured is not the client's own waking up.
constexpr int kClientPriority = 70;

/// On this processor only, if it is one.
void enter_fifo(int priority, int processor) {
  sweepd::RealTimeSettings settings;
  settings.priority = priority;
  if (processor >= 0) settings.cpus = {processor};
  sweepd::RealTimeReport report;
  sweepd::enter_real_time(settings, report);
  if (!report.refused.empty()) throw std::runtime_error(report.refused.front());
}

struct Turnarounds {
  std::vector<std::chrono::nanoseconds> service, echo;
};

enum class Scheduling { usual, fifo, fifo_alone };

/// Lines that are no points, 10,000 a second: what a device sends that was set up wrong.
class DeviceFlood {
 public:
  explicit DeviceFlood(std::uint16_t port)
      : thread_([this, port] {
          boost::asio::io_context context;
          using boost::asio::ip::udp;
          udp::socket socket(context, udp::v4());
          const udp::endpoint to(boost::asio::ip::address_v4(kLoopback), port);
          const std::string line = "garbage of a device, which nobody has asked for; 1, 2\n";
          constexpr int kAtOnce = 10;
          for (auto due = Clock::now(); !stopping_; due += std::chrono::milliseconds(1)) {
            std::this_thread::sleep_until(due);
            boost::system::error_code ignored;
            for (int i = 0; i < kAtOnce; ++i)
              socket.send_to(boost::asio::buffer(line), to, 0, ignored);
          }
        }) {}
  ~DeviceFlood() {
    stopping_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

std::uint16_t free_port() {
  boost::asio::io_context context;
  const boost::asio::ip::udp::socket socket(context, {boost::asio::ip::address_v4(kLoopback), 0});
  return socket.local_endpoint().port();
}

/// Servers and client, each on a processor of its own where they are alone: what is measured is not
/// that one of them waits for the disk's work of another thread.
Turnarounds measure(std::chrono::seconds time, Scheduling scheduling, bool flood = false) {
  const bool fifo = scheduling != Scheduling::usual;
  const bool alone = scheduling == Scheduling::fifo_alone;
  // The rest, and the interrupts of the disk where they go to one of the last, are left to others.
  if (alone && std::thread::hardware_concurrency() < 4)
    throw std::runtime_error("it takes four processors");
  const int client_processor = alone ? 0 : -1;
  const int service_processor = alone ? 1 : -1;
  const int echo_processor = alone ? 2 : -1;
  const sweepd::test::TemporaryFolder temporary;
  auto robot = settings(temporary.path(), "bench");
  if (fifo) {
    robot.real_time.wish = sweepd::RealTime::require;
    robot.real_time.priority = kServerPriority;
  }
  if (alone) {
    robot.real_time.cpus = {service_processor};
    sweepd::leave_processors({client_processor, service_processor, echo_processor});
  }
  if (flood) {
    robot.device.listen.endpoint = {kLoopback, free_port()};
    robot.device.columns.text = "t_s,x_mm,y_mm,z_mm";
  }
  sweepd::RobotService service(robot);
  service.start();
  std::optional<DeviceFlood> device;
  if (flood) device.emplace(robot.device.listen.endpoint.port);
  std::function<void()> enter;
  if (fifo) enter = [=] { enter_fifo(kServerPriority, echo_processor); };
  const EchoServer echo(enter);
  Client to_service(service.local().port);
  Client to_echo(echo.port());
  std::exception_ptr failure;
  std::thread client([&] {
    try {
      if (fifo) enter_fifo(kClientPriority, client_processor);
      Telegrams telegrams;
      rsi::Reply reply(rsi::EthernetConfig::load(ethernet_file()));
      auto due = Clock::now();
      const auto wait = [&] {
        // What this machine oversleeps is not made up for: telegrams never come in bursts.
        due = std::max(due + kCycle / 2, Clock::now());
        std::this_thread::sleep_until(due);
      };
      for (auto cycle = time / kCycle; cycle > 0; --cycle) {
        const auto telegram = telegrams.next();
        wait();
        if (to_service.exchange(telegram) != reply.with_ipoc(rsi::find_ipoc(telegram)))
          throw std::runtime_error("a wrong reply");
        wait();
        static_cast<void>(to_echo.exchange(telegram));
      }
    } catch (...) {
      failure = std::current_exception();
    }
  });
  client.join();
  if (failure) std::rethrow_exception(failure);
  service.stop();
  return {std::move(to_service.turnarounds()), std::move(to_echo.turnarounds())};
}

struct Row {
  const char* name;
  double q;
  double ratio_aim = 0;    // 0: none
  double service_aim = 0;  // us
};

void print(const char* title, Turnarounds times, const std::vector<Row>& rows) {
  std::cout << title << '\n';
  for (const auto& [name, q, ratio_aim, service_aim] : rows) {
    const double service = quantile_us(times.service, q);
    const double echo = quantile_us(times.echo, q);
    std::cout << left(std::string("  ") + name, 12) << right(service, 1, 9) << right(echo, 1, 10)
              << right(service / echo, 2, 9);
    if (ratio_aim != 0)
      std::cout << "   ratio <= " << sweepd::fixed(ratio_aim, 2)
                << (service / echo <= ratio_aim ? "" : "  MISSED");
    if (service_aim != 0)
      std::cout << "   sweepd < " << sweepd::fixed(service_aim, 0)
                << (service < service_aim ? "" : "  MISSED");
    std::cout << '\n';
  }
}

}  // namespace

void turnaround(std::chrono::seconds time) {
  std::cout << "reply turnaround at 250 Hz on loopback, " << time / kCycle
            << " telegrams to each, in us\n"
            << left("", 12) << right("sweepd", 9) << right("echo", 10) << right("ratio", 9)
            << "   aim\n";
  const std::vector<Row> rows{
      {"p50", 0.5, 1.10}, {"p99", 0.99}, {"p99.9", 0.999, 1.25}, {"max", 1.0}};
  print("idle", measure(time, Scheduling::usual), rows);
  print("a device sends 10,000 lines of garbage a second", measure(time, Scheduling::usual, true),
        rows);
  const Load load;
  print("all processors busy", measure(time, Scheduling::usual), rows);
  const std::vector<Row> fifo_rows{
      {"p50", 0.5, 1.10}, {"p99", 0.99}, {"p99.9", 0.999, 1.25, 250}, {"max", 1.0}};
  try {
    print("all processors busy, both servers under SCHED_FIFO", measure(time, Scheduling::fifo),
          fifo_rows);
    print("the same, cpus set: servers and client each on a processor of its own",
          measure(time, Scheduling::fifo_alone), fifo_rows);
  } catch (const std::exception& error) {
    std::cout << "all processors busy, SCHED_FIFO: not measured: " << error.what() << '\n';
  }
}

}  // namespace bench
