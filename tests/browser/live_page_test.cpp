#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <iostream>

#include "daemon/page/http_server.hpp"
#include "tests/browser/browser.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/http_client.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using Json = nlohmann::json;

namespace {

const std::filesystem::path kScreenshots = SWEEPD_SCREENSHOTS;

/// False, and said, where there is no browser.
bool browser_is_here() {
  if (Browser::is_here()) return true;
  std::cout << "not available here: chromium and chromedriver\n";
  return false;
}

struct ServedPage {
  TemporaryFolder folder;
  std::uint16_t port = free_tcp_port();
  Daemon daemon{folder.path(), {"silence_ms = 400\n", {}, "127.0.0.1:" + std::to_string(port)}};
  Browser browser;

  [[nodiscard]] std::string address() const { return "http://127.0.0.1:" + std::to_string(port); }
  /// A simulated controller that runs the short plan, or the one that SWEEPD_PLAN names.
  [[nodiscard]] std::unique_ptr<SweepdProcess> controller() const {
    const char* given = std::getenv("SWEEPD_PLAN");
    return std::make_unique<SweepdProcess>(std::vector<std::string>{
        "simulate", "--robot", (kConfig / "robots/kr5_arc.toml").string(), "--plan",
        given != nullptr ? given : write_short_plan(folder).string(), "--to", daemon.address(),
        "--check", "sweepd", "--timeout-cycles", "2500"});
  }
  /// The page at both sizes in both schemes.
  void look(const std::string& moment) {
    for (const bool phone : {false, true})
      for (const bool dark : {false, true}) {
        browser.size(phone ? 360 : 1024, phone ? 740 : 600, phone);
        browser.scheme(dark);
        CHECK(browser.becomes("document.documentElement.scrollWidth <= innerWidth"));
        browser.run("scrollTo(0, 0)");
        browser.run_later("const [done] = arguments; setTimeout(done, 100)");  // it is drawn anew
        const auto name = moment + (phone ? "_360" : "_1024") + (dark ? "_dark" : "_light");
        for (const bool whole : {false, true})
          browser.screenshot(kScreenshots / (name + (whole ? "_whole.png" : ".png")), whole);
      }
    browser.size(1024, 600, false);
    browser.scheme(false);
  }
  void check_quiet() {
    for (const auto& line : browser.console()) {
      INFO(line);
      CHECK(false);
    }
    const auto requested = browser.requested();
    CHECK_FALSE(requested.empty());
    for (const auto& url : requested) {
      if (url.starts_with("chrome") || url.starts_with("data:")) continue;  // the browser's own
      INFO(url);
      CHECK(url.starts_with(address() + "/"));
    }
  }
};

const std::string kStates =
    "[...document.querySelectorAll('.lanes .state')].map(cell => cell.dataset.state).join(' ')";

}  // namespace

