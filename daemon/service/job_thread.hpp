#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

#include "daemon/system/realtime.hpp"

namespace sweepd {

/// Does one job after the other on a thread of its own, which is there only while there are jobs:
/// of many robots few have any. An interim job that has not begun gives way to the next interim
/// one: only the newest is worth doing.
///
/// A thread inherits its share of the processors: jobs for a fair one are not submitted by one
/// whose share is low.
class JobThread {
 public:
  /// `name`: of 15 letters at most, for as long as the thread lives.
  JobThread(const char* name, Share share) : name_(name), share_(share) {}
  ~JobThread();  ///< after the jobs that wait
  JobThread(const JobThread&) = delete;
  JobThread& operator=(const JobThread&) = delete;

  /// Where the system has no thread to give, the job waits for the next one, or a drain.
  void submit(std::function<void()> job, bool interim);
  /// Waits until all jobs are done: true. Or until `deadline`.
  bool drain(std::chrono::steady_clock::time_point deadline =
                 std::chrono::steady_clock::time_point::max());

 private:
  struct Job {
    std::function<void()> work;
    bool interim;
  };

  void start();
  void run();

  const char* const name_;
  const Share share_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  bool running_ = false;
  std::thread thread_;
};

}  // namespace sweepd
