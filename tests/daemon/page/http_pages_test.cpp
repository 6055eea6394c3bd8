#include "daemon/page/http_pages.hpp"

#include <tuple>

#include <nlohmann/json.hpp>

#include "tests/catch.hpp"
#include "tests/daemon/robot_states.hpp"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using Json = nlohmann::json;
using sweepd::HttpRequest;
using sweepd::HttpResponse;
using sweepd::ServiceStatus;
using namespace std::chrono_literals;

namespace {

/// A service with one robot, or several, that is looked after in this second.
struct Service {
  sweepd::HttpPages::Clock::time_point now{1h};
  ServiceStatus status{ServiceStatus::Phase::serving, {}, {}, now};
  sweepd::Published<ServiceStatus> published;
  sweepd::HttpPages pages{published,
                          {rsi::Endpoint{0xc0a80105, 19152}, {{"cell-pc", "10.0.0.5"}}},
                          [this] { return now; }};

  explicit Service(std::vector<std::string> names = {"kr5-arc"}) {
    for (const auto& name : names) {
      const auto robot = std::make_shared<sweepd::RobotStatus>();
      robot->state.publish(sweepd::test::busy_robot(name));
      robot->result.publish(sweepd::test::one_result());
      status.robots.push_back(robot);
    }
    published.publish(status);
  }
  HttpResponse get(std::string_view target) const {
    return pages.answer({"GET", target, {"localhost:19152"}, {}, false});
  }
  int named(std::string_view host) const {
    return pages.answer({"GET", "/healthz", {host}, {}, false}).status;
  }
  int from(std::string_view origin, std::string_view host = "localhost:19152") const {
    return pages.answer({"GET", "/healthz", {host}, {origin}, false}).status;
  }
};

}  // namespace

TEST_CASE("every page has its type, and / lists them all", "[http_pages]") {
  const Service service;
  const auto index = service.get("/");
  CHECK(index.status == 200);
  for (const std::string path :
       {"/healthz", "/readyz", "/metrics", "/api/state", "/api/result", "/api/live"}) {
    CHECK(service.get(path).status == 200);
    CHECK_THAT(index.body, ContainsSubstring(path));
  }
  CHECK(service.get("/healthz").body == "ok\n");
  CHECK(service.get("/readyz").body == "ready\n");
  CHECK(service.get("/metrics").type == "text/plain; version=0.0.4; charset=utf-8");
  CHECK_THAT(service.get("/metrics?name=x").body,
             ContainsSubstring("sweepd_telegrams_total{robot=\"kr5-arc\"} 1010\n"));
  CHECK(service.get("/api/state").type == "application/json");
  for (const std::string path : {"/metric", "/metrics/", "//", "/../etc/passwd", "*", "x", ""})
    CHECK(service.get(path).status == 404);
}

TEST_CASE("a browser gets the page, and curl the list", "[http_pages]") {
  const Service service;
  const auto kind = [&](const std::vector<std::string_view>& accepts) {
    const auto type = service.pages.answer({"GET", "/", {"localhost"}, {}, false, accepts}).type;
    return std::string(type.substr(0, type.find(';')));
  };
  for (const auto* browser :
       {"text/html", "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8",
        "application/xml , Text/HTML;q=0.9"})
    CHECK(kind({browser}) == "text/html");
  for (const auto* other : {"*/*", "", "text/plain", "application/json", "text/htmlx", "text/*"})
    CHECK(kind({other}) == "text/plain");
  CHECK(kind({}) == "text/plain");
  CHECK(kind({"application/json", "text/html"}) == "text/html");
  SECTION("only the page / has both") {
    const auto health =
        service.pages.answer({"GET", "/healthz", {"localhost"}, {}, false, {"text/html"}});
    CHECK(health.body == "ok\n");
  }
}

TEST_CASE("files of the page have their types, and no others are there", "[http_pages]") {
  const Service service;
  const auto page = service.get("/assets/index.html");
  CHECK(page.status == 200);
  CHECK(page.type == "text/html; charset=utf-8");
  CHECK(page.cache == "no-cache");
  CHECK(service.get("/assets/page.js").type == "text/javascript; charset=utf-8");
  CHECK(service.get("/assets/page.css").type == "text/css; charset=utf-8");
  CHECK(service.get("/assets/uplot/uPlot.iife.min.js").status == 200);
  for (const auto* none : {"/assets", "/assets/", "/assets/../sweepd.toml", "/assets/page.js/",
                           "/assets/uplot/LICENSE", "/ASSETS/page.js", "/page.js"})
    CHECK(service.get(none).status == 404);
}

