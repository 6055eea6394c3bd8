#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>

namespace sweepd {

/// Threads that do the work of many in turns. Each work is on a lane, and each lane has one thread
/// for as long as there is work on it. Of those whose time has come, the next turn is that of who
/// waited longest. A turn that stands still holds up its own lane and no other.
class TurnThreads {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Lane = std::uint64_t;

  struct Next {
    Time due;                       ///< there is no turn before, unless it is woken
    std::optional<Lane> lane = {};  ///< on this one from now on, if the system has a thread for it
  };
  /// Does what is to be done now, in the thread of its lane. Does not throw.
  using Turn = std::function<Next()>;

  class Work {
   public:
    /// Waits for the turn under way, which is the last one. Not in a turn.
    ~Work();
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

    /// A turn that has not begun yet is due. Any thread; no turn is waited for.
    void wake();
    /// In a turn: its own.
    [[nodiscard]] Lane lane() const { return lane_; }

   private:
    friend TurnThreads;
    Work(TurnThreads& threads, Lane lane, Turn turn)
        : threads_(threads), turn_(std::move(turn)), lane_(lane) {}

    TurnThreads& threads_;
    const Turn turn_;
    // The mutex guards these.
    Lane lane_;
    Time due_{};
    bool in_turn_ = false;
    bool woken_ = false;   // meanwhile
    bool ending_ = false;  // behind this turn
  };

  /// `name`: of 15 letters at most, of all the threads.
  explicit TurnThreads(const char* name) : name_(name) {}
  ~TurnThreads();  ///< after all work
  TurnThreads(const TurnThreads&) = delete;
  TurnThreads& operator=(const TurnThreads&) = delete;

  /// Its first turn is due. From now on all threads keep off the processors that the calling one
  /// keeps off. Throws std::system_error where the system has no thread to give.
  [[nodiscard]] std::unique_ptr<Work> begin(Lane lane, Turn turn);
  /// On the one with the least work of the lanes 0 to `lanes` - 1.
  [[nodiscard]] std::unique_ptr<Work> begin_on_one_of(std::size_t lanes, Turn turn);

 private:
  struct Thread {
    std::thread thread;
    bool runs = false;
    std::size_t works = 0;
    std::set<std::pair<Time, Work*>> waiting;
    std::condition_variable changed;
  };

  void run(Thread& self);
  // With the mutex held:
  std::unique_ptr<Work> add(Lane lane, Turn turn);
  Thread& started(Lane lane);
  void wait(Work& work, Time due);
  static void leave(Thread& thread);
  void move(Work& work, Lane lane);

  const char* const name_;
  std::mutex mutex_;
  std::map<Lane, Thread> lanes_;
  std::condition_variable turn_ended_;
};

}  // namespace sweepd
