#include <algorithm>
#include <atomic>
#include <csignal>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <nlohmann/json.hpp>

#include "tests/catch.hpp"
#include "tests/daemon/http_client.hpp"
#include "tests/scenarios/streamer.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;
using Json = nlohmann::json;

namespace {

/// sweepd with its pages on a port of their own; a stream ends after 300 ms.
struct ServedDaemon {
  TemporaryFolder folder;
  std::uint16_t pages = free_tcp_port();
  Daemon daemon{folder.path(), {"silence_ms = 300\n", {}, "127.0.0.1:" + std::to_string(pages)}};

  HttpAnswer get(const std::string& target) const { return HttpClient(pages).get(target); }
  /// The value of a metric with these labels after the robot's.
  double metric(const std::string& name, const std::string& labels = {}) const {
    if (const auto value = metric_if_any(name, labels)) return *value;
    throw std::runtime_error("no metric " + name + labels);
  }
  /// A joint's counters appear with its first sweep.
  std::optional<double> metric_if_any(const std::string& name, const std::string& labels) const {
    const auto text = get("/metrics").body;
    const auto line = "\n" + name + "{robot=\"kr5-arc\"" + labels + "} ";
    const auto at = text.find(line);
    if (at == text.npos) return std::nullopt;
    return std::stod(text.substr(at + line.size()));
  }
  bool said(const std::string& words) {
    return eventually([&] { return daemon.process().errors().find(words) != std::string::npos; });
  }
};

/// Keeps a thousand connections hanging, each new one instead of one that was closed, and sends
/// what nobody should.
class Nuisance {
 public:
  explicit Nuisance(std::uint16_t port) : thread_([this, port] { run(port); }) {}
  ~Nuisance() {
    stop_ = true;
    thread_.join();
  }
  [[nodiscard]] std::uint64_t rounds() const { return rounds_; }

