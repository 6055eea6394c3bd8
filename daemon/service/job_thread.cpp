#include "daemon/service/job_thread.hpp"

#include <utility>

namespace sweepd {

JobThread::JobThread(const char* name, Share share)
    : thread_([this, name, share] {
        name_thread(name);
        take(share);
        run();
      }) {}

JobThread::~JobThread() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void JobThread::submit(std::function<void()> job, bool interim) {
  {
    const std::lock_guard lock(mutex_);
    if (interim) std::erase_if(jobs_, [](const Job& waiting) { return waiting.interim; });
    jobs_.push_back({std::move(job), interim});
  }
  changed_.notify_all();
}

bool JobThread::drain(std::chrono::steady_clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  return changed_.wait_until(lock, deadline, [this] { return jobs_.empty() && !busy_; });
}

void JobThread::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ending_ || !jobs_.empty(); });
    if (jobs_.empty()) return;
    const Job job = std::move(jobs_.front());
    jobs_.pop_front();
    busy_ = true;
    lock.unlock();
    job.work();
    lock.lock();
    busy_ = false;
    changed_.notify_all();
  }
}

}  // namespace sweepd
