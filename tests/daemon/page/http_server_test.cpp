#include "daemon/page/http_server.hpp"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "tests/catch.hpp"
#include "tests/daemon/http_client.hpp"
#include "tests/eventually.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::HttpServer;
using sweepd::test::HttpClient;
using namespace std::chrono_literals;
using sweepd::test::eventually;

namespace {

constexpr rsi::Endpoint kAnyPort{0x7f000001, 0};

/// The real pages of a service without a robot, and two of this test's own.
struct PagesServer {
  mutable std::atomic<int> viewers{0};
  std::atomic<int> talks{1};  ///< blanks an event
  std::atomic<bool> ended{false};
  sweepd::Published<sweepd::ServiceStatus> status;
  sweepd::HttpPages pages{status, {}};
  HttpServer server;

  explicit PagesServer(const HttpServer::Limits& limits = {})
      : server(
            kAnyPort, [this](const auto& request) { return answer(request); }, limits) {}
  sweepd::HttpResponse answer(const sweepd::HttpRequest& request) const {
    if (request.target == "/broken") throw std::runtime_error("broken");
    if (request.target == "/live") return live();
    if (request.target == "/large") return {200, "text/plain", std::string(64 << 20, 'x')};
    return pages.answer(request);
  }
  /// "data: 1", "data: 2", … while `talks`.
  [[nodiscard]] sweepd::HttpResponse live() const {
    sweepd::HttpResponse response{200, "text/event-stream", {}};
    response.more = [this, count = 0, viewer = std::make_shared<Viewing>(viewers)]() mutable {
      if (ended) return std::optional<std::string>();
      const auto times = static_cast<std::size_t>(talks);
      return std::optional(times == 0 ? std::string()
                                      : "data: " + std::to_string(++count) +
                                            std::string(times, ' ') + "\n\n");
    };
    return response;
  }
  struct Viewing {
    explicit Viewing(std::atomic<int>& all) : viewers(all) { ++viewers; }
    ~Viewing() { --viewers; }
    Viewing(const Viewing&) = delete;
    Viewing& operator=(const Viewing&) = delete;
    std::atomic<int>& viewers;
  };
  [[nodiscard]] std::uint16_t port() const { return server.local().port; }
  [[nodiscard]] bool answers() const { return HttpClient(port()).get("/healthz").body == "ok\n"; }
};

/// Long enough for a busy machine to go from one line of a test to the next.
HttpServer::Limits impatient() {
  HttpServer::Limits limits;
  limits.request = 1s;
  limits.idle = 1s;
  return limits;
}

auto open_files() {
  const std::filesystem::directory_iterator files("/proc/self/fd");
  return std::distance(begin(files), end(files));
}

}  // namespace

TEST_CASE("one connection takes many requests, also ahead of the answers", "[http_server]") {
  const PagesServer server;
  HttpClient client(server.port());
  const auto first = client.get("/healthz");
  CHECK(first.status == 200);
  CHECK(first.body == "ok\n");
  CHECK_THAT(first.head, ContainsSubstring("Content-Type: text/plain"));
  CHECK_THAT(first.head, ContainsSubstring("X-Content-Type-Options: nosniff"));
  CHECK_THAT(first.head, ContainsSubstring("Cache-Control: no-store"));
  CHECK_THAT(first.head, !ContainsSubstring("Access-Control"));
  CHECK_THAT(first.head, !ContainsSubstring("Connection: close"));
  const std::string request = "GET /nothing HTTP/1.1\r\nHost: localhost\r\n\r\n";
  client.send(request + request + "HEAD /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n" + request);
  CHECK(client.answer().status == 404);
  CHECK(client.answer().status == 404);
  const auto head = client.answer(true);
  CHECK(head.status == 200);
  CHECK_THAT(head.head, ContainsSubstring("Content-Length: 3\r\n"));
  CHECK(client.answer().status == 404);
}

TEST_CASE("a connection ends where the client asks for it, or after its last request",
          "[http_server]") {
  HttpServer::Limits limits;
  limits.requests = 3;
  const PagesServer server(limits);
  HttpClient client(server.port());
  CHECK_THAT(client.get("/").head, !ContainsSubstring("Connection: close"));
  CHECK(client.get("/").status == 200);
  CHECK_THAT(client.get("/").head, ContainsSubstring("Connection: close"));
  CHECK(client.closed());
  HttpClient one(server.port());
  CHECK(one.get("/", "Host: localhost\r\nConnection: close\r\n").status == 200);
  CHECK(one.closed());
  HttpClient old(server.port());
  old.send("GET / HTTP/1.0\r\nHost: localhost\r\n\r\n");
  CHECK(old.answer().status == 200);
  CHECK(old.closed());
}

