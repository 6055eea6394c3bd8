#include "daemon/plant/collect.hpp"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <utility>

#include "daemon/plant/broker_link.hpp"
#include "daemon/plant/collector.hpp"
#include "daemon/plant/topics.hpp"
#include "daemon/settings/plant_settings.hpp"
#include "daemon/system/log.hpp"
#include "daemon/system/process_events.hpp"
#include "daemon/system/service_manager.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;
using Steady = std::chrono::steady_clock;

constexpr const char* kClient = "sweepd-collect";

}  // namespace

int collect_all(const CollectOptions& options) {
  const CollectSettings settings = load_collect_settings(options.config);
  ProcessEvents events{SIGINT, SIGTERM};
  Collector collector(settings.database.text);
  BrokerLink::Options link;
  link.broker = settings.broker;
  link.client = kClient;
  link.spool = settings.spool;
  link.topics = {
      {topics_of_all("result"), 1}, {topics_of_all("compare"), 1}, {topics_of_all("state"), 0}};
  link.take = [&collector](const BrokerLink::Message& message) { collector.take(message); };
  BrokerLink broker(std::move(link), Log());
  service_manager::ready();
  while (!events.next_signal()) {
    broker.keep(Steady::now());
    log_repeats();
    service_manager::status("Results stored since the start: " +
                            std::to_string(collector.stored()));
    service_manager::beat();
    events.wait_until(Steady::now() + 200ms);
  }
  collector.stop();
  const auto patience = Steady::now() + 2s;
  while (collector.busy() && Steady::now() < patience) events.wait_until(Steady::now() + 20ms);
  log_all_repeats();
  if (collector.busy()) {
    // A message waits for the database. To end in order would acknowledge it.
    Log().note("ending while PostgreSQL is away: the broker keeps what it has not taken");
    finish_log();
    std::_Exit(0);
  }
  broker.leave();
  collector.finish();
  return 0;
}

}  // namespace sweepd
