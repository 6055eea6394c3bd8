#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>
#include <utility>

#include "daemon/plant/broker_link.hpp"
#include "daemon/plant/collector.hpp"
#include "daemon/plant/plant_services.hpp"
#include "daemon/plant/topics.hpp"
#include "daemon/settings/plant_settings.hpp"
#include "daemon/system/log.hpp"
#include "daemon/system/process_events.hpp"
#include "daemon/system/service_manager.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;
using Steady = std::chrono::steady_clock;

constexpr auto kOften = 200ms;

/// Keeps the connection, on a thread of its own: Paho holds its lock while a message waits for the
/// database, and whoever asks it anything waits as well.
class KeptBroker {
 public:
  explicit KeptBroker(BrokerLink::Options options)
      : broker_(std::move(options), Log()), thread_([this] { keep(); }) {}
  ~KeptBroker() {
    ending_ = true;
    thread_.join();
  }
  KeptBroker(const KeptBroker&) = delete;
  KeptBroker& operator=(const KeptBroker&) = delete;

  /// Leaves the broker in order, as soon as no message waits.
  void end() { ending_ = true; }
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  void keep() {
    while (!ending_) {
      broker_.keep(Steady::now());
      std::this_thread::sleep_for(kOften);
    }
    broker_.leave();
    ended_ = true;
  }

  std::atomic<bool> ending_{false};
  std::atomic<bool> ended_{false};
  BrokerLink broker_;
  std::thread thread_;
};

}  // namespace

int collect_all(const CollectOptions& options) {
  const CollectSettings settings = load_collect_settings(options.config);
  ProcessEvents events{SIGINT, SIGTERM, SIGHUP};
  Collector collector(settings.database.text);
  BrokerLink::Options link;
  link.broker = settings.broker;
  link.client = settings.client.text;
  link.spool = settings.spool;
  link.topics = {
      {topics_of_all("result"), 1}, {topics_of_all("compare"), 1}, {topics_of_all("state"), 0}};
  link.take = [&collector](const BrokerLink::Message& message) { collector.take(message); };
  KeptBroker broker(std::move(link));
  service_manager::ready();
  while (!is_ended(events)) {
    log_repeats();
    service_manager::status("Results stored since the start: " +
                            std::to_string(collector.stored()));
    service_manager::beat();
    events.wait_until(Steady::now() + kOften);
  }
  collector.stop();
  const auto patience = Steady::now() + 2s;
  while (collector.busy() && Steady::now() < patience) events.wait_until(Steady::now() + 20ms);
  if (!collector.busy()) broker.end();
  while (!broker.ended() && Steady::now() < patience) events.wait_until(Steady::now() + 20ms);
  log_all_repeats();
  if (!broker.ended()) {
    // A message waits for the database. To end in order would acknowledge it.
    Log().note("ending while PostgreSQL is away: the broker keeps what it has not taken");
    finish_log();
    std::_Exit(0);
  }
  collector.finish();
  return 0;
}

}  // namespace sweepd