TEST_CASE("wrong hosts and origins, methods and bodies are refused", "[http_server]") {
  const PagesServer server;
  HttpClient client(server.port());
  CHECK(client.get("/", "Host: evil.example\r\n").status == 421);
  CHECK(client.get("/", "").status == 400);
  CHECK(client.get("/", "Host: localhost\r\nOrigin: http://evil.example\r\n").status == 403);
  CHECK(client.get("/", "Host: localhost\r\nHost: localhost\r\n").status == 400);
  client.send("DELETE / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const auto refused = client.answer();
  CHECK(refused.status == 405);
  CHECK_THAT(refused.head, ContainsSubstring("Allow: GET, HEAD\r\n"));
  SECTION("a body is not read, but the answer arrives") {
    client.send("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 60000\r\n\r\n" +
                std::string(60'000, 'x'));
    CHECK(client.answer().status == 405);
    CHECK(client.closed());
  }
  SECTION("nor one that GET brings") {
    client.send("GET / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n1\r\n");
    CHECK(client.answer().status == 413);
    CHECK(client.closed());
  }
  CHECK(server.answers());
}

TEST_CASE("what is too large or no HTTP gets an answer that says so, and the connection ends",
          "[http_server]") {
  const PagesServer server;
  const std::string large(9000, 'x');
  for (const auto& [request, status] : std::vector<std::pair<std::string, int>>{
           {"GET /" + large + " HTTP/1.1\r\nHost: localhost\r\n\r\n", 431},
           {"GET / HTTP/1.1\r\nHost: localhost\r\nCookie: " + large + "\r\n\r\n", 431},
           {"\x16\x03\x01\x02 TLS\r\n\r\n", 400},
           {"GET / SOMETHING/1.1\r\n\r\n", 400},
           {"GET / HTTP/1.1\r\nHost localhost\r\n\r\n", 400},
           {"GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: -1\r\n\r\n", 400},
           {large, 431}}) {
    INFO(request.substr(0, 60));
    HttpClient client(server.port());
    client.send(request);
    CHECK(client.answer().status == status);
    CHECK(client.closed());
  }
  CHECK(server.answers());
}

TEST_CASE("a client that is too slow is let go, whichever way it is slow", "[http_server]") {
  const PagesServer server(impatient());
  SECTION("it says nothing") {
    CHECK(HttpClient(server.port()).closed());
  }
  SECTION("it never ends its request, however busy it looks") {
    HttpClient client(server.port());
    client.send("GET / HTTP/1.1\r\n");
    CHECK(eventually([&] { return !client.send("X: y\r\n") || client.closed_now(); }));
  }
  SECTION("it says nothing after its first request") {
    HttpClient client(server.port());
    CHECK(client.get("/").status == 200);
    CHECK(client.closed());
  }
  SECTION("it does not take its answer") {
    HttpClient client(server.port());
    CHECK(client.get("/").status == 200);
    const auto files = open_files();
    client.send("GET /large HTTP/1.1\r\nHost: localhost\r\n\r\n");
    CHECK(eventually([&] { return open_files() == files - 1; }));
    const auto answer = client.answer();
    CHECK(answer.status == 200);
    CHECK(answer.body.size() < (64 << 20));
  }
  CHECK(server.answers());
}

TEST_CASE("of a thousand connections that hang, few are kept, and the page is served all the time",
          "[http_server]") {
  constexpr std::size_t kClients = 1000;
  sweepd::test::allow_many_files();
  const PagesServer server;
  std::vector<std::unique_ptr<HttpClient>> clients;
  for (std::size_t i = 0; i < kClients; ++i) {
    clients.push_back(std::make_unique<HttpClient>(server.port()));
    clients.back()->send(i % 2 == 0 ? "GET /metr" : "");
    if (i % 100 == 99) CHECK(server.answers());
  }
  CHECK(eventually([&] {
    return std::count_if(clients.begin(), clients.end(), [](auto& client) {
             return client->closed_now();
           }) >= static_cast<std::ptrdiff_t>(kClients - HttpServer::Limits{}.connections);
  }));
  CHECK(server.answers());
}

TEST_CASE("a page that cannot be made is an answer too", "[http_server]") {
  const PagesServer server;
  HttpClient client(server.port());
  CHECK(client.get("/broken").status == 500);
  CHECK(client.get("/").status == 200);
}

TEST_CASE("a port that is taken is named, with what to do", "[http_server]") {
  const PagesServer server;
  CHECK_THROWS_WITH(
      HttpServer(server.server.local(), [](const auto&) { return sweepd::HttpResponse{}; }),
      ContainsSubstring("cannot serve pages on 127.0.0.1:") &&
          ContainsSubstring("choose another port"));
}

TEST_CASE("when the server ends, so do its connections, and its port is free again",
          "[http_server]") {
  auto server = std::make_unique<PagesServer>();
  HttpClient client(server->port());
  CHECK(client.get("/").status == 200);
  const auto local = server->server.local();
  server.reset();
  CHECK(client.closed());
  CHECK_NOTHROW(HttpServer(local, [](const auto&) { return sweepd::HttpResponse{}; }));
}

TEST_CASE("an answer that goes on comes bit by bit, with the policy of all pages",
          "[http_server]") {
  HttpServer::Limits limits;
  limits.pace = 1ms;
  PagesServer server(limits);
  HttpClient viewer(server.port());
  const auto head = viewer.get("/live");
  CHECK(head.status == 200);
  CHECK_THAT(head.head, ContainsSubstring("Content-Type: text/event-stream\r\n") &&
                            ContainsSubstring("Cache-Control: no-store\r\n") &&
                            ContainsSubstring("Connection: close\r\n") &&
                            ContainsSubstring("Content-Security-Policy: default-src 'none'; "
                                              "script-src 'self'; style-src 'self'; connect-src "
                                              "'self'; img-src 'self'; ") &&
                            !ContainsSubstring("Content-Length") && !ContainsSubstring("unsafe"));
  CHECK(viewer.until("\n\n") == "data: 1 \n\n");
  CHECK(viewer.until("\n\n") == "data: 2 \n\n");
  CHECK(server.answers());
  SECTION("until it ends by itself") {
    server.ended = true;
    CHECK(viewer.closed());
  }
  SECTION("to HEAD only its head") {
    HttpClient other(server.port());
    other.send("HEAD /live HTTP/1.1\r\nHost: localhost\r\n\r\n");
    CHECK(other.answer(true).status == 200);
    CHECK(other.closed());
  }
  CHECK(eventually([&] { return server.viewers <= 1; }));
}

TEST_CASE("a viewer more than there may be is told so, and others are served", "[http_server]") {
  HttpServer::Limits limits;
  limits.pace = 1ms;
  limits.connections = 2;
  PagesServer server(limits);
  std::vector<std::unique_ptr<HttpClient>> viewers;
  for (std::size_t i = 0; i < limits.viewers; ++i) {
    viewers.push_back(std::make_unique<HttpClient>(server.port()));
    CHECK(viewers.back()->get("/live").status == 200);
  }
  HttpClient ninth(server.port());
  const auto refused = ninth.get("/live");
  CHECK(refused.status == 503);
  CHECK(refused.body == "8 viewers look already: close one of their pages, or come back later\n");
  // The connections of the others are no viewers', who lose none by them.
  for (int i = 0; i < 10; ++i) CHECK(server.answers());
  for (auto& viewer : viewers) CHECK_THAT(viewer->until("\n\n"), ContainsSubstring("data: "));
  viewers.pop_back();
  CHECK(eventually([&] { return HttpClient(server.port()).get("/live").status == 200; }));
}

TEST_CASE("a viewer that never reads is let go, and keeps nobody else waiting", "[http_server]") {
  auto limits = impatient();
  limits.pace = 1ms;
  PagesServer server(limits);
  server.talks = 100'000;
  HttpClient reads(server.port()), never(server.port());
  CHECK(reads.get("/live").status == 200);
  never.send("GET /live HTTP/1.1\r\nHost: localhost\r\n\r\n");
  CHECK(eventually([&] { return server.viewers == 2; }));
  CHECK(eventually([&] {
    reads.until("\n\n");
    return server.viewers == 1;
  }));
  CHECK_THAT(reads.until("\n\n"), ContainsSubstring("data: "));
  CHECK(server.answers());
}

TEST_CASE("a viewer hears something even where nothing happens", "[http_server]") {
  HttpServer::Limits limits;
  limits.pace = 1ms;
  limits.heartbeat = 10ms;
  PagesServer server(limits);
  server.talks = 0;
  HttpClient viewer(server.port());
  CHECK(viewer.get("/live").status == 200);
  CHECK(viewer.until("\n\n") == ":\n\n");
}

TEST_CASE("when the server ends, so do its viewers", "[http_server]") {
  auto server = std::make_unique<PagesServer>();
  HttpClient viewer(server->port());
  CHECK(viewer.get("/live").status == 200);
  server.reset();
  CHECK(viewer.closed());
}
