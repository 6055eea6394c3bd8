// One client sends the service and the echo server a telegram every 4 ms, in turn, 2 ms apart, so
// that the machine's noise meets both alike. The service does all that it does: recording, sweeps,
// identification.

#include <cerrno>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <system_error>

#include <pthread.h>
#include <sys/socket.h>

#include "daemon/robot_service.hpp"
#include "rsi/ipoc.hpp"
#include "rsi/reply.hpp"
#include "tests/bench/link_parts.hpp"
#include "tests/bench/table.hpp"
#include "tests/daemon/temporary_folder.hpp"

namespace bench {
namespace {

using boost::asio::ip::udp;
using Clock = std::chrono::steady_clock;

constexpr int kServerPriority = 80;
/// Below the servers, above the load: what is measured is not the client's own waking up.
constexpr int kClientPriority = 70;

void enter_fifo(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters); error != 0)
    throw std::system_error(error, std::generic_category(), "SCHED_FIFO");
}

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

  std::vector<std::chrono::nanoseconds>& turnarounds() { return turnarounds_; }

 private:
  boost::asio::io_context context_;
  udp::socket socket_;
  std::array<char, 65536> buffer_{};
  std::vector<std::chrono::nanoseconds> turnarounds_;
};

struct Turnarounds {
  std::vector<std::chrono::nanoseconds> service, echo;
};

/// On a thread of its own, whose priority goes with it.
Turnarounds measure(std::chrono::seconds time, bool fifo) {
  const sweepd::test::TemporaryFolder temporary;
  auto robot = settings(temporary.path(), "bench");
  if (fifo) {
    robot.real_time.wish = sweepd::RealTime::require;
    robot.real_time.priority = kServerPriority;
  }
  sweepd::RobotService service(robot);
  service.start();
  const EchoServer echo(fifo ? [] { enter_fifo(kServerPriority); } : std::function<void()>());
  Client to_service(service.local().port);
  Client to_echo(echo.port());
  std::exception_ptr failure;
  std::thread client([&] {
    try {
      if (fifo) enter_fifo(kClientPriority);
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
  print("idle", measure(time, false), rows);
  const Load load;
  print("all processors busy", measure(time, false), rows);
  try {
    print("all processors busy, both servers under SCHED_FIFO", measure(time, true),
          {{"p50", 0.5, 1.10}, {"p99", 0.99}, {"p99.9", 0.999, 1.25, 250}, {"max", 1.0}});
  } catch (const std::exception& error) {
    std::cout << "all processors busy, SCHED_FIFO: not measured: " << error.what() << '\n';
  }
}

}  // namespace bench
