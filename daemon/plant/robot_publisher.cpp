#include "daemon/plant/robot_publisher.hpp"

#include <stdexcept>
#include <system_error>
#include <utility>

#include "daemon/plant/result_summary.hpp"
#include "daemon/report/file_parts.hpp"
#include "daemon/text/json_text.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;

/// Results on their way at once: so many are sent twice when the program is killed.
constexpr std::size_t kMostUnderWay = 4;
constexpr auto kStateEvery = 10s;
/// After what a broker refused, or a disk.
constexpr auto kPause = 30s;
/// A connected broker that has not acknowledged for so long has lost it.
constexpr auto kLongestWay = 5min;

std::string online_json(bool online, const std::string& reason) {
  Json json = {{"online", online}};
  if (!reason.empty()) json["reason"] = reason;
  return json_line(json);
}

std::filesystem::path ledger_of(const RobotPublisher::Options& options) {
  const auto folder = options.spool / options.place.robot;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  auto file = folder / "published";
  if (options.again) std::filesystem::remove(file, error);
  return file;
}

/// A letter that is in no escaped name parts them: no two robots have one.
std::string client_of(const RobotPlace& place) {
  std::string name = "sweepd:" + text(place);
  for (char& c : name)
    if (c == '/') c = ':';
  return name;
}

BrokerLink::Options link_of(const RobotPublisher::Options& options) {
  BrokerLink::Options link;
  link.broker = options.broker;
  link.client = client_of(options.place);
  link.spool = options.spool / options.place.robot;
  link.will_topic = topic_of(options.place, "online");
  link.will = online_json(false, "the publisher is gone");
  return link;
}

}  // namespace

RobotPublisher::RobotPublisher(const Options& options)
    : place_(options.place),
      results_(options.results),
      log_(options.place.robot),
      ledger_(ledger_of(options)),
      outbox_(options.results, log_),
      link_(link_of(options), log_) {}

void RobotPublisher::turn(Steady::time_point now, bool look) {
  look_ = look_ || look;
  link_.keep(now);
  if (!link_.connected()) {
    was_connected_ = false;
    return;
  }
  if (!was_connected_) {
    was_connected_ = look_ = true;
    state_due_ = now;
    tell_online();
  }
  look_after_deliveries(now);
  if (!look_ || now < results_due_ || under_way_.size() >= kMostUnderWay) return;
  const auto found = outbox_.take(kMostUnderWay - under_way_.size(), ledger_);
  look_ = !found.empty();  // there may be more
  for (const FinishedResult& result : found) publish(result, now);
}

void RobotPublisher::publish(const FinishedResult& result, Steady::time_point now) {
  UnderWay way{result.session, result.sha256, {}, now};
  BrokerLink::Names names{{"session", result.session}, {"sha256", result.sha256}};
  if (!result.started.empty()) names["started"] = result.started;
  // Of a session that ended later the broker keeps the result: one that was made from an earlier
  // recording must not take its place.
  const bool retained = !ledger_.has_later(result.session);
  const auto add = [&](const std::string& kind, const std::string& payload) {
    way.parts.push_back(link_.publish(topic_of(place_, kind), payload, 1, retained, names));
  };
  try {
    add("result", result.bytes);
    add("result/summary", result_summary(place_, result));
    if (const auto before = outbox_.before(result.session); !before.empty()) {
      names["since"] = before.filename().string();
      const auto change = change_since(before, result);
      if (change.json)
        add("compare", *change.json);
      else
        log_.note("{} is not compared with the one before: {}", result.session, change.why_not);
    }
  } catch (const std::runtime_error& problem) {
    log_.error("{}; the result of {} stays on the disk and is published later", problem.what(),
               result.session);
    outbox_.give_back(result.session);
    look_ = true;
    results_due_ = now + kPause;
    return;
  }
  under_way_.push_back(std::move(way));
}

void RobotPublisher::look_after_deliveries(Steady::time_point now) {
  using Is = BrokerLink::Delivery::Is;
  std::erase_if(under_way_, [&](const UnderWay& way) {
    bool all_done = true;
    std::string why;
    for (const auto& part : way.parts) {
      const Is is = part.now();
      all_done = all_done && is == Is::done;
      if (is == Is::failed) why = part.why();
    }
    if (!all_done && now - way.since > kLongestWay) why = "it does not acknowledge it";
    if (!why.empty()) {
      log_.error("the broker did not take the result of {}: {}; it is published again later",
                 way.session, why);
      outbox_.give_back(way.session);
      look_ = true;
      results_due_ = now + kPause;
      return true;
    }
    if (!all_done) return false;
    log_.note("the result of {} is published", way.session);
    try {
      ledger_.add(way.session, way.sha256);
    } catch (const std::runtime_error& problem) {
      log_.error("{}; the result of {} is published once more after a restart", problem.what(),
                 way.session);
    }
    return true;
  });
}

void RobotPublisher::hear(const Json& state, const std::string& trouble, Steady::time_point now) {
  const bool changed = trouble != trouble_;
  trouble_ = trouble;
  const Json before = std::exchange(state_, state);
  if (!link_.connected()) return;
  if (changed) tell_online();
  if (state_.is_null()) return;
  tell_sweeps(before);
  if (now < state_due_) return;
  state_due_ = now + kStateEvery;
  say("state", json_text(state_), 0, true);
}

void RobotPublisher::tell_online() {
  say("online", online_json(trouble_.empty(), trouble_), 1, true);
}

void RobotPublisher::tell_sweeps(const Json& before) {
  if (before.is_null() || before["started"] != state_["started"]) return;
  const auto row_of = [](const Json& state, const Json& joint) {
    for (const Json& row : list_of(list_of(state, "robots").front(), "sweeps"))
      if (part_of(row, "joint") == joint) return row;
    return Json::object();
  };
  const Json& robot = list_of(state_, "robots").front();
  for (const Json& row : list_of(robot, "sweeps")) {
    if (row == row_of(before, part_of(row, "joint"))) continue;
    Json sweep = {{"schema", "sweepd.sweep/1"},
                  {"at", text_of(state_, "at")},
                  {"session", text_of(part_of(robot, "stream"), "session")}};
    sweep.update(row);
    say("sweep", sweep.dump(), 0, false);
  }
}

void RobotPublisher::say(const std::string& kind, const std::string& payload, int quality,
                         bool retained) {
  try {
    (void)link_.publish(topic_of(place_, kind), payload, quality, retained);
  } catch (const std::runtime_error& problem) {
    log_.warning("{}", problem.what());
  }
}

void RobotPublisher::leave() {
  if (link_.connected()) say("online", online_json(false, "the publisher was stopped"), 1, true);
  link_.leave();
}

}  // namespace sweepd
