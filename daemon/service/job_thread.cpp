#include "daemon/service/job_thread.hpp"

#include <system_error>
#include <utility>

namespace sweepd {

JobThread::~JobThread() {
  drain();
  if (thread_.joinable()) thread_.join();
}

void JobThread::submit(std::function<void()> job, bool interim) {
  const std::lock_guard lock(mutex_);
  if (interim) std::erase_if(jobs_, [](const Job& waiting) { return waiting.interim; });
  jobs_.push_back({std::move(job), interim});
  start();
}

bool JobThread::drain(std::chrono::steady_clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  start();
  return changed_.wait_until(lock, deadline, [this] { return jobs_.empty() && !running_; });
}

/// With the mutex held.
void JobThread::start() {
  if (running_ || jobs_.empty()) return;
  if (thread_.joinable()) thread_.join();  // it has let go of the mutex for good
  try {
    thread_ = std::thread([this] { run(); });
    running_ = true;
  } catch (const std::system_error&) {
  }
}

void JobThread::run() {
  name_thread(name_);
  take(share_);
  std::unique_lock lock(mutex_);
  while (!jobs_.empty()) {
    const Job job = std::move(jobs_.front());
    jobs_.pop_front();
    lock.unlock();
    job.work();
    lock.lock();
  }
  running_ = false;
  changed_.notify_all();
}

}  // namespace sweepd
