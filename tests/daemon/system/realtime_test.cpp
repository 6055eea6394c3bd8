#include "daemon/system/realtime.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include <sched.h>
#include <sys/resource.h>

#include "tests/catch.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::RealTimeReport;

namespace {

/// In a thread of its own, which takes what was set with it.
RealTimeReport entered(const sweepd::RealTimeSettings& settings, int& policy, cpu_set_t& cpus) {
  RealTimeReport report;
  std::thread([&] {
    sweepd::enter_real_time(settings, report);
    policy = sched_getscheduler(0);
    sched_getaffinity(0, sizeof cpus, &cpus);
  }).join();
  return report;
}

bool has(const std::vector<std::string>& texts, const std::string& wanted) {
  for (const auto& text : texts)
    if (text.find(wanted) != text.npos) return true;
  return false;
}

}  // namespace

TEST_CASE("a thread is put under SCHED_FIFO, or told what has to be permitted", "[realtime]") {
  sweepd::RealTimeSettings settings;
  settings.priority = 7;
  int policy = -1;
  cpu_set_t cpus;
  const auto report = entered(settings, policy, cpus);
  if (policy == SCHED_FIFO) {
    CHECK(has(report.granted, "SCHED_FIFO 7"));
    CHECK(report.refused.empty());
  } else {
    REQUIRE(has(report.refused, "SCHED_FIFO 7 is not permitted"));
    CHECK(has(report.refused, "LimitRTPRIO=7"));
    CHECK(report.granted.empty());
  }
}

TEST_CASE("a thread is put on its processors, and those that do not exist are refused",
          "[realtime]") {
  cpu_set_t all;
  REQUIRE(sched_getaffinity(0, sizeof all, &all) == 0);
  int first = 0;
  while (!CPU_ISSET(static_cast<std::size_t>(first), &all)) ++first;
  sweepd::RealTimeSettings settings;
  settings.cpus = {first};
  int policy = -1;
  cpu_set_t cpus;
  CHECK(has(entered(settings, policy, cpus).granted, "processors " + std::to_string(first)));
  CHECK(CPU_COUNT(&cpus) == 1);
  CHECK(CPU_ISSET(static_cast<std::size_t>(first), &cpus));

  settings.wish = sweepd::RealTime::off;
  CHECK(entered(settings, policy, cpus).granted ==
        std::vector<std::string>{"processors " + std::to_string(first)});
  CHECK(CPU_COUNT(&cpus) == 1);
  CHECK(policy == SCHED_OTHER);

  settings.cpus = {first, 1023};
  CHECK(has(entered(settings, policy, cpus).refused, "1023] is not possible"));
  settings.cpus = {1023};
  CHECK(has(entered(settings, policy, cpus).refused, "lscpu -e"));
}

TEST_CASE("other threads keep off the reply thread's processors, unless no other would be left",
          "[realtime]") {
  cpu_set_t all;
  REQUIRE(sched_getaffinity(0, sizeof all, &all) == 0);
  std::vector<int> existing;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &all)) existing.push_back(cpu);
  cpu_set_t after_one, after_all;
  std::thread([&] {
    sweepd::leave_processors(existing);
    sched_getaffinity(0, sizeof after_all, &after_all);
    sweepd::leave_processors({existing.front()});
    std::thread([&] { sched_getaffinity(0, sizeof after_one, &after_one); }).join();
  }).join();
  CHECK(CPU_EQUAL(&after_all, &all));
  if (existing.size() > 1) {
    CHECK(CPU_COUNT(&after_one) == static_cast<int>(existing.size()) - 1);
    CHECK_FALSE(CPU_ISSET(static_cast<std::size_t>(existing.front()), &after_one));
  }
}

TEST_CASE(
    "work that can wait takes a low share, never none, and work that is waited for a fair one",
    "[realtime][issue11][point_17]") {
  const auto taken = [](sweepd::Share share) {
    int policy = -1;
    int nice = -1;
    std::thread([&] {
      sweepd::take(share);
      policy = sched_getscheduler(0);
      nice = getpriority(PRIO_PROCESS, 0);
    }).join();
    return std::pair(policy, nice);
  };
  const int own = getpriority(PRIO_PROCESS, 0);
  CHECK(taken(sweepd::Share::low) == std::pair(SCHED_BATCH, std::min(own + 10, 19)));
  CHECK(taken(sweepd::Share::fair) == std::pair(SCHED_BATCH, own));
  CHECK(sched_getscheduler(0) != SCHED_BATCH);
  CHECK(getpriority(PRIO_PROCESS, 0) == own);
}
