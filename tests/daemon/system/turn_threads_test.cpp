#include "daemon/system/turn_threads.hpp"

#include <algorithm>
#include <atomic>
#include <future>
#include <memory>
#include <new>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <sched.h>

#include "tests/catch.hpp"
#include "tests/eventually.hpp"
#include "tests/process_threads.hpp"

using sweepd::TurnThreads;
using Next = TurnThreads::Next;
using Steady = std::chrono::steady_clock;
using sweepd::test::eventually;
using namespace std::chrono_literals;

namespace {

constexpr auto kNever = TurnThreads::Time::max();

/// Holds up the thread that comes here until it is let go.
class HeldTurn {
 public:
  ~HeldTurn() { let_go(); }
  Next operator()() {
    if (!held_.exchange(true)) {
      entered_.set_value();
      left_.get_future().wait();
    }
    return {kNever};
  }
  void wait_until_held() { entered_.get_future().wait(); }
  void let_go() {
    if (!gone_.exchange(true)) left_.set_value();
  }

 private:
  std::atomic<bool> held_{false}, gone_{false};
  std::promise<void> entered_, left_;
};

/// Threads of this process that bear a name.
int threads_named(const std::string& name) {
  const auto threads = sweepd::test::threads_of();
  return static_cast<int>(std::count_if(threads.begin(), threads.end(),
                                        [&](const auto& thread) { return thread.name == name; }));
}

}  // namespace

TEST_CASE("a turn that throws ends neither the thread nor the work of others", "[turn_threads]") {
  TurnThreads threads("test", 1, 8);
  std::atomic<int> failed{0}, others{0};
  const auto failing = threads.begin(0, [&]() -> Next {
    ++failed;
    throw std::bad_alloc();
  });
  const auto other = threads.begin(0, [&] { return ++others, Next{Steady::now() + 1ms}; });
  CHECK(eventually([&] { return failed == 1 && others > 10; }));
  failing->wake();
  CHECK(eventually([&] { return failed > 1; }));
}

TEST_CASE("work has a turn at first, when it is due, and when it is woken", "[turn_threads]") {
  TurnThreads threads("test", 1, 1);
  std::atomic<int> turns{0};
  std::atomic<int> at_once{3};
  const auto work = threads.begin(0, [&] {
    ++turns;
    return Next{at_once-- > 0 ? Steady::now() : kNever};
  });
  CHECK(eventually([&] { return turns == 4; }));
  work->wake();
  CHECK(eventually([&] { return turns == 5; }));
}

TEST_CASE("of those with one thread who has waited longest is the next, and turns never overlap",
          "[turn_threads]") {
  TurnThreads threads("test", 1, 1);
  HeldTurn held;
  const auto first = threads.begin(0, [&] { return held(); });
  held.wait_until_held();
  std::vector<int> order;  // of one thread: a race is seen by ThreadSanitizer
  std::atomic<int> turns{0};
  std::vector<std::unique_ptr<TurnThreads::Work>> works;
  for (int k = 0; k < 5; ++k)
    works.push_back(threads.begin(0, [&, k, again = true]() mutable {
      order.push_back(k);
      ++turns;
      // It comes again behind those who wait already.
      return Next{std::exchange(again, false) ? Steady::now() : kNever};
    }));
  held.let_go();
  REQUIRE(eventually([&] { return turns == 10; }));
  works.clear();
  CHECK(order == std::vector<int>{0, 1, 2, 3, 4, 0, 1, 2, 3, 4});
}

TEST_CASE("who is woken in its turn has another one", "[turn_threads]") {
  TurnThreads threads("test", 1, 1);
  HeldTurn held;
  std::atomic<int> turns{0};
  const auto work = threads.begin(0, [&] {
    ++turns;
    return held();
  });
  held.wait_until_held();
  work->wake();
  held.let_go();
  CHECK(eventually([&] { return turns == 2; }));
}

TEST_CASE("a turn that stands still holds up its own group alone", "[turn_threads]") {
  TurnThreads threads("test", 1, 1);
  HeldTurn held;
  const auto first = threads.begin(7, [&] { return held(); });
  held.wait_until_held();
  std::atomic<int> same{0};
  std::atomic<int> other{0};
  const auto behind = threads.begin(7, [&] {
    ++same;
    return Next{kNever};
  });
  const auto beside = threads.begin(8, [&] {
    ++other;
    return Next{kNever};
  });
  CHECK(eventually([&] { return other == 1; }));
  beside->wake();
  CHECK(eventually([&] { return other == 2; }));
  CHECK(same == 0);
  held.let_go();
  CHECK(eventually([&] { return same == 1; }));
}