TEST_CASE("the live stream is of a robot that is there", "[http_pages]") {
  Service service({"a", "b"});
  service.status.not_served = {{"far", "its port is taken"}};
  service.published.publish(service.status);
  const auto live = service.get("/api/live?robot=b");
  CHECK(live.status == 200);
  CHECK(live.type == "text/event-stream");
  REQUIRE(live.more);
  CHECK_THAT(*live.more(), ContainsSubstring("\"robot\":\"b\""));
  for (const auto& [target, status, words] : std::vector<std::tuple<std::string, int, std::string>>{
           {"/api/live", 400, "which robot? add ?robot=NAME with one of: a b\n"},
           {"/api/live?robot=c", 404, "there is no such robot: ?robot=NAME takes one of: a b\n"},
           {"/api/live?robot=<script>", 404,
            "there is no such robot: ?robot=NAME takes one of: a b\n"},
           {"/api/live?robot=far", 404, "far: not served: its port is taken\n"},
           {"/api/live?name=a", 400, "expected ?robot=NAME\n"}}) {
    const auto answer = service.get(target);
    CHECK(answer.status == status);
    CHECK(answer.body == words);
    CHECK_FALSE(answer.more);
  }
  CHECK(Service(std::vector<std::string>{}).get("/api/live").body == "no robot is served\n");
}

TEST_CASE("host, origin and method count for all pages", "[http_pages]") {
  const Service service;
  const auto status = [&](const HttpRequest& request) {
    const auto answer = service.pages.answer(request);
    CHECK_FALSE(answer.more);
    return answer.status;
  };
  for (const auto* target : {"/", "/assets/page.js", "/api/live", "/api/live?robot=kr5-arc"}) {
    INFO(target);
    CHECK(status({"GET", target, {"evil.example"}, {}, false}) == 421);
    CHECK(status({"GET", target, {}, {}, false}) == 400);
    CHECK(status({"GET", target, {"localhost"}, {"http://evil.example"}, false}) == 403);
    CHECK(status({"GET", target, {"localhost"}, {"null"}, false}) == 403);
    CHECK(status({"POST", target, {"localhost"}, {}, false}) == 405);
    CHECK(status({"GET", target, {"localhost"}, {}, true}) == 413);
  }
}

TEST_CASE("only what reads is answered, without a body", "[http_pages]") {
  const Service service;
  for (const auto* method : {"POST", "PUT", "DELETE", "OPTIONS", "get", "CONNECT", ""})
    CHECK(service.pages.answer({method, "/healthz", {"localhost"}, {}, false}).status == 405);
  CHECK(service.pages.answer({"HEAD", "/healthz", {"localhost"}, {}, false}).status == 200);
  CHECK(service.pages.answer({"GET", "/healthz", {"localhost"}, {}, true}).status == 413);
}

TEST_CASE("a request names this machine by one of its names", "[http_pages]") {
  const Service service;
  for (const auto* right : {"localhost", "LocalHost:19152", "127.0.0.1:1", "[::1]:19152", "[::1]",
                            "192.168.1.5:19152", "cell-pc", "CELL-PC:80", "10.0.0.5"})
    CHECK(service.named(right) == 200);
  for (const auto* wrong : {"evil.example", "evil.example:19152", "192.168.1.50", "localhost.evil",
                            "", ":19152", "[::1", "]", "0.0.0.0", "user@localhost"})
    CHECK(service.named(wrong) == 421);
  CHECK(service.pages.answer({"GET", "/", {}, {}, false}).status == 400);
  CHECK(service.pages.answer({"GET", "/", {"localhost", "localhost"}, {}, false}).status == 400);
  SECTION("also in the target, where that names a host") {
    CHECK(service.get("http://cell-pc:19152/healthz").body == "ok\n");
    CHECK(service.get("HTTP://localhost").status == 200);
    CHECK(service.get("http://evil.example/healthz").status == 421);
    CHECK(service.get("https://localhost/healthz").status == 404);
  }
}

TEST_CASE("scripts of other pages are refused by their origin", "[http_pages]") {
  const Service service;
  CHECK(service.from("http://localhost:19152") == 200);
  CHECK(service.from("https://cell-pc", "cell-pc") == 200);
  for (const auto* wrong : {"http://evil.example", "http://localhost", "http://localhost:8080",
                            "http://cell-pc:19152", "null", "", "localhost:19152"})
    CHECK(service.from(wrong) == 403);
  const std::vector<std::string_view> both{"http://localhost", "http://evil.example"};
  CHECK(service.pages.answer({"GET", "/", {"localhost"}, both, false}).status == 403);
}

TEST_CASE("health names what stands still, and whether anybody still looks", "[http_pages]") {
  Service service;
  service.status.standstills = {"kr5-arc: the reply thread has stood still for 5 s"};
  service.published.publish(service.status);
  CHECK(service.get("/healthz").status == 503);
  CHECK(service.get("/healthz").body == service.status.standstills[0] + "\n");

  service.status.standstills.clear();
  service.published.publish(service.status);
  service.now += 9s;
  CHECK(service.get("/healthz").status == 200);
  service.now += 3s;
  CHECK(service.get("/healthz").status == 503);
  CHECK(service.get("/healthz").body == "sweepd: the main thread has not looked for 12 s\n");
  SECTION("at the end nobody has to") {
    service.status.phase = ServiceStatus::Phase::stopping;
    service.published.publish(service.status);
    CHECK(service.get("/healthz").status == 200);
  }
}