TEST_CASE("all joints go from moving to used, and the table has the digits of result.json",
          "[live_page]") {
  if (!browser_is_here()) return;
  ServedPage page;
  auto& browser = page.browser;
  browser.size(1024, 600, false);
  browser.open(page.address() + "/");
  CHECK(browser.becomes("document.querySelector('a[href=\"/?robot=kr5-arc\"]')"));
  page.look("robots");
  browser.run("document.querySelector('a[href=\"/?robot=kr5-arc\"]').click()");
  CHECK(browser.becomes("document.getElementById('connection').dataset.state == 'live'"));
  CHECK(browser.text(kStates) == "still still still still still still");
  page.look("before");

  browser.run(
      "window.moved = new Set();"
      "new MutationObserver(changes => changes.forEach(({target}) => {"
      "  if (target.dataset.state == 'moving') moved.add(target.parentNode.dataset.joint);"
      "})).observe(document.querySelector('.lanes'), {subtree: true, attributes: true});");
  const auto controller = page.controller();
  CHECK(browser.becomes("moved.size >= 3", 60));
  page.look("meanwhile");
  CHECK(browser.becomes("moved.size == 6", 60));
  CHECK(controller->wait() != 1);
  CHECK(browser.becomes(kStates + " == 'used used used used used used'", 60));
  CHECK(browser.becomes("document.getElementById('result').textContent.startsWith('Last result')"));
  page.look("after");

  const auto link =
      nlohmann::json::parse(HttpClient(page.port).get("/api/state").body)["robots"][0]["link"];
  const std::string verdict = link["verdict"], reason = link["reason"];
  const auto shown_verdict = browser.text("document.getElementById('verdict').textContent");
  CHECK(shown_verdict.ends_with(verdict == "good" ? "" : verdict + ": " + reason + "."));
  CHECK(shown_verdict.empty() == (verdict == "good"));

  // As text: a number that JavaScript has read has lost its digits.
  const auto result = HttpClient(page.port).get("/api/result").body;
  CHECK(eventually([&] { return content(page.daemon.session() / "result.json") == result; }));
  const auto json = nlohmann::ordered_json::parse(result);
  std::size_t compared = 0;
  for (const std::string table : {"dh", "specified", "difference"})
    for (std::size_t row = 0; row < json[table].size(); ++row)
      for (const auto& [key, value] : json[table][row].items()) {
        const auto place = table + "/" + std::to_string(row) + "/" + key;
        const auto shown = browser.run("return document.querySelector('[data-number=\"" + place +
                                       "\"]')?.title || null");
        if (shown.is_null() || !value.is_number()) continue;
        INFO(place);
        CHECK(shown == value.dump());
        ++compared;
      }
  CHECK(compared > 80);
  for (std::size_t joint = 0; joint < 6; ++joint) {
    const auto range = browser.text("document.querySelectorAll('.lanes tbody tr')[" +
                                    std::to_string(joint) + "].cells[3].textContent");
    const auto& sweeps = json["joints"][joint]["sweeps"];
    CHECK(std::any_of(sweeps.begin(), sweeps.end(), [&](const auto& sweep) {
      return sweep["used"] == true && sweep["range_deg"].dump() + " °" == range;
    }));
  }

  SECTION("it turns by the keyboard") {
    const std::string picture = "document.querySelector('canvas.space').toDataURL()";
    const auto before = browser.text(picture);
    browser.run("document.querySelector('canvas.space').focus()");
    browser.key("ArrowLeft");
    CHECK(eventually([&] { return browser.text(picture) != before; }));
  }
  SECTION("time stands still on the plot of the link, which says so") {
    CHECK(browser.becomes(
        "document.querySelector('.few caption').textContent == 'The last 10 s of the "
        "stream'"));
  }
  SECTION("of a sweepd that starts anew nothing is told that was before") {
    page.daemon.process().signal(SIGTERM);
    CHECK(page.daemon.process().wait() == 0);
    CHECK(
        browser.becomes("document.getElementById('stream').textContent.startsWith('All this is as "
                        "sweepd last told it')"));
    page.daemon.start();
    CHECK(browser.becomes("document.getElementById('connection').textContent == 'live again'"));
    CHECK(
        browser.becomes("document.getElementById('stream').textContent == 'RSI does not stream "
                        "yet.'"));
    CHECK(browser.text("document.getElementById('result').textContent").starts_with("No result"));
    CHECK(browser.becomes("document.querySelector('[data-link=missed]').textContent == 'none'"));
    CHECK(browser.text("document.querySelector('.few caption').textContent") == "The last 10 s");
    browser.console();  // it has said that the connection was lost
  }
  SECTION("whoever comes later sees the same") {
    const auto states = browser.text(kStates);
    const auto table = browser.text("document.querySelector('.dh tbody').textContent");
    browser.open(page.address() + "/?robot=kr5-arc");
    CHECK(browser.becomes(kStates + " == '" + states + "'"));
    CHECK(browser.becomes("document.querySelector('.dh tbody').textContent.length > 100"));
    CHECK(browser.text("document.querySelector('.dh tbody').textContent") == table);
  }
  page.check_quiet();
}

