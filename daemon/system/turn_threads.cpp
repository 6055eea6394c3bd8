#include "daemon/system/turn_threads.hpp"

#include <algorithm>
#include <system_error>

#include "daemon/system/realtime.hpp"

namespace sweepd {
namespace {

using Steady = std::chrono::steady_clock;

}  // namespace

TurnThreads::~TurnThreads() {
  for (auto& [lane, thread] : lanes_)
    if (thread.thread.joinable()) thread.thread.join();
}

std::unique_ptr<TurnThreads::Work> TurnThreads::begin(Lane lane, Turn turn) {
  const std::lock_guard lock(mutex_);
  return add(lane, std::move(turn));
}

std::unique_ptr<TurnThreads::Work> TurnThreads::begin_on_one_of(std::size_t lanes, Turn turn) {
  const std::lock_guard lock(mutex_);
  const auto works = [this](Lane lane) {
    const auto known = lanes_.find(lane);
    return known == lanes_.end() ? 0 : known->second.works;
  };
  Lane emptiest = 0;
  for (Lane lane = 1; lane < lanes; ++lane)
    if (works(lane) < works(emptiest)) emptiest = lane;
  return add(emptiest, std::move(turn));
}

TurnThreads::Work::~Work() {
  std::unique_lock lock(threads_.mutex_);
  ending_ = true;
  threads_.turn_ended_.wait(lock, [this] { return !in_turn_; });
  auto& thread = threads_.lanes_.at(lane_);
  thread.waiting.erase({due_, this});
  threads_.leave(thread);
}

void TurnThreads::Work::wake() {
  const std::lock_guard lock(threads_.mutex_);
  const auto now = Steady::now();
  woken_ = in_turn_;
  if (in_turn_ || due_ <= now) return;
  threads_.lanes_.at(lane_).waiting.erase({due_, this});
  threads_.wait(*this, now);
}

std::unique_ptr<TurnThreads::Work> TurnThreads::add(Lane lane, Turn turn) {
  Thread& thread = started(lane);
  std::unique_ptr<Work> work(new Work(*this, lane, std::move(turn)));
  ++thread.works;
  wait(*work, Steady::now());
  for (auto& [other, each] : lanes_)
    if (each.runs) leave_processors_too(each.thread);
  return work;
}

TurnThreads::Thread& TurnThreads::started(Lane lane) {
  Thread& thread = lanes_[lane];
  if (thread.runs) return thread;
  if (thread.thread.joinable()) thread.thread.join();  // it has let go of the mutex for good
  thread.thread = std::thread([this, &thread] { run(thread); });
  thread.runs = true;
  return thread;
}

void TurnThreads::wait(Work& work, Time due) {
  auto& [thread, runs, works, waiting, changed] = lanes_.at(work.lane_);
  work.due_ = due;
  const auto place = waiting.emplace(due, &work).first;
  if (place == waiting.begin()) changed.notify_one();
}

void TurnThreads::leave(Thread& thread) {
  if (--thread.works == 0) thread.changed.notify_one();
}

void TurnThreads::move(Work& work, Lane lane) {
  try {
    ++started(lane).works;
  } catch (const std::system_error&) {
    return;
  }
  leave(lanes_.at(std::exchange(work.lane_, lane)));
}

void TurnThreads::run(Thread& self) {
  name_thread(name_);
  std::unique_lock lock(mutex_);
  while (self.works > 0) {
    if (self.waiting.empty()) {
      self.changed.wait(lock);
      continue;
    }
    const auto [due, work] = *self.waiting.begin();
    if (due > Steady::now()) {
      self.changed.wait_until(lock, due);
      continue;
    }
    self.waiting.erase(self.waiting.begin());
    work->in_turn_ = true;
    lock.unlock();
    const Next next = work->turn_();
    lock.lock();
    work->in_turn_ = false;
    if (work->ending_) {
      turn_ended_.notify_all();
      continue;
    }
    if (next.lane && *next.lane != work->lane_) move(*work, *next.lane);
    wait(*work, std::exchange(work->woken_, false) ? Steady::now() : next.due);
  }
  self.runs = false;
}

}  // namespace sweepd
