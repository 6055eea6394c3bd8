// What the pages cost the replies: a controller at 250 Hz in windows, in turn without requests,
// with them, and without again. What the two windows without requests differ by is the machine's
// own. Requests are a thousand of /metrics a second in windows of half a second, or eight viewers
// of the live page and one that never reads in windows of twenty, at whose beginning each gets the
// last minute.

#include <algorithm>
#include <atomic>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>
#include <thread>

#include "daemon/page/http_server.hpp"
#include "daemon/service/robot_service.hpp"
#include "daemon/system/process_state.hpp"
#include "daemon/system/realtime.hpp"
#include "rsi/telegram/ipoc.hpp"
#include "rsi/telegram/reply.hpp"
#include "tests/bench/link_client.hpp"
#include "tests/bench/link_parts.hpp"
#include "tests/bench/table.hpp"
#include "tests/daemon/http_client.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/process_threads.hpp"

namespace bench {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kScraped = 500ms;
constexpr auto kViewed = 20'000ms;
constexpr std::size_t kViewers = 8;
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

/// Look at the live page while they are told to; the last one never reads. Likewise.
class Viewers {
 public:
  explicit Viewers(std::uint16_t port) : port_(port) {
    for (std::size_t i = 0; i < kViewers; ++i) threads_.emplace_back([this] { run(); });
  }
  ~Viewers() {
    stop_ = true;
    for (auto& thread : threads_) thread.join();
  }
  void ask(bool now) {
    if (now && !looking_) never_reads_ = std::make_unique<sweepd::test::HttpClient>(port_);
    if (now && !looking_) never_reads_->send(kRequest);
    if (!now) never_reads_.reset();
    looking_ = now;
  }
  [[nodiscard]] std::uint64_t answers() const { return events_; }

 private:
  static constexpr const char* kRequest = "GET /api/live HTTP/1.1\r\nHost: localhost\r\n\r\n";

  void run() {
    sweepd::take(sweepd::Share::low);
    while (!stop_) {
      std::this_thread::sleep_for(10ms);
      if (!looking_) continue;
      sweepd::test::HttpClient client(port_);
      client.send(kRequest);
      while (looking_ && !stop_ && !client.until("\n\n").empty()) ++events_;
    }
  }

  const std::uint16_t port_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> looking_{false};
  std::atomic<std::uint64_t> events_{0};
  std::unique_ptr<sweepd::test::HttpClient> never_reads_;  // of the thread that asks
  std::vector<std::thread> threads_;
};

/// Processor time of this process's thread with this name.
std::chrono::nanoseconds processor_time(const std::string& thread) {
  for (const auto& task : sweepd::test::threads_of()) {
    std::uint64_t ns = 0;
    if (task.name == thread && std::ifstream(task.proc / "schedstat") >> ns)
      return std::chrono::nanoseconds(ns);
  }
  return {};
}

double resident_mib() {
  return static_cast<double>(sweepd::process_state().resident_bytes) / (1 << 20);
}

/// By window: 0 and 2 without requests, 1 with.
using Windows = std::array<std::vector<std::chrono::nanoseconds>, 3>;

struct Measured {
  Windows windows;
  double requests_per_second = 0;
  double http_share = 0;               ///< of a processor, while there are requests
  double early_mib = 0, late_mib = 0;  ///< memory of all, after the first round and at the end
};

template <typename Load>
Measured measure(std::chrono::seconds time, std::chrono::milliseconds each, bool fifo) {
  const sweepd::test::TemporaryFolder folder;
  auto robot = settings(folder.path(), "bench");
  if (fifo) robot.real_time.wish = sweepd::RealTime::require;
  sweepd::RobotService service(robot);
  service.start();
  sweepd::Published<sweepd::ServiceStatus> status(
      {sweepd::ServiceStatus::Phase::serving, {service.status()}, {}, Clock::now()});
  const sweepd::HttpPages pages(status, {});
  sweepd::HttpServer::Limits limits;
  limits.viewers = kViewers + 1;
  const sweepd::HttpServer server(
      {kLoopback, 0}, [&](const sweepd::HttpRequest& request) { return pages.answer(request); },
      limits);
  Load load(server.local().port);

  Measured measured;
  std::exception_ptr failure;
  std::thread controller([&] {
    try {
      Telegrams telegrams;
      rsi::Reply reply(rsi::EthernetConfig::load(ethernet_file()));
      Client client(service.local().port);
      auto due = Clock::now();
      std::chrono::nanoseconds http{};
      for (auto window = time / each; window > 0; --window) {
        const auto kind = static_cast<std::size_t>(window % 3);
        load.ask(kind == 1);
        const auto http_before = processor_time("http");
        for (auto cycle = each / kCycle; cycle > 0; --cycle) {
          const auto telegram = telegrams.next();
          due = std::max(due + kCycle, Clock::now());
          std::this_thread::sleep_until(due);
          if (client.exchange(telegram) != reply.with_ipoc(rsi::find_ipoc(telegram)))
            throw std::runtime_error("a wrong reply");
        }
        auto& times = client.turnarounds();
        std::move(times.begin(), times.end(), std::back_inserter(measured.windows[kind]));
        times.clear();
        if (kind == 1) http += processor_time("http") - http_before;
        if (measured.early_mib == 0 && !measured.windows[1].empty())
          measured.early_mib = resident_mib();
      }
      load.ask(false);
      measured.late_mib = resident_mib();
      measured.http_share = std::chrono::duration<double>(http) /
                            std::chrono::duration<double>(kCycle * measured.windows[1].size());
    } catch (...) {
      failure = std::current_exception();
    }
  });
  controller.join();
  if (failure) std::rethrow_exception(failure);
  measured.requests_per_second =
      static_cast<double>(load.answers()) /
      std::chrono::duration<double>(kCycle * measured.windows[1].size()).count();
  service.stop();
  return measured;
}

void print(const char* title, Measured measured) {
  auto& [first, asked, second] = measured.windows;
  auto without = first;
  without.insert(without.end(), second.begin(), second.end());
  std::cout << title << ", " << sweepd::fixed(measured.requests_per_second, 0)
            << " answers/s, the http thread takes " << sweepd::fixed(100 * measured.http_share, 2)
            << " % of a processor, memory " << sweepd::fixed(measured.early_mib, 1) << " to "
            << sweepd::fixed(measured.late_mib, 1) << " MiB\n";
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
  print("/metrics, usual scheduling", measure<Scraper>(time, kScraped, false));
  print("8 viewers and one that never reads, usual scheduling",
        measure<Viewers>(time, kViewed, false));
  try {
    print("/metrics, reply thread under SCHED_FIFO", measure<Scraper>(time, kScraped, true));
    print("8 viewers and one that never reads, reply thread under SCHED_FIFO",
          measure<Viewers>(time, kViewed, true));
  } catch (const std::exception& error) {
    std::cout << "SCHED_FIFO: not measured: " << error.what() << '\n';
  }
}

}  // namespace bench
