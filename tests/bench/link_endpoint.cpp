// What the pages cost the replies: a controller at 250 Hz in windows of half a second, in turn
// without requests, with a thousand requests of /metrics a second, and without again. What the two
// windows without requests differ by is the machine's own.

#include <atomic>
#include <exception>
#include <iostream>
#include <iterator>
#include <stdexcept>
#include <thread>

#include "daemon/page/http_server.hpp"
#include "daemon/service/robot_service.hpp"
#include "daemon/system/realtime.hpp"
#include "rsi/telegram/ipoc.hpp"
#include "rsi/telegram/reply.hpp"
#include "tests/bench/link_client.hpp"
#include "tests/bench/link_parts.hpp"
#include "tests/bench/table.hpp"
#include "tests/daemon/http_client.hpp"
#include "tests/daemon/temporary_folder.hpp"

namespace bench {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kWindow = 500ms;
constexpr auto kBetweenRequests = 1ms;

/// Asks for /metrics a thousand times a second while it is told to. In the plant that is another
/// machine's work: here its share is low.
class Scraper {
 public:
  explicit Scraper(std::uint16_t port) : thread_([this, port] { run(port); }) {}
  ~Scraper() {
    stop_ = true;
    thread_.join();
  }
  void ask(bool now) { asking_ = now; }
  [[nodiscard]] std::uint64_t answers() const { return answers_; }
  [[nodiscard]] std::uint64_t failures() const { return failures_; }

 private:
  void run(std::uint16_t port) {
    sweepd::take(sweepd::Share::low);
    std::unique_ptr<sweepd::test::HttpClient> client;
    auto due = Clock::now();
    while (!stop_) {
      due = std::max(due + kBetweenRequests, Clock::now() - 10 * kBetweenRequests);
      std::this_thread::sleep_until(due);
      if (!asking_) continue;
      if (!client) client = std::make_unique<sweepd::test::HttpClient>(port);
      if (client->get("/metrics").status == 200) {
        ++answers_;
      } else {
        client.reset();  // a connection takes so many requests
        ++failures_;
      }
    }
  }

  std::atomic<bool> stop_{false};
  std::atomic<bool> asking_{false};
  std::atomic<std::uint64_t> answers_{0}, failures_{0};
  std::thread thread_;
};

/// By window: 0 and 2 without requests, 1 with.
using Windows = std::array<std::vector<std::chrono::nanoseconds>, 3>;

struct Measured {
  Windows windows;
  double requests_per_second = 0;
};

Measured measure(std::chrono::seconds time, bool fifo) {
  const sweepd::test::TemporaryFolder folder;
  auto robot = settings(folder.path(), "bench");
  if (fifo) robot.real_time.wish = sweepd::RealTime::require;
  sweepd::RobotService service(robot);
  service.start();
  sweepd::Published<sweepd::ServiceStatus> status(
      {sweepd::ServiceStatus::Phase::serving, {service.status()}, {}, Clock::now()});
  const sweepd::HttpPages pages(status, {});
  const sweepd::HttpServer server(
      {kLoopback, 0}, [&](const sweepd::HttpRequest& request) { return pages.answer(request); });
  Scraper scraper(server.local().port);

  Measured measured;
  std::exception_ptr failure;
  std::thread controller([&] {
    try {
      Telegrams telegrams;
      rsi::Reply reply(rsi::EthernetConfig::load(ethernet_file()));
      Client client(service.local().port);
      auto due = Clock::now();
      for (auto window = time / kWindow; window > 0; --window) {
        const auto kind = static_cast<std::size_t>(window % 3);
        scraper.ask(kind == 1);
        for (auto cycle = kWindow / kCycle; cycle > 0; --cycle) {
          const auto telegram = telegrams.next();
          due = std::max(due + kCycle, Clock::now());
          std::this_thread::sleep_until(due);
          if (client.exchange(telegram) != reply.with_ipoc(rsi::find_ipoc(telegram)))
            throw std::runtime_error("a wrong reply");
        }
        auto& times = client.turnarounds();
        std::move(times.begin(), times.end(), std::back_inserter(measured.windows[kind]));
        times.clear();
      }
    } catch (...) {
      failure = std::current_exception();
    }
  });
  controller.join();
  if (failure) std::rethrow_exception(failure);
  measured.requests_per_second =
      static_cast<double>(scraper.answers()) /
      std::chrono::duration<double>(kCycle * measured.windows[1].size()).count();
  service.stop();
  return measured;
}

void print(const char* title, Measured measured) {
  auto& [first, asked, second] = measured.windows;
  auto without = first;
  without.insert(without.end(), second.begin(), second.end());
  std::cout << title << ", " << sweepd::fixed(measured.requests_per_second, 0) << " requests/s\n";
  const std::pair<const char*, double> rows[] = {
      {"  p50", 0.5}, {"  p99", 0.99}, {"  p99.9", 0.999}, {"  max", 1.0}};
  for (const auto& [name, q] : rows) {
    const double with_us = quantile_us(asked, q);
    const double without_us = quantile_us(without, q);
    const double ratio = with_us / without_us;
    std::cout << left(name, 12) << right(without_us, 1, 9) << right(with_us, 1, 10)
              << right(ratio, 2, 9) << right(quantile_us(second, q) / quantile_us(first, q), 2, 9);
    if (q < 1) std::cout << "   ratio <= 1.10" << (ratio <= 1.1 ? "" : "  MISSED");
    std::cout << '\n';
  }
}

}  // namespace

void endpoint(std::chrono::seconds time) {
  std::cout << "reply turnaround at 250 Hz on loopback while the pages are asked for, in us\n"
            << left("", 12) << right("without", 9) << right("with", 10) << right("ratio", 9)
            << right("noise", 9) << "   aim\n";
  print("usual scheduling", measure(time, false));
  try {
    print("reply thread under SCHED_FIFO", measure(time, true));
  } catch (const std::exception& error) {
    std::cout << "SCHED_FIFO: not measured: " << error.what() << '\n';
  }
}

}  // namespace bench
