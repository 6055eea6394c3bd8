#include "daemon/system/turn_threads.hpp"

#include <exception>
#include <system_error>

#include "daemon/system/log.hpp"
#include "daemon/system/realtime.hpp"

namespace sweepd {
namespace {

using Steady = std::chrono::steady_clock;

void say_failure(const char* name, const std::exception& error) noexcept {
  try {
    Log().error(
        "the {} thread could not do its work ({}); it tries again each second: see what "
        "uses up the memory of this machine",
        name, error.what());
  } catch (const std::exception&) {  // no memory for words either
  }
}

}  // namespace

TurnThreads::~TurnThreads() {
  for (auto& [place, thread] : threads_)
    if (thread.thread.joinable()) thread.thread.join();
}

std::unique_ptr<TurnThreads::Work> TurnThreads::begin(Group group, Turn turn) {
  const std::lock_guard lock(mutex_);
  std::unique_ptr<Work> work(new Work(*this, taken_on(group), std::move(turn)));
  wait(*work, Steady::now());
  for (auto& [place, thread] : threads_)
    if (thread.runs) leave_processors_too(thread.thread);
  return work;
}

TurnThreads::Work::~Work() {
  std::unique_lock lock(threads_.mutex_);
  ending_ = true;
  threads_.turn_ended_.wait(lock, [this] { return !in_turn_; });
  auto& thread = threads_.threads_.at(at_);
  thread.waiting.erase({due_, this});
  threads_.leave(thread);
}

void TurnThreads::Work::wake() {
  const std::lock_guard lock(threads_.mutex_);
  const auto now = Steady::now();
  woken_ = in_turn_;
  if (in_turn_ || due_ <= now) return;
  threads_.threads_.at(at_).waiting.erase({due_, this});
  threads_.wait(*this, now);
}

TurnThreads::Work::Place TurnThreads::taken_on(Group group) {
  // The first that may have more, else that with the fewest.
  Work::Place place{group, 0};
  for (std::size_t number = 0; number < most_; ++number) {
    const auto works = threads_[{group, number}].works;
    const auto fewest = threads_[place].works;
    if (fewest < works_) break;
    if (works < fewest) place.second = number;
  }
  Thread& thread = threads_[place];
  if (!thread.runs) {
    if (thread.thread.joinable()) thread.thread.join();  // it has let go of the mutex for good
    thread.thread = std::thread([this, &thread] { run(thread); });
    thread.runs = true;
  }
  ++thread.works;
  return place;
}

void TurnThreads::wait(Work& work, Time due) {
  Thread& thread = threads_.at(work.at_);
  work.due_ = due;
  const auto place = thread.waiting.emplace(due, &work).first;
  if (place == thread.waiting.begin()) thread.changed.notify_one();
}

void TurnThreads::leave(Thread& thread) {
  if (--thread.works == 0) thread.changed.notify_one();
}

void TurnThreads::move(Work& work, Group group) {
  try {
    leave(threads_.at(std::exchange(work.at_, taken_on(group))));
  } catch (const std::system_error&) {
  }
}

TurnThreads::Next TurnThreads::turn_of(Work& work) const {
  try {
    return work.turn_();
  } catch (const std::exception& error) {
    if (!std::exchange(work.failed_, true)) say_failure(name_, error);
    return {Steady::now() + std::chrono::seconds(1)};
  }
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
    const Next next = turn_of(*work);
    lock.lock();
    work->in_turn_ = false;
    if (work->ending_) {
      turn_ended_.notify_all();
      continue;
    }
    if (next.group && *next.group != work->group()) move(*work, *next.group);
    wait(*work, std::exchange(work->woken_, false) ? Steady::now() : next.due);
  }
  self.runs = false;
}

}  // namespace sweepd