namespace {

const std::string kEvil =
    "<script>document.title='x'</script>\"'\n<img src=x onerror=alert(1)> שלום";

/// A robot of twelve joints, one of them linear, that says what no robot says.
std::shared_ptr<sweepd::RobotStatus> odd_robot() {
  constexpr std::size_t kJoints = 12;
  const auto robot = std::make_shared<sweepd::RobotStatus>();
  sweepd::RobotFacts facts{4, {}, {}, {}};  // the result knows more
  robot->facts.publish(facts);
  sweepd::RobotState state;
  state.name = "odd";
  state.stream = {"20250101T000000Z", std::chrono::seconds(-1), 0, std::chrono::milliseconds(4)};
  state.sessions = 1;
  state.replies = true;
  state.link.in_time = 1000;
  state.link.missed_by_controller = 5;
  state.recording_paused = true;
  robot->state.publish(state);
  sweepd::LiveSlice slice;
  slice.session = 1;
  slice.joints = kJoints;
  Json joints = Json::array(), dh = Json::array();
  for (int i = 0; i < 600; ++i) {
    const std::size_t moving = static_cast<std::size_t>(i) / 50;
    ++slice.number;
    slice.at_s = 1e6 + 0.1 * i;
    slice.cycles = 25;
    slice.late = i % 97 == 0 ? 1 : 0;
    slice.latency_us = static_cast<float>(20 + i % 7);
    slice.latency_max_us = static_cast<float>(60 + i % 31);
    slice.jitter_us = static_cast<float>(200 + 3 * (i % 50));
    slice.count = 1;
    auto& point = slice.points[0];
    point.t_s = 0.1 * i;
    point.has_position = true;
    const auto turn = static_cast<float>(0.06 * i);
    point.position_mm = {900 * std::cos(turn), 900 * std::sin(turn), static_cast<float>(2 * i)};
    point.angles_deg[moving] += 1;
    std::vector<std::shared_ptr<const sweepd::LiveSweep>> sweeps;
    if (i % 50 == 49) {
      auto sweep = std::make_shared<sweepd::LiveSweep>();
      sweep->number = sweep->joint.emplace(moving + 1);
      sweep->session = 1;
      sweep->started = state.stream->session;
      sweep->start_s = (i - 45) / 10.0;  // few digits, as files have
      sweep->end_s = (i - 1) / 10.0;
      sweep->range = 44.5;
      sweep->linear = moving == 11;
      sweep->usable = moving != 7;
      sweep->direction = 1;
      sweep->words = kEvil;
      sweep->path = {point.position_mm, {0, 0, 500}};
      sweeps.push_back(sweep);
      joints.push_back({{"joint", moving + 1},
                        {"sweeps", {{{"start_s", sweep->start_s}, {"used", moving < 6}}}}});
      dh.push_back({{"joint", moving + 1}, {"b_mm", 1e-05 * i}, {"b_sigma_mm", nullptr}});
    }
    CHECK(robot->live.try_add(slice, sweeps));
  }
  sweepd::ResultState result;
  const Json warnings = {{{"code", "x"}, {"message", kEvil}}};
  const Json json = {{"reason", kEvil},  {"doubts", warnings}, {"warnings", warnings},
                     {"joints", joints}, {"dh", dh},           {"describes", "arm"}};
  result.newest = {identify::Status::doubtful,
                   true,
                   state.stream->session,
                   {},
                   {},
                   1,
                   std::make_shared<const std::string>(json.dump())};
  robot->result.publish(result);
  return robot;
}

}  // namespace

TEST_CASE("what sweepd tells is only text, and a result may have twelve joints", "[live_page]") {
  if (!browser_is_here()) return;
  const auto robot = odd_robot();
  sweepd::ServiceStatus serving{sweepd::ServiceStatus::Phase::serving, {robot}, {kEvil}, {}};
  serving.not_served = {{kEvil, kEvil}};
  sweepd::Published<sweepd::ServiceStatus> status(serving);
  const sweepd::HttpPages pages(status, {});
  const sweepd::HttpServer server({0x7f000001, 0},
                                  [&](const auto& request) { return pages.answer(request); });
  const auto address = "http://127.0.0.1:" + std::to_string(server.local().port);
  Browser browser;
  browser.size(1024, 600, false);
  for (const std::string target : {"/", "/?robot=odd"}) {
    browser.open(address + target);
    CHECK(browser.becomes("document.querySelector('tbody tr a, .dh td')"));
    CHECK(browser.becomes("document.querySelector('main').textContent.includes('onerror=alert')"));
    CHECK(browser.text("document.querySelectorAll('main script, main img').length") == "0");
    CHECK(browser.text("document.title") != "x");
    CHECK(
        browser.becomes("document.querySelector('main').textContent.toLowerCase().includes('the "
                        "recording is paused')"));
    CHECK(
        browser.becomes("document.querySelector('main').textContent.match(/controller missed 5|"
                        "sweepd started5/)"));
    browser.screenshot(kScreenshots / (target == "/" ? "odd_robots.png" : "odd_whole.png"), true);
  }
  CHECK(browser.text("document.querySelectorAll('.lanes tbody tr').length") == "12");
  CHECK(browser.text("document.querySelectorAll('.dh tbody .first').length") == "12");
  CHECK(browser.becomes("document.querySelectorAll('.lanes .bar.used').length == 6"));
  CHECK(browser.text("document.querySelectorAll('.lanes .bar.unusable').length") == "1");
  CHECK(browser.becomes("document.querySelector('[data-link=late]').textContent == '1'"));
  for (const auto& line : browser.console()) {
    INFO(line);
    CHECK(false);
  }
}

