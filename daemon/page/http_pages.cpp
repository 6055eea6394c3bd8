#include "daemon/page/http_pages.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/page/assets.hpp"
#include "daemon/page/live_stream.hpp"
#include "daemon/page/metrics.hpp"
#include "daemon/page/page_json.hpp"
#include "daemon/text/text_layout.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;

/// The status is published once a second.
constexpr auto kStale = 10s;

constexpr std::string_view kScheme = "http://";
constexpr std::string_view kJson = "application/json";
constexpr std::string_view kEvents = "text/event-stream";
constexpr std::string_view kPrometheus = "text/plain; version=0.0.4; charset=utf-8";
HttpResponse text(int status, std::string line) {
  return {status, HttpResponse{}.type, std::move(line) + '\n'};
}

/// Takes `prefix` off, whatever its case.
bool take(std::string_view& text, std::string_view prefix) {
  if (!rsi::equal_ignoring_case(text.substr(0, prefix.size()), prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

std::vector<RobotMetrics> newest(const ServiceStatus& status) {
  std::vector<RobotMetrics> robots;
  for (const auto& robot : status.robots)
    robots.push_back({robot->state.newest(), robot->result.newest()});
  return robots;
}

HttpResponse readiness(const ServiceStatus& status) {
  if (status.phase == ServiceStatus::Phase::starting) return text(503, "starting");
  if (status.phase == ServiceStatus::Phase::stopping) return text(503, "stopping");
  if (status.ready()) return text(200, "ready");
  std::string trouble;
  for (const auto& [robot, reason] : status.not_served)
    trouble += fmt::format("{}: not served: {}\n", robot, reason);
  return {503, HttpResponse{}.type, trouble};
}

/// Answers for the robot that is asked for: `query` is empty or "robot=NAME".
template <typename Answer>
HttpResponse for_robot(const ServiceStatus& status, std::string_view query, Answer answer) {
  if (!query.empty() && !take(query, "robot=")) return text(400, "expected ?robot=NAME");
  std::string names;
  for (const auto& robot : status.robots) {
    const auto name = robot->state.newest()->name;
    names += ' ' + name;
    if (query.empty() ? status.robots.size() == 1 : query == name) return answer(robot, name);
  }
  for (const auto& [robot, reason] : status.not_served)
    if (query == robot) return text(404, fmt::format("{}: not served: {}", robot, reason));
  if (names.empty()) return text(404, "no robot is served");
  if (query.empty()) return text(400, "which robot? add ?robot=NAME with one of:" + names);
  return text(404, "there is no such robot: ?robot=NAME takes one of:" + names);
}

HttpResponse result(const ServiceStatus& status, std::string_view query) {
  return for_robot(status, query, [](const auto& robot, const std::string& name) -> HttpResponse {
    const auto result = robot->result.newest();
    if (result->newest) return {200, kJson, *result->newest->json};
    return text(404, name + ": no result yet: nothing has been identified since sweepd started");
  });
}

HttpResponse health(const ServiceStatus& status, std::chrono::nanoseconds age) {
  // At the start and the end nobody looks.
  if (status.phase != ServiceStatus::Phase::serving) return text(200, "ok");
  std::string trouble;
  for (const auto& sentence : status.standstills) trouble += sentence + '\n';
  if (age > kStale)
    trouble += "sweepd: the main thread has not looked for " +
               std::to_string(std::chrono::duration_cast<std::chrono::seconds>(age).count()) +
               " s\n";
  if (trouble.empty()) return text(200, "ok");
  return {503, HttpResponse{}.type, trouble};
}

/// What a page is made of.
struct Asked {
  const Published<ServiceStatus>& published;
  const ServiceStatus& status;
  std::string_view path;
  std::string_view query;        ///< behind the question mark
  bool wants_html;               ///< it is a browser
  std::chrono::nanoseconds age;  ///< of the status
};

HttpResponse live(const Asked& asked) {
  return for_robot(asked.status, asked.query, [&](const auto& robot, const std::string&) {
    HttpResponse response{200, kEvents, {}};
    const auto stream = std::make_shared<LiveStream>(asked.published, robot);
    response.more = [stream] { return stream->next(); };
    return response;
  });
}

HttpResponse asset(const Asked& asked) {
  for (const Asset& asset : assets())
    if (asset.path == asked.path) return {200, asset.type, std::string(asset.text), "no-cache"};
  return text(404, "no such page: / lists them");
}

struct Page {
  std::string_view path;  ///< with a / at its end: all that begin with it
  std::string_view what;  ///< for the list of pages; empty: it is not on it
  HttpResponse (*answer)(const Asked& asked);
};

HttpResponse index(const Asked& asked);

constexpr auto kPages = std::to_array<Page>({
    {"/", "", index},
    {"/healthz", "whether its threads move",
     [](const Asked& asked) { return health(asked.status, asked.age); }},
    {"/readyz", "whether it serves all robots",
     [](const Asked& asked) { return readiness(asked.status); }},
    {"/metrics", "counters and histograms for Prometheus",
     [](const Asked& asked) -> HttpResponse {
       return {200, kPrometheus, metrics(asked.status, newest(asked.status), process_state())};
     }},
    {"/api/state", "how each robot's link, recording and sweeps are, as JSON",
     [](const Asked& asked) -> HttpResponse {
       return {200, kJson, state_json(asked.status, newest(asked.status), process_state())};
     }},
    {"/api/result", "the newest result.json; ?robot=NAME where there are several",
     [](const Asked& asked) { return result(asked.status, asked.query); }},
    {"/api/live", "what happens now, as server-sent events; ?robot=NAME likewise", live},
    {"/assets/", "", asset},
});

HttpResponse index(const Asked& asked) {
  if (asked.wants_html)
    return asset({asked.published, asked.status, "/assets/index.html", {}, true, {}});
  std::string list = "sweepd, beside a robot controller. Its pages:\n";
  for (const Page& page : kPages)
    if (!page.what.empty())
      list += left(std::string(page.path), 14) + std::string(page.what) + '\n';
  return {200, HttpResponse{}.type, list};
}

/// Whether text/html is among what is accepted. What accepts anything, as curl does, is no browser.
bool wants_html(const std::vector<std::string_view>& accepts) {
  for (std::string_view rest : accepts)
    while (!rest.empty()) {
      auto range = rest.substr(0, rest.find(','));
      rest.remove_prefix(std::min(range.size() + 1, rest.size()));
      range.remove_prefix(std::min(range.find_first_not_of(" \t"), range.size()));
      if (!take(range, "text/html")) continue;
      const auto end = range.find_first_not_of(" \t");
      if (end == range.npos || range[end] == ';') return true;
    }
  return false;
}

}  // namespace

HttpPages::HttpPages(const Published<ServiceStatus>& status, const HttpSettings& settings,
                     std::function<Clock::time_point()> now)
    : status_(status), hosts_{"localhost", "127.0.0.1", "[::1]"}, now_(std::move(now)) {
  if (settings.listen) hosts_.push_back(rsi::address_text(settings.listen->address));
  hosts_.insert(hosts_.end(), settings.hosts.names.begin(), settings.hosts.names.end());
}

HttpResponse HttpPages::answer(const HttpRequest& request) const {
  if (request.method != "GET" && request.method != "HEAD")
    return text(405, "these pages can only be read: GET or HEAD");
  if (request.has_body) return text(413, "a request without a body is expected");
  if (request.hosts.size() != 1) return text(400, "one Host header is expected");
  std::string_view target = request.target;
  std::string_view host = request.hosts.front();
  if (take(target, kScheme)) {  // as for a proxy: this host counts
    host = target.substr(0, target.find('/'));
    target.remove_prefix(host.size());
    if (target.empty()) target = "/";
  }
  if (!is_ours(host))
    return text(421, "not a name of this machine: add it to `hosts` of [http] in sweepd.toml");
  for (std::string_view origin : request.origins) {
    const bool is_web = take(origin, kScheme) || take(origin, "https://");
    if (!is_web || !rsi::equal_ignoring_case(origin, host))
      return text(403, "scripts of other pages are not answered");
  }
  const auto end = target.find('?');
  return page(target.substr(0, end), end == target.npos ? "" : target.substr(end + 1),
              wants_html(request.accepts));
}

bool HttpPages::is_ours(std::string_view authority) const {
  const auto bracket = authority.find(']');
  const auto colon = authority.find(':', bracket == authority.npos ? 0 : bracket);
  const auto host = authority.substr(0, colon);
  return std::any_of(hosts_.begin(), hosts_.end(),
                     [&](const std::string& ours) { return rsi::equal_ignoring_case(host, ours); });
}

HttpResponse HttpPages::page(std::string_view path, std::string_view query, bool wants_html) const {
  const auto found = std::find_if(kPages.begin(), kPages.end(), [&](const Page& page) {
    const bool is_folder = page.path.size() > 1 && page.path.back() == '/';
    return is_folder ? path.starts_with(page.path) : path == page.path;
  });
  if (found == kPages.end()) return text(404, "no such page: / lists them");
  const auto status = status_.newest();
  return found->answer({status_, *status, path, query, wants_html, now_() - status->looked});
}

}  // namespace sweepd
