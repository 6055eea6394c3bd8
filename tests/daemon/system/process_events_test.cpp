#include "daemon/system/process_events.hpp"

#include <atomic>
#include <thread>

#include <signal.h>
#include <unistd.h>

#include "tests/catch.hpp"

using namespace std::chrono_literals;
using sweepd::ProcessEvents;

namespace {

/// What the test leaves behind of it.
class SignalMask {
 public:
  SignalMask() { pthread_sigmask(SIG_BLOCK, nullptr, &before_); }
  ~SignalMask() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalMask(const SignalMask&) = delete;
  SignalMask& operator=(const SignalMask&) = delete;

 private:
  sigset_t before_{};
};

bool blocks(int signal) {
  sigset_t mask;
  pthread_sigmask(SIG_BLOCK, nullptr, &mask);
  return sigismember(&mask, signal) == 1;
}

}  // namespace

TEST_CASE("signals reach the one that waits, in their order, and no thread that it started",
          "[process_events]") {
  const SignalMask mask;
  ProcessEvents events{SIGUSR1, SIGUSR2};
  bool blocked = false;
  std::thread([&] { blocked = blocks(SIGUSR1) && blocks(SIGUSR2); }).join();
  CHECK(blocked);
  for (const int signal : {SIGUSR1, SIGUSR2, SIGUSR1}) {
    ::kill(::getpid(), signal);
    CHECK_FALSE(events.next_signal());
    while (!events.next_signal()) events.wait_until(ProcessEvents::Steady::now() + 1h);
    CHECK(blocks(signal));
  }
  ::kill(::getpid(), SIGUSR2);
  std::optional<int> signal;
  events.wait_until(ProcessEvents::Steady::now() + 1h,
                    [&] { return (signal = events.next_signal()).has_value(); });
  CHECK(signal == SIGUSR2);
}

TEST_CASE("who waits is woken, also beforehand, or its time comes", "[process_events]") {
  ProcessEvents events{};
  events.wake();
  events.wait_until(ProcessEvents::Steady::now() + 1h);
  std::atomic<bool> done = false;
  std::thread other([&] {
    done = true;
    events.wake();
  });
  CHECK(events.wait_until(ProcessEvents::Steady::now() + 1h, [&] { return done.load(); }));
  other.join();
  CHECK_FALSE(events.wait_until(ProcessEvents::Steady::now() + 1ms, [] { return false; }));
}
