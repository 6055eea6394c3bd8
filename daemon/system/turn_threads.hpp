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

/// Threads that do the work of many in turns. Work is of a group, and stays with one thread of that
/// group for as long as it is. A group has another thread where its threads have much to do, and
/// none without work. Of those whose time has come, the next turn is that of who waited longest. A
/// turn that stands still holds up what is with its thread, and never another group.
class TurnThreads {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Group = std::uint64_t;

  struct Next {
    Time due;                         ///< there is no turn before, unless it is woken
    std::optional<Group> group = {};  ///< of this one from now on, if the system has a thread
  };
  /// Does what is to be done now. Where it throws, that is said once, and the next turn is a second
  /// later.
  using Turn = std::function<Next()>;

  class Work {
    using Place = std::pair<Group, std::size_t>;  // one thread of the group

   public:
    /// Waits for the turn under way, which is the last one. Not in a turn.
    ~Work();
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

    /// A turn that has not begun yet is due. Any thread; no turn is waited for.
    void wake();
    /// In a turn: its own.
    [[nodiscard]] Group group() const { return at_.first; }

   private:
    friend TurnThreads;
    Work(TurnThreads& threads, Place at, Turn turn)
        : threads_(threads), turn_(std::move(turn)), at_(at) {}

    TurnThreads& threads_;
    const Turn turn_;
    // The mutex guards these.
    Place at_;
    Time due_{};
    bool in_turn_ = false;
    bool woken_ = false;   // meanwhile
    bool ending_ = false;  // behind this turn
    bool failed_ = false;  // of its thread: a turn threw, and that was said
  };

  /// `name`: of 15 letters at most, of all the threads. A group has at most `most` of them, and
  /// another one only where each has that many `works`.
  TurnThreads(const char* name, std::size_t most, std::size_t works)
      : name_(name), most_(most), works_(works) {}
  ~TurnThreads();  ///< after all work
  TurnThreads(const TurnThreads&) = delete;
  TurnThreads& operator=(const TurnThreads&) = delete;

  /// Its first turn is due. From now on all threads keep off the processors that the calling one
  /// keeps off. Throws std::system_error where the system has no thread to give.
  [[nodiscard]] std::unique_ptr<Work> begin(Group group, Turn turn);

 private:
  struct Thread {
    std::thread thread;
    bool runs = false;
    std::size_t works = 0;
    std::set<std::pair<Time, Work*>> waiting;
    std::condition_variable changed;
  };

  void run(Thread& self);
  Next turn_of(Work& work) const;
  // With the mutex held:
  /// A thread that runs, with one more work.
  Work::Place taken_on(Group group);
  void wait(Work& work, Time due);
  static void leave(Thread& thread);
  void move(Work& work, Group group);

  const char* const name_;
  const std::size_t most_;
  const std::size_t works_;
  std::mutex mutex_;
  std::map<Work::Place, Thread> threads_;
  std::condition_variable turn_ended_;
};

}  // namespace sweepd