 private:
  void run(std::uint16_t port) {
    const std::string host = "Host: localhost\r\n";
    const std::string all[] = {
        "",
        "GET /metr",
        "POST /api/state HTTP/1.1\r\n" + host + "Content-Length: 9\r\n\r\n{}",
        "GET / HTTP/1.1\r\n" + host + "X: " + std::string(20'000, 'x'),
        std::string("\0\xff\r\n\r\n\n\n", 8),
        "GET /metrics HTTP/1.1\r\nHost: evil.example\r\n\r\n"};
    std::vector<std::unique_ptr<HttpClient>> clients(1000);
    while (!stop_) {
      for (std::size_t i = 0; i < clients.size() && !stop_; ++i) {
        if (clients[i] && !clients[i]->closed_now()) continue;
        clients[i] = std::make_unique<HttpClient>(port);
        clients[i]->send(all[i % std::size(all)]);
      }
      ++rounds_;
    }
  }

  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> rounds_{0};
  std::thread thread_;
};

/// Telegrams without a reply that no newer one's followed within two cycles, as where the machine
/// stood still. What sweepd sees is shorter by the ways there and back.
std::ptrdiff_t overdue(const std::vector<Streamer::Sent>& sent) {
  std::ptrdiff_t count = 0;
  std::optional<Streamer::Clock::time_point> next_reply;
  for (auto one = sent.rbegin(); one != sent.rend(); ++one) {
    if (one->answered_after)
      next_reply = one->at + *one->answered_after;
    else if (!next_reply || *next_reply - one->at > 2 * Streamer::Options{}.cycle)
      ++count;
  }
  return count;
}

}  // namespace

TEST_CASE("the pages tell of a stream as it was, whatever other clients do meanwhile",
          "[endpoint]") {
  ServedDaemon sweepd;
  CHECK(eventually([&] { return sweepd.get("/readyz").status == 200; }));
  CHECK(sweepd.get("/healthz").body == "ok\n");
  CHECK(sweepd.get("/api/result").status == 404);
  CHECK(sweepd.metric("sweepd_streaming") == 0);

  allow_many_files();
  Streamer streamer(sweepd.daemon.port(), {});
  {
    const Nuisance nuisance(sweepd.pages);
    CHECK(eventually([&] { return nuisance.rounds() >= 2; }));
    CHECK(eventually([&] { return sweepd.metric("sweepd_streaming") == 1; }));
    CHECK(eventually([&] {
      return sweepd.metric_if_any("sweepd_sweeps_total", ",joint=\"1\",usable=\"true\"") >= 2.0;
    }));
    const auto state = Json::parse(sweepd.get("/api/state").body)["robots"][0];
    CHECK(state["robot"] == "kr5-arc");
    CHECK(state["stream"]["controller"] == "127.0.0.1");
    CHECK(state["stream"]["cycle_ms"] == 4);
    CHECK(sweepd.get("/healthz").body == "ok\n");
    CHECK(sweepd.get("/readyz").status == 200);
  }
  const auto sent = streamer.stop();
  const auto unanswered = static_cast<double>(
      std::count_if(sent.begin(), sent.end(), [](auto& one) { return !one.answered_after; }));
  CHECK(sweepd.said("; see "));  // where the report is
  CHECK(eventually([&] { return sweepd.metric("sweepd_streaming") == 0; }));

  // Each telegram was answered, itself or by the answer to a newer one that waited behind it.
  const auto answered = [&](const std::string& outcome) {
    return sweepd.metric("sweepd_telegrams_answered_total", ",outcome=\"" + outcome + "\"");
  };
  const auto telegrams = static_cast<double>(sent.size());
  CHECK(sweepd.metric("sweepd_telegrams_total") == telegrams);
  CHECK(sweepd.metric("sweepd_telegrams_lost_total") == 0);
  CHECK(sweepd.metric("sweepd_telegrams_malformed_total") == 0);
  CHECK(sweepd.metric("sweepd_replies_total") == telegrams - unanswered);
  CHECK(answered("superseded") + answered("unanswered") == unanswered);
  CHECK(answered("unanswered") <= static_cast<double>(overdue(sent)));
  CHECK(answered("in_time") + answered("late") == telegrams - unanswered);
  // A pause of the whole machine looks like a step of the clock, which leaves one reply untimed.
  const auto timed = sweepd.metric("sweepd_reply_latency_seconds_count");
  CHECK(timed <= telegrams - unanswered);
  CHECK(timed >= telegrams - unanswered - sweepd.metric("sweepd_clock_steps_total"));
  CHECK(sweepd.metric("sweepd_reply_latency_seconds_bucket", ",le=\"+Inf\"") == timed);
  CHECK(eventually([&] {
    return sweepd.metric("sweepd_recorded_datagrams_total") == 2 * telegrams - unanswered;
  }));
  CHECK(sweepd.metric("sweepd_recording_bytes_total") > 0);

  const auto result = sweepd.get("/api/result");
  CHECK(result.status == 200);
  CHECK(result.body == content(sweepd.daemon.session() / "result.json"));
  CHECK(sweepd.get("/api/result?robot=kr5-arc").body == result.body);
  const auto robot = Json::parse(sweepd.get("/api/state").body)["robots"][0];
  CHECK(robot["stream"].is_null());
  CHECK(robot["result"]["session"] == sweepd.daemon.session().filename().string());
  CHECK(robot["result"]["interim"] == false);

  sweepd.daemon.process().signal(SIGTERM);
  CHECK(sweepd.daemon.process().wait() == 0);
}

TEST_CASE("totals go on from one stream to the next", "[endpoint]") {
  ServedDaemon sweepd;
  double telegrams = 0;
  for (int session = 1; session <= 2; ++session) {
    Streamer streamer(sweepd.daemon.port(), {});
    CHECK(eventually([&] { return streamer.sent().size() > 50; }));
    telegrams += static_cast<double>(streamer.stop().size());
    CHECK(eventually([&] {
      return sweepd.metric("sweepd_streaming") == 0 &&
             sweepd.metric("sweepd_sessions_total") == session;
    }));
    CHECK(sweepd.metric("sweepd_telegrams_total") == telegrams);
  }
}

TEST_CASE("a robot is served though the port of the pages is taken, and they come once it is free",
          "[endpoint]") {
  boost::asio::io_context context;
  boost::asio::ip::tcp::acceptor taken(context, {boost::asio::ip::address_v4::loopback(), 0});
  ::fcntl(taken.native_handle(), F_SETFD, FD_CLOEXEC);  // sweepd would keep it taken itself
  const auto number = taken.local_endpoint().port();
  const auto port = std::to_string(number);
  const TemporaryFolder folder;
  Daemon daemon(folder.path(), {"", {}, "127.0.0.1:" + port});
  CHECK_THAT(daemon.process().errors(),
             ContainsSubstring("cannot serve pages on 127.0.0.1:" + port) &&
                 ContainsSubstring("choose another port with `listen` of [http], or \"off\""));
  Streamer streamer(daemon.port(), {});
  CHECK(eventually([&] {
    const auto sent = streamer.sent();
    return std::any_of(sent.begin(), sent.end(), [](auto& one) { return one.answered_after; });
  }));
  streamer.stop();
  taken.close();
  CHECK(eventually([&] {
    return daemon.process().errors().find("pages on http://127.0.0.1:" + port) != std::string::npos;
  }));
  CHECK(HttpClient(number).get("/healthz").status == 200);
  daemon.process().signal(SIGTERM);
  CHECK(daemon.process().wait() == 0);
}

TEST_CASE("SIGHUP says that other pages need a restart", "[endpoint]") {
  ServedDaemon sweepd;
  auto settings = content(sweepd.daemon.config());
  std::ofstream(sweepd.daemon.config()) << "[http]\nlisten = \"off\"\n"
                                        << settings.substr(settings.find("[[robot]]"));
  sweepd.daemon.process().signal(SIGHUP);
  CHECK(sweepd.said("only a restart of sweepd takes over http.listen"));
  CHECK(sweepd.get("/healthz").status == 200);
}
