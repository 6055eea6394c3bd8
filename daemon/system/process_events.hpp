#pragma once

#include <chrono>
#include <csignal>
#include <deque>
#include <initializer_list>
#include <optional>

#include "rsi/asio.hpp"

namespace sweepd {

/// What the thread that leads the program waits for: signals, time, and those who wake it.
///
/// The signals reach this thread alone, and only while it waits: they are blocked from construction
/// on, also for the threads that it starts. One at a time in a program.
class ProcessEvents {
 public:
  using Steady = std::chrono::steady_clock;

  explicit ProcessEvents(std::initializer_list<int> signals);
  ProcessEvents(const ProcessEvents&) = delete;
  ProcessEvents& operator=(const ProcessEvents&) = delete;

  /// Until `deadline`, a signal or wake(). Also ends without any of these now and then.
  void wait_until(Steady::time_point deadline);
  /// Until this is done; false if it is not by `deadline`. Whoever does it calls wake().
  template <typename IsDone>
  bool wait_until(Steady::time_point deadline, IsDone is_done) {
    while (!is_done()) {
      if (Steady::now() >= deadline) return false;
      wait_until(deadline);
    }
    return true;
  }

  /// Ends a wait, also the next one. Any thread.
  void wake();

  /// The first of those that came, which is forgotten.
  [[nodiscard]] std::optional<int> next_signal();

 private:
  void listen();

  sigset_t mask_{};
  std::deque<int> came_;
  boost::asio::io_context context_{1};
  boost::asio::signal_set signals_{context_};
};

}  // namespace sweepd