TEST_CASE("a page says when sweepd is gone, and is live again within five seconds", "[live_page]") {
  if (!browser_is_here()) return;
  ServedPage page;
  auto& browser = page.browser;
  browser.open(page.address() + "/?robot=kr5-arc");
  const std::string state = "document.getElementById('connection').dataset.state";
  CHECK(browser.becomes(state + " == 'live'"));
  page.daemon.process().signal(SIGTERM);
  CHECK(page.daemon.process().wait() == 0);
  CHECK(browser.becomes(state + " == 'lost'"));
  browser.size(1024, 600, false);
  browser.screenshot(kScreenshots / "lost_1024_light.png");
  page.daemon.start();
  CHECK(browser.becomes(state + " == 'live'", 5));
  CHECK(browser.text("document.getElementById('connection').textContent") == "live again");
}

TEST_CASE("a robot that does not exist is told in words, and its name is only text",
          "[live_page]") {
  if (!browser_is_here()) return;
  ServedPage page;
  auto& browser = page.browser;
  browser.open(page.address() +
               "/?robot=%3Cscript%3Edocument.title%3D%27x%27%3C%2Fscript%3E%22%0A%D7%A9%D7%9C");
  const std::string words = "document.getElementById('connection').textContent";
  CHECK(browser.becomes(words + ".includes('there is no such robot')"));
  CHECK(browser.becomes(words + ".includes('one of: kr5-arc')"));
  CHECK(browser.text("document.querySelectorAll('main script, h1 script').length") == "0");
  CHECK(browser.text("document.title").starts_with("<script>"));
  browser.size(1024, 600, false);
  browser.screenshot(kScreenshots / "unknown_1024_light.png");
}

// By hand: axe-core is large, and nothing else needs it. CONTRIBUTING.md has the command.
TEST_CASE("axe-core finds nothing serious, in both schemes and sizes", "[.axe]") {
  const char* file = std::getenv("SWEEPD_AXE");
  REQUIRE(file != nullptr);  // axe.min.js
  const std::string axe = content(file);
  REQUIRE(axe.size() > 100'000);
  ServedPage page;
  auto& browser = page.browser;
  const auto controller = page.controller();
  CHECK(controller->wait() != 1);
  CHECK(eventually([&] { return HttpClient(page.port).get("/api/result").status == 200; }));
  for (const std::string target : {"/", "/?robot=kr5-arc"}) {
    browser.open(page.address() + target);
    CHECK(browser.becomes("document.querySelector('tbody tr a, .dh td')"));
    browser.run("document.querySelectorAll('details').forEach(one => one.open = true)");
    browser.run(axe);
    for (const bool phone : {false, true})
      for (const bool dark : {false, true}) {
        browser.size(phone ? 360 : 1024, phone ? 740 : 600, phone);
        browser.scheme(dark);
        const Json found = browser.run_later(
            "const done = arguments[arguments.length - 1];"
            "axe.run().then(result => done({passes: result.passes.length, violations: "
            "result.violations.map(one => [one.impact, one.id, one.nodes[0].html])}))");
        std::cout << target << (phone ? ", phone" : ", desk") << (dark ? ", dark" : ", light")
                  << ": " << found["passes"] << " rules passed; found: " << found["violations"]
                  << '\n';
        for (const auto& one : found["violations"])
          CHECK((one[0] != "serious" && one[0] != "critical"));
      }
  }
}
