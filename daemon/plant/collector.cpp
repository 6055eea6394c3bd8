#include "daemon/plant/collector.hpp"

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <thread>

#include <nlohmann/json.hpp>

namespace sweepd {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;

constexpr auto kLinksEvery = 30s;
constexpr auto kLongestWait = 10s;

}  // namespace

CampaignStore& Collector::open() {
  if (!store_) store_.emplace(database_);
  return *store_;
}

template <typename Work>
bool Collector::until_done(const Work& work) {
  std::chrono::milliseconds pause = 200ms;
  bool said = false;
  while (true) {
    try {
      work();
      if (said) log_.note("PostgreSQL takes results again");
      return true;
    } catch (const DatabaseError& problem) {
      if (problem.by_data()) throw std::invalid_argument(problem.what());
      if (!said) log_.error("{}; the broker keeps what comes until then", problem.what());
      said = true;
    }
    if (stopping_) return false;
    for (auto waited = 0ms; waited < pause && !stopping_; waited += 50ms)
      std::this_thread::sleep_for(50ms);
    pause = std::min<std::chrono::milliseconds>(2 * pause, kLongestWait);
  }
}

void Collector::take(const BrokerLink::Message& message) {
  const std::scoped_lock lock(one_);
  busy_ = true;
  bool done = true;
  try {
    done = until_done([&] { store(message); });
  } catch (const std::exception& problem) {
    // Kept all the same, so that somebody can look at it.
    log_.error("{} is not stored: {}; see the table refused", message.topic, problem.what());
    try {
      done =
          until_done([&] { open().add_refused(message.topic, message.payload, problem.what()); });
    } catch (const std::exception& second) {
      log_.error("{} is lost: {}", message.topic, second.what());
    }
  }
  if (!done) {
    // To return would acknowledge it: the program ends while this waits, and the broker sends it
    // again.
    while (true) std::this_thread::sleep_for(1s);
  }
  busy_ = false;
}

void Collector::store(const BrokerLink::Message& message) {
  const auto topic = parse_topic(message.topic);
  if (!topic) throw std::invalid_argument("sweepd has no such topic");
  if (topic->kind == "result") {
    const bool is_new = open().add_result(topic->place, message.payload, message.names);
    if (!is_new) return;
    ++stored_;
    const auto session = message.names.find("session");
    log_.note("{} {} is stored", text(topic->place),
              session == message.names.end() ? "" : session->second);
  } else if (topic->kind == "compare") {
    open().add_change(topic->place, message.payload, message.names);
  } else if (topic->kind == "state") {
    if (auto told = link_told(Json::parse(message.payload, nullptr, false)))
      links_.insert_or_assign(message.topic, std::pair(topic->place, std::move(*told)));
    if (Steady::now() >= links_due_) add_links();
  }
}

void Collector::add_links() {
  try {
    open().add_links(links_);
  } catch (const DatabaseError& problem) {
    if (!problem.by_data()) throw;
    // One robot's counts are refused: they must not keep those of all others out.
    for (const auto& link : links_) add_link(link);
  }
  links_.clear();
  links_due_ = Steady::now() + kLinksEvery;
}

void Collector::add_link(const Links::value_type& link) {
  try {
    open().add_links({link});
  } catch (const DatabaseError& problem) {
    if (!problem.by_data()) throw;
    log_.error("the counts of {} are not stored: {}", link.first, problem.what());
  }
}

void Collector::finish() {
  const std::unique_lock lock(one_, std::try_to_lock);
  if (!lock) return;
  try {
    if (!links_.empty()) add_links();
  } catch (const std::exception& problem) {
    log_.warning("the last counts of links are not stored ({}): they come with the next states",
                 problem.what());
  }
}

}  // namespace sweepd
