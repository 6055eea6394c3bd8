#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

#include "daemon/system/realtime.hpp"

namespace sweepd {

/// A thread that does one job after the other. An interim job that has not begun gives way to the
/// next interim one: only the newest is worth doing.
class JobThread {
 public:
  /// `name`: of 15 letters at most, for as long as the thread lives.
  JobThread(const char* name, Share share);
  ~JobThread();  ///< after the jobs that wait
  JobThread(const JobThread&) = delete;
  JobThread& operator=(const JobThread&) = delete;

  void submit(std::function<void()> job, bool interim);
  /// Waits until all jobs are done: true. Or until `deadline`.
  bool drain(std::chrono::steady_clock::time_point deadline =
                 std::chrono::steady_clock::time_point::max());

 private:
  struct Job {
    std::function<void()> work;
    bool interim;
  };

  void run();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  bool busy_ = false;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace sweepd