TEST_CASE("work may go to another group, and leaves a turn that stands still behind",
          "[turn_threads]") {
  TurnThreads threads("test", 1, 1);
  std::atomic<TurnThreads::Group> group{0};
  std::unique_ptr<TurnThreads::Work> work;
  std::promise<void> begun;
  auto ready = begun.get_future().share();
  work = threads.begin(1, [&] {
    ready.wait();
    group = work->group();
    return Next{kNever, 2};
  });
  begun.set_value();
  REQUIRE(eventually([&] { return group == 1; }));
  HeldTurn held;
  const auto old = threads.begin(1, [&] { return held(); });
  held.wait_until_held();
  work->wake();
  CHECK(eventually([&] { return group == 2; }));
  held.let_go();
}

TEST_CASE("the end of work waits for its turn, and it has no other", "[turn_threads]") {
  TurnThreads threads("test", 1, 1);
  HeldTurn held;
  std::atomic<int> turns{0};
  auto work = threads.begin(0, [&] {
    ++turns;
    held();
    return Next{Steady::now()};
  });
  held.wait_until_held();
  std::atomic<bool> ended{false};
  std::thread end([&] {
    work.reset();
    ended = true;
  });
  CHECK_FALSE(ended);
  held.let_go();
  end.join();
  const int then = turns;
  // Another one of the group has its turns: so would this.
  std::atomic<int> others{0};
  const auto other = threads.begin(0, [&] { return Next{++others < 3 ? Steady::now() : kNever}; });
  CHECK(eventually([&] { return others == 3; }));
  CHECK(turns == then);
}

TEST_CASE("a group has another thread where there is much work, and none without",
          "[turn_threads]") {
  TurnThreads threads("test-turns", 3, 2);
  const auto names = [] { return threads_named("test-turns"); };
  const auto begin = [&](TurnThreads::Group group) {
    return threads.begin(group, [] { return Next{kNever}; });
  };
  std::vector<std::unique_ptr<TurnThreads::Work>> works;
  for (const int expected : {1, 1, 2, 2, 3, 3, 3, 3, 3}) {
    works.push_back(begin(7));
    CHECK(eventually([&] { return names() == expected; }));
  }
  works.push_back(begin(8));
  CHECK(eventually([&] { return names() == 4; }));
  works.clear();
  CHECK(eventually([&] { return names() == 0; }));
  works.push_back(begin(7));
  CHECK(eventually([&] { return names() == 1; }));
}

TEST_CASE("the threads of a group share its work evenly", "[turn_threads]") {
  TurnThreads threads("test", 2, 1);
  HeldTurn held;
  const auto first = threads.begin(0, [&] { return held(); });
  held.wait_until_held();
  std::atomic<int> turns{0};
  std::vector<std::unique_ptr<TurnThreads::Work>> works;
  for (int k = 0; k < 7; ++k)
    works.push_back(threads.begin(0, [&] {
      ++turns;
      return Next{kNever};
    }));
  CHECK(eventually([&] { return turns == 4; }));  // those with the other thread
  held.let_go();
  CHECK(eventually([&] { return turns == 7; }));
}

TEST_CASE("the threads keep off the processors that whoever brings work keeps off",
          "[turn_threads]") {
  cpu_set_t all;
  REQUIRE(sched_getaffinity(0, sizeof all, &all) == 0);
  if (CPU_COUNT(&all) < 2) return;
  std::size_t first = 0;
  while (!CPU_ISSET(first, &all)) ++first;
  TurnThreads threads("test", 1, 1);
  cpu_set_t seen;
  std::atomic<int> turns{0};
  const auto work = threads.begin(0, [&] {
    sched_getaffinity(0, sizeof seen, &seen);
    ++turns;
    return Next{kNever};
  });
  REQUIRE(eventually([&] { return turns == 1; }));
  CHECK(CPU_EQUAL(&seen, &all));
  std::unique_ptr<TurnThreads::Work> other;
  std::thread([&] {
    cpu_set_t fewer = all;
    CPU_CLR(first, &fewer);
    sched_setaffinity(0, sizeof fewer, &fewer);
    other = threads.begin(1, [] { return Next{kNever}; });
  }).join();
  work->wake();
  REQUIRE(eventually([&] { return turns == 2; }));
  CHECK_FALSE(CPU_ISSET(first, &seen));
  CHECK(CPU_COUNT(&seen) == CPU_COUNT(&all) - 1);
}
