#include "daemon/service/robot_keeper.hpp"

#include <algorithm>
#include <utility>

#include "daemon/service/robot_service.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/system/realtime.hpp"
#include "daemon/text/text_layout.hpp"
#include "rsi/telegram/ethernet_config.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;
using Steady = std::chrono::steady_clock;

constexpr auto kFirstPause = 100ms;
constexpr auto kLongestPause = 3s;
/// What passes sooner, as a port whose robot is just let go, is not worth a word.
constexpr auto kWorthSaying = 1s;

/// Of the exception that is being handled.
Problem problem_at_hand() {
  try {
    throw;
  } catch (const ConfigError& error) {
    return {error.what(), true};
  } catch (const rsi::EthernetConfigError& error) {
    return {error.what(), true};
  } catch (const std::exception& error) {
    return {error.what(), false};
  } catch (...) {
    return {"an unknown error", false};
  }
}

}  // namespace

RobotKeeper::RobotKeeper(RobotSettings settings, std::shared_ptr<RobotThreads> shared,
                         std::function<void()> on_change)
    : log_(settings.name),
      shared_(std::move(shared)),
      on_change_(std::move(on_change)),
      wanted_(std::move(settings)) {
  start_keeping();
}

RobotKeeper::~RobotKeeper() {
  let_go();
  if (keeping_.joinable()) keeping_.join();
  if (ending_.joinable()) ending_.join();
}

void RobotKeeper::serve() {
  const Lock lock(mutex_);
  may_serve_ = true;
  changed_.notify_all();
}

void RobotKeeper::reload(const RobotSettings& settings) {
  const Lock lock(mutex_);
  wanted_ = settings;
  reread_ = true;
  changed_.notify_all();
  if (!kept_ && !going_) start_keeping();
}

void RobotKeeper::report_link() {
  const Lock lock(mutex_);
  if (service_) service_->report_link();
}

void RobotKeeper::let_go() {
  const Lock lock(mutex_);
  if (std::exchange(going_, true)) return;
  tell();
  if (!service_) {
    gone_ = true;
    return;
  }
  ++threads_;
  ending_ = std::thread(
      [this, service = std::exchange(service_, nullptr)]() mutable { end(std::move(service)); });
}

RobotKeeper::State RobotKeeper::state() const {
  const Lock lock(mutex_);
  const bool on_its_way =
      phase_ == Phase::trying || (phase_ == Phase::ready && may_serve_) || reread_ || busy_;
  State state{phase_, !on_its_way, problem_, {}, nullptr};
  if (service_) {
    state.beats = service_->beats();
    state.status = service_->status();
  }
  return state;
}

bool RobotKeeper::gone() const {
  const Lock lock(mutex_);
  return gone_;
}

bool RobotKeeper::complete() const {
  const Lock lock(mutex_);
  return complete_;
}

bool RobotKeeper::finished() const {
  const Lock lock(mutex_);
  return threads_ == 0;
}

void RobotKeeper::end(std::shared_ptr<RobotService> service) {
  const bool complete = service->stop();
  {
    const Lock lock(mutex_);
    complete_ = complete;
    gone_ = true;
    tell();
  }
  service.reset();  // a disk that does not answer is waited for
  const Lock lock(mutex_);
  --threads_;
  tell();
}

void RobotKeeper::tell() {
  changed_.notify_all();
  on_change_();
}

void RobotKeeper::start_keeping() {
  if (keeping_.joinable()) keeping_.join();  // it has let go of the mutex for good
  kept_ = true;
  ++threads_;
  try {
    keeping_ = std::thread([this] { keep(); });
  } catch (...) {
    kept_ = false;
    --threads_;
    throw;
  }
}

void RobotKeeper::keep() {
  name_thread("keeper");
  Lock lock(mutex_);
  while (!going_ && (!service_ || reread_)) {
    if (service_)
      take_over(lock);
    else
      try_to_serve(lock);
  }
  kept_ = false;
  --threads_;
  tell();
}

void RobotKeeper::try_to_serve(Lock& lock) {
  const RobotSettings settings = wanted_;
  reread_ = false;
  lock.unlock();
  std::shared_ptr<RobotService> service;
  try {
    service = std::make_shared<RobotService>(settings, shared_);
    lock.lock();
    phase_ = Phase::ready;
    tell();
    changed_.wait(lock, [this] { return going_ || may_serve_; });
    const bool going = going_;
    lock.unlock();
    if (!going) service->start();
  } catch (...) {
    auto problem = problem_at_hand();
    service.reset();
    lock.lock();
    problem_ = std::move(problem);
    return failed(lock);
  }
  lock.lock();
  if (going_) {  // nothing has begun that would have to be ended
    lock.unlock();
    service.reset();
    lock.lock();
    return;
  }
  if (!said_.empty()) log_.note("it can be served now");
  said_.clear();
  problem_.reset();
  pause_ = {};
  service_ = std::move(service);
  phase_ = Phase::serving;
  tell();
}

void RobotKeeper::failed(Lock& lock) {
  const auto now = Steady::now();
  const bool mistake = problem_->is_mistake;
  phase_ = mistake ? Phase::refused : Phase::waiting;
  tell();
  if (pause_ == 0ms) failing_since_ = now;
  pause_ = std::clamp(2 * pause_, std::chrono::milliseconds(kFirstPause),
                      std::chrono::milliseconds(kLongestPause));
  const std::string words = problem_->text;
  if (may_serve_ && words != said_ && (mistake || now - failing_since_ >= kWorthSaying)) {
    log_.error("{}; {}", words,
               mistake ? "the robot is not served until the file is corrected and read again"
                       : "the robot is not served yet, and tried again every few seconds");
    said_ = words;
  }
  const auto other = [this] { return going_ || reread_; };
  if (mistake)
    changed_.wait(lock, other);
  else
    changed_.wait_for(lock, pause_, other);
  if (reread_) pause_ = {};
}

void RobotKeeper::take_over(Lock& lock) {
  const RobotSettings settings = wanted_;
  const auto service = service_;
  reread_ = false;
  busy_ = true;
  lock.unlock();
  try {
    service->reload(settings);
  } catch (const std::exception& error) {
    for (const auto& line : lines_of(error.what())) log_.error("{}", line);
    log_.error(
        "the robot goes on with the settings, description and plan that it had: correct the file "
        "and send SIGHUP once more");
  }
  lock.lock();
  busy_ = false;
  tell();
}

}  // namespace sweepd
