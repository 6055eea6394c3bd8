// What a broker and a daemon's pages tell: the first line is a topic, the rest a state. Of any
// text, topics and places are read back as they are written, and nothing is counted twice.
#include <algorithm>

#include <nlohmann/json.hpp>

#include "daemon/plant/daemon_state.hpp"
#include "daemon/plant/link_day.hpp"
#include "daemon/plant/topics.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input = fuzz::text(data, size);
  const auto end = std::min(input.find('\n'), input.size());
  const std::string_view topic = input.substr(0, end);
  const std::string body(input.substr(std::min(end + 1, input.size())));

  if (const auto read = sweepd::parse_topic(topic)) {
    expect(sweepd::topic_of(read->place, read->kind) == topic, "a topic is written as it was read");
    const std::string place = sweepd::text(read->place);
    expect(fuzz::is_one_line(place), "a place can go to a log");
    expect(sweepd::parse_robot_place(place) == read->place, "a place is read as it was written");
  }

  const auto state = sweepd::parse_daemon_state(body, "2026-11-23T11:00:00Z");
  expect(state.trouble.empty() || fuzz::is_one_line(state.trouble), "trouble is a sentence");
  for (const auto& [name, robot] : state.robots)
    expect(robot.at("robots").size() == 1, "each robot is told alone");

  const auto json = nlohmann::ordered_json::parse(body, nullptr, false);
  if (const auto told = sweepd::link_told(json)) {
    expect(told->day.size() == 10 && fuzz::is_one_line(told->day), "a day is a date");
    const auto first = sweepd::counted_since(std::nullopt, *told);
    expect(first.has_value(), "the first state counts");
    for (const auto count : first->counts) expect(count >= 0, "no count is negative");
    expect(!sweepd::counted_since(told->counters, *told), "a state that comes again adds nothing");
  }
  return 0;
}