TEST_CASE("it is ready only between start and stop", "[http_pages]") {
  Service service;
  for (const auto phase : {ServiceStatus::Phase::starting, ServiceStatus::Phase::stopping}) {
    service.status.phase = phase;
    service.published.publish(service.status);
    CHECK(service.get("/readyz").status == 503);
    CHECK_THAT(service.get("/metrics").body, ContainsSubstring("\nsweepd_ready 0\n"));
  }
}

TEST_CASE("it is not ready while a robot is not served, and says which and why",
          "[http_pages][issue11][point_7]") {
  Service service;
  service.status.not_served = {{"far", "cannot listen on UDP 10.0.0.7:49152"}};
  service.published.publish(service.status);
  CHECK(service.get("/readyz").status == 503);
  CHECK(service.get("/readyz").body == "far: not served: cannot listen on UDP 10.0.0.7:49152\n");
  CHECK(service.get("/healthz").status == 200);
  const auto state = Json::parse(service.get("/api/state").body);
  REQUIRE(state["not_served"].size() == 1);
  CHECK(state["not_served"][0]["robot"] == "far");
  CHECK(state["not_served"][0]["reason"] == "cannot listen on UDP 10.0.0.7:49152");
  CHECK(state["robots"].size() == 1);

  service.status.not_served.clear();
  service.published.publish(service.status);
  CHECK(service.get("/readyz").body == "ready\n");
  CHECK(Json::parse(service.get("/api/state").body)["not_served"].empty());
}

TEST_CASE("a result is what result.json holds, or the reason why there is none", "[http_pages]") {
  const Service service;
  CHECK(service.get("/api/result").body == "{\"schema\": \"sweepd.result/1\"}\n");
  CHECK(service.get("/api/result").type == "application/json");
  CHECK(service.get("/api/result?robot=kr5-arc").status == 200);
  CHECK(service.get("/api/result?robot=other").status == 404);
  CHECK_THAT(service.get("/api/result?robot=other").body, ContainsSubstring("one of: kr5-arc"));
  CHECK(service.get("/api/result?name=kr5-arc").status == 400);

  const Service none(std::vector<std::string>{});
  CHECK(none.get("/api/result").status == 404);

  const Service two({"a", "b"});
  CHECK(two.get("/api/result").status == 400);
  CHECK_THAT(two.get("/api/result").body, ContainsSubstring("one of: a b"));
  CHECK(two.get("/api/result?robot=b").status == 200);

  const auto fresh = std::make_shared<sweepd::RobotStatus>();
  fresh->state.publish(sweepd::test::busy_robot("c"));
  Service later;
  later.status.robots = {fresh};
  later.published.publish(later.status);
  CHECK(later.get("/api/result").status == 404);
  CHECK_THAT(later.get("/api/result").body, StartsWith("c: no result yet"));
}

TEST_CASE("the state of each robot is told in JSON", "[http_pages]") {
  const Service service;
  const auto json = Json::parse(service.get("/api/state").body);
  CHECK(json["schema"] == "sweepd.state/1");
  CHECK(json["phase"] == "serving");
  CHECK(json["standstills"].empty());
  REQUIRE(json["robots"].size() == 1);
  const auto& robot = json["robots"][0];
  CHECK(robot["robot"] == "kr5-arc");
  CHECK(robot["listen"] == "127.0.0.1:49152");
  CHECK(robot["transport"] == "UDP");
  CHECK(robot["stream"]["controller"] == "192.168.1.20");
  CHECK(robot["stream"]["cycle_ms"] == 4);
  CHECK(robot["replies"]["missed_by_controller"].is_null());  // no Delay came
  CHECK(robot["stream"]["since"] == "2025-01-01T00:00:00.000Z");
  CHECK(robot["link"] == Json{{"verdict", "bad"}, {"reason", "the cable was out"}});
  CHECK(robot["telegrams"]["received"] == 1010);
  CHECK(robot["replies"]["late"] == 1);
  CHECK(robot["replies"]["not_begun"] == 5);
  CHECK(robot["recording"]["missed"]["disk"]["datagrams"] == 4);
  CHECK(robot["sweeps"][0] == Json{{"joint", 1}, {"usable", 2}, {"not_usable", 1}});
  CHECK(robot["identifications"]["partial"] == 2);
  CHECK(robot["identifications"]["doubtful"] == 3);
  CHECK(robot["result"]["status"] == "complete");
  CHECK(robot["result"]["took_ms"] == 250);
  SECTION("null where there is neither a stream nor a result") {
    Service idle;
    const auto fresh = std::make_shared<sweepd::RobotStatus>();
    idle.status.robots = {fresh};
    idle.published.publish(idle.status);
    const auto state = Json::parse(idle.get("/api/state").body);
    CHECK(state["robots"][0]["stream"].is_null());
    CHECK(state["robots"][0]["link"].is_null());
    CHECK(state["robots"][0]["result"].is_null());
  }
}
