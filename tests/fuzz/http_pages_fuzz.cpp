// What a client of the pages sends: the first line of the input is the method, the second the
// target, each further one a Host header, an Origin header where it begins with "o", an Accept
// header where it begins with "a". Whatever it is, there is an answer, and a page only for who
// names this machine and comes from nowhere else; what goes on consists of events.
#include <algorithm>
#include <array>

#include "daemon/page/http_pages.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;

namespace {

std::string_view take_line(std::string_view& text) {
  const auto end = std::min(text.find('\n'), text.size());
  const auto line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

std::string lower(std::string_view text) {
  std::string small(text);
  for (char& c : small)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return small;
}

bool is_ours(const std::string& host) {
  for (const std::string name : {"localhost", "127.0.0.1", "[::1]", "cell-pc"})
    if (host == name || host.starts_with(name + ':')) return true;
  return false;
}

/// Server-sent events: lines with a field that is known, and at their end an empty one.
void expect_events(std::string_view text) {
  expect(text.ends_with("\n\n"), "the last event is whole");
  while (!text.empty()) {
    const auto line = take_line(text);
    bool known = line.empty();
    for (const std::string_view field : {"event: ", "data: ", "id: ", "retry: "})
      known = known || line.starts_with(field);
    expect(known, "each line is a field of an event");
  }
}

struct Service {
  sweepd::Published<sweepd::ServiceStatus> status;
  sweepd::HttpPages pages{status, {rsi::Endpoint{0x7f000001, 19152}, {{"cell-pc"}}}};

  Service() {
    sweepd::ServiceStatus serving{sweepd::ServiceStatus::Phase::serving, {}, {}, {}};
    const auto robot = std::make_shared<sweepd::RobotStatus>();
    sweepd::RobotState state;
    state.name = "x";
    robot->state.publish(state);
    sweepd::LiveSlice slice;
    slice.number = 1;
    expect(robot->live.try_add(slice, {}), "nobody reads");
    serving.robots.push_back(robot);
    serving.not_served = {{"y", "no port"}};
    status.publish(serving);
  }
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Service service;
  auto rest = fuzz::text(data, size);
  sweepd::HttpRequest request;
  request.method = take_line(rest);
  request.target = take_line(rest);
  while (!rest.empty()) {
    auto line = take_line(rest);
    const bool origin = line.starts_with('o');
    const bool accept = line.starts_with('a');
    if (origin || accept) line.remove_prefix(1);
    (origin ? request.origins : accept ? request.accepts : request.hosts).push_back(line);
  }
  const auto response = service.pages.answer(request);
  constexpr std::array kStatuses{200, 400, 403, 404, 405, 413, 421, 503};
  expect(std::find(kStatuses.begin(), kStatuses.end(), response.status) != kStatuses.end(),
         "the status is one of the documented");
  expect(!response.type.empty(), "there is an answer");
  expect(response.body.empty() == static_cast<bool>(response.more), "of one kind");
  if (response.status != 200) return 0;
  if (response.more) expect_events(response.more().value());
  expect(request.method == "GET" || request.method == "HEAD", "only reading is served");
  expect(request.hosts.size() == 1, "there is one host");
  const auto target = lower(request.target);
  const bool whole = target.starts_with("http://");
  const auto host = whole ? target.substr(7, target.find('/', 7) - 7) : lower(request.hosts[0]);
  expect(is_ours(host), "the host is this machine");
  for (const auto origin : request.origins)
    expect(lower(origin).ends_with("://" + host), "the origin is this machine");
  return 0;
}
