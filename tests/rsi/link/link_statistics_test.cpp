#include "rsi/link/link_statistics.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <random>
#include <string>
#include <vector>

#include "tests/catch.hpp"
#include "tests/rsi/addresses.hpp"

using rsi::Arrival;
using rsi::LinkStatistics;
using namespace std::chrono_literals;
using rsi::test::kController;
using rsi::test::kRestarted;

namespace {

/// RestingLink statistics fed with telegrams of which only some things matter: a resting robot's.
struct RestingLink : LinkStatistics {
  Arrival add(std::uint64_t ipoc, const rsi::Endpoint& source, std::optional<std::uint64_t> delay) {
    return add(ipoc, "at rest", 0ms, source, delay);
  }
  Arrival add(std::uint64_t ipoc, const std::string& content, rsi::Timestamp time,
              const rsi::Endpoint& source = kController, std::optional<std::uint64_t> delay = {}) {
    return LinkStatistics::add({time, source, {}, content + std::to_string(ipoc), cut}, ipoc,
                               delay);
  }
  bool cut = false;
};

}  // namespace

TEST_CASE("the step of the IPOC is learned, for 4 and 12 ms and for simulators that count by one",
          "[link_statistics]") {
  for (const std::uint64_t step : {1u, 4u, 12u}) {
    RestingLink link;
    CHECK_FALSE(link.step());
    for (std::uint64_t k = 0; k < 100; ++k)
      if (k != 1 && k != 50) link.add(237433 + k * step, kController, {});
    CHECK(link.step() == step);
    CHECK(link.counts().telegrams == 98);
    CHECK(link.counts().lost == 2);
  }
}

TEST_CASE("the cycle is that of the stream, also where telegrams come in bursts",
          "[link_statistics][issue11][point_15]") {
  for (const int burst : {1, 2, 8}) {
    RestingLink link;
    for (int k = 0; k < 400; ++k) {
      const auto sent = 4ms * (k - k % burst + burst - 1);
      link.add(1000 + 4 * static_cast<std::uint64_t>(k), "", sent + 10us * (k % burst));
    }
    INFO("bursts of " << burst);
    REQUIRE(link.cycle());
    CHECK(*link.cycle() == 4ms);
  }
}

TEST_CASE("a telegram that came late is reordered, not lost; one that came again is a duplicate",
          "[link_statistics]") {
  RestingLink link;
  const auto add = [&](std::uint64_t ipoc) { return link.add(ipoc, kController, {}); };
  CHECK(add(1000) == Arrival::in_order);
  CHECK(add(1004) == Arrival::in_order);
  CHECK(add(1012) == Arrival::in_order);
  CHECK(link.counts().lost == 1);
  CHECK(add(1008) == Arrival::reordered);
  CHECK(link.counts().lost == 0);
  CHECK(add(1008) == Arrival::duplicate);
  CHECK(add(1012) == Arrival::duplicate);
  CHECK(add(996) == Arrival::reordered);
  CHECK(link.counts().reordered == 2);
  CHECK(link.counts().duplicated == 2);
  CHECK(link.counts().telegrams == 7);
}

TEST_CASE("an IPOC that jumps, or a new port, is a restart and not a loss", "[link_statistics]") {
  RestingLink link;
  for (std::uint64_t k = 0; k < 10; ++k) link.add(5'000'000 + 4 * k, kController, {});
  SECTION("back") {
    CHECK(link.add(100, kController, {}) == Arrival::restart);
  }
  SECTION("far ahead") {
    CHECK(link.add(9'000'000, kController, {}) == Arrival::restart);
  }
  SECTION("a new port") {
    CHECK(link.add(5'000'400, kRestarted, {}) == Arrival::restart);
  }
  CHECK(link.counts().restarts == 1);
  CHECK(link.counts().lost == 0);
}

TEST_CASE("RSI that begins anew in another cycle has lost nothing", "[link_statistics]") {
  const auto [before, after] = GENERATE(std::pair(4u, 12u), std::pair(12u, 4u), std::pair(1u, 4u));
  CAPTURE(before, after);
  RestingLink link;
  std::uint64_t ipoc = 5'000'000;
  for (int k = 0; k < 500; ++k) link.add(ipoc += before, kController, {});
  ipoc = GENERATE(100u, 8'000'000u);
  for (int k = 0; k < 200; ++k) {
    link.add(ipoc += after, kRestarted, {});
    CHECK(link.counts().lost == 0);
  }
  CHECK(link.counts().restarts == 1);
  CHECK(link.step() == before);
  ipoc += 3 * after;
  link.add(ipoc += after, kRestarted, {});
  CHECK(link.counts().lost == 3);
}

TEST_CASE("an IPOC that jumps ahead of the clock is a restart and not a loss",
          "[link_statistics]") {
  const std::uint64_t step = GENERATE(1u, 4u, 10u);
  const std::uint64_t jump = GENERATE(3'000u, 50'000u);
  CAPTURE(step, jump);
  RestingLink link;
  for (std::uint64_t k = 0; k < 600; ++k)
    link.add(5'000 + step * k + (k < 300 ? 0 : jump), "", k * 4ms);
  CHECK(link.counts().restarts == 1);
  CHECK(link.counts().lost == 0);
}

TEST_CASE("what was lost is counted as lost if the clock has time for it", "[link_statistics]") {
  constexpr std::uint64_t kLost = 150;
  const std::uint64_t step = GENERATE(1u, 4u, 10u, 15u);
  const std::uint64_t first = GENERATE(5'000u, ~std::uint64_t{5'000});  // it passes 2^64, too
  CAPTURE(first, step);
  RestingLink link;
  const auto stream = [&](const auto& time) {
    for (std::uint64_t k = 0; k < 2000; ++k)
      if (k < 700 || k >= 700 + kLost) link.add(first + step * k, "", time(k, k * 4ms));
  };
  SECTION("as the telegrams are sent") {
    stream([](auto, rsi::Timestamp sent) { return sent; });
  }
  SECTION("behind a pause of who stamps them: they come late, and all at once") {
    stream([](auto k, rsi::Timestamp sent) { return k < 500 ? sent : std::max(sent, 4s + 0ns); });
  }
  SECTION("with a clock that was set back before") {
    stream([](auto k, rsi::Timestamp sent) { return 1h + sent - (k < 690 ? 0s : 10s); });
  }
  SECTION("with a clock that was set back in the gap") {
    stream([](auto k, rsi::Timestamp sent) { return 1h + sent - (k < 700 ? 0s : 10s); });
  }
  CHECK(link.counts().lost == kLost);
  CHECK(link.counts().restarts == 0);
}

TEST_CASE("coarse stamps make no restart of a gap, and no other unit", "[link_statistics]") {
  const rsi::Timestamp tick = GENERATE(16ms, 100ms, 1000ms);
  CAPTURE(tick.count());
  RestingLink link;
  for (std::uint64_t k = 0; k < 2000; ++k)
    if (k < 700 || k >= 850) link.add(1000 + 4 * k, "", rsi::Timestamp(k * 4ms) / tick * tick);
  CHECK(link.counts().lost == 150);
  CHECK(link.counts().restarts == 0);
  CHECK(link.unit() == 1ms);
}

TEST_CASE("an IPOC that passes 2^64 is neither a restart nor a loss, whatever its step",
          "[link_statistics]") {
  for (const std::uint64_t step : {1u, 4u, 12u, 15u}) {
    INFO("step " << step);
    RestingLink link;
    // Before it and after it telegrams are lost, and over it two are swapped.
    const auto add = [&](std::uint64_t k) { return link.add((k - 500) * step, kController, {}); };
    for (std::uint64_t k = 0; k < 499; ++k)
      if (k != 490) CHECK(add(k) == Arrival::in_order);
    CHECK(add(500) == Arrival::in_order);
    CHECK(add(499) == Arrival::reordered);
    CHECK(add(499) == Arrival::duplicate);
    CHECK(add(500) == Arrival::duplicate);
    for (std::uint64_t k = 501; k < 1000; ++k)
      if (k != 510) CHECK(add(k) == Arrival::in_order);
    CHECK(link.step() == step);
    CHECK(link.counts().lost == 2);
    CHECK(link.counts().reordered == 1);
    CHECK(link.counts().duplicated == 2);
    CHECK(link.counts().restarts == 0);
  }
}

TEST_CASE("the greatest IPOC of all is one like any other", "[link_statistics]") {
  RestingLink link;
  constexpr auto kGreatest = ~std::uint64_t{0};
  CHECK(link.add(kGreatest - 1, kController, {}) == Arrival::in_order);
  CHECK(link.add(kGreatest, kController, {}) == Arrival::in_order);
  CHECK(link.add(kGreatest, kController, {}) == Arrival::duplicate);
}

TEST_CASE("a gap within a run is counted telegram by telegram, also over several restarts",
          "[link_statistics]") {
  RestingLink link;
  for (const std::uint64_t start : {1'000'000u, 100u, 700'000u})
    for (std::uint64_t k = 0; k < 1000; ++k)
      if (k % 100 != 50) link.add(start + 12 * k, kController, {});
  CHECK(link.counts().restarts == 2);
  CHECK(link.counts().lost == 30);
}

TEST_CASE("RSI that begins anew from an IPOC it had a moment ago is one restart and no duplicate",
          "[link_statistics][issue11][point_13]") {
  // 750 telegrams each time, which is less than 4,096 ms.
  const auto run = [](RestingLink& link, std::uint64_t first, const char* content,
                      rsi::Timestamp from) {
    std::vector<Arrival> arrivals;
    for (std::uint64_t k = 0; k < 750; ++k)
      arrivals.push_back(link.add(first + 4 * k, content, from + k * 4ms));
    return arrivals;
  };
  for (const std::uint64_t fall : {3000u, 2998u, 400u, 64u})
    for (const char* content : {"moved", "at rest"}) {
      CAPTURE(fall, content);
      RestingLink link;
      run(link, 100'000, "at rest", 0s);
      auto arrivals = run(link, 100'000 + 3000 - fall, content, 10s);
      CHECK(arrivals[0] == Arrival::restart);
      arrivals[0] = Arrival::in_order;
      CHECK(arrivals == std::vector<Arrival>(750, Arrival::in_order));
      CHECK(link.counts().restarts == 1);
      CHECK(link.counts().duplicated == 0);
      CHECK(link.counts().reordered == 0);
      CHECK(link.counts().lost == 0);
    }
}

TEST_CASE(
    "a telegram that was overtaken is no restart, though the cycle is not known yet, or another",
    "[link_statistics][issue11][point_13]") {
  RestingLink link;
  CHECK(link.add(100, "a", 0ms) == Arrival::in_order);
  CHECK(link.add(108, "c", 8ms) == Arrival::in_order);
  CHECK(link.add(104, "b", 9ms) == Arrival::reordered);
  // RSI begins anew in IPO_FAST after a long time in IPO.
  for (std::uint64_t k = 0; k < 1000; ++k) link.add(100'000 + 12 * k, "slow", 1s + k * 12ms);
  for (std::uint64_t k = 0; k < 100; ++k) link.add(4 * k, "fast", 20s + k * 4ms);
  CHECK(link.add(404, "swapped", 20s + 404ms) == Arrival::in_order);
  CHECK(link.add(400, "swapped", 20s + 405ms) == Arrival::reordered);
}

TEST_CASE("without times the content tells a restart from a copy",
          "[link_statistics][issue11][point_13]") {
  RestingLink link;
  for (std::uint64_t k = 0; k < 100; ++k) link.add(1000 + 4 * k, "before", {});
  CHECK(link.add(1200, "before", {}) == Arrival::duplicate);
  CHECK(link.add(1200, "after", {}) == Arrival::restart);
  CHECK(link.add(1204, "after", {}) == Arrival::in_order);
}

TEST_CASE("copies that come late or damaged, and an IPOC that stands still, are no restart",
          "[link_statistics][issue11][point_13]") {
  RestingLink link;
  for (std::uint64_t k = 0; k < 100; ++k) link.add(1000 + 4 * k, "moves", k * 4ms);
  CHECK(link.add(1200, "moves", 396ms + 800ms) == Arrival::duplicate);
  link.cut = true;
  CHECK(link.add(1200, "mov", 400ms) == Arrival::duplicate);
  link.cut = false;
  CHECK(link.add(1396, "stands", 400ms) == Arrival::duplicate);
  CHECK(link.add(1400, "moves", 404ms) == Arrival::in_order);
  CHECK(link.counts().restarts == 0);
  CHECK(link.counts().lost == 0);
}

TEST_CASE("the controller's Delay counts runs of late replies", "[link_statistics]") {
  RestingLink link;
  std::uint64_t ipoc = 0;
  for (const std::uint64_t delay : {0u, 1u, 2u, 0u, 1u, 0u, 0u, 1u, 2u, 3u, 4u, 0u})
    link.add(ipoc += 4, kController, delay);
  CHECK(link.counts().late_replies == 7);
  CHECK(link.counts().late_runs == 3);
  CHECK(link.counts().longest_late_run == 4);
}

TEST_CASE("replies that the controller missed before its first telegram was seen are counted apart",
          "[link_statistics]") {
  RestingLink link;
  std::uint64_t ipoc = 0;
  const auto add = [&](std::uint64_t delay) { link.add(ipoc += 4, kController, delay); };
  add(248);
  CHECK(link.counts().late_replies == 0);
  CHECK(link.counts().missed_before == 248);
  CHECK(link.counts().late_runs == 0);
  add(249);
  add(250);
  CHECK(link.counts().late_replies == 2);
  CHECK(link.counts().late_runs == 1);
  CHECK(link.counts().longest_late_run == 2);
  for (const std::uint64_t delay : {0u, 1u, 0u}) add(delay);
  CHECK(link.counts().late_replies == 3);
  CHECK(link.counts().late_runs == 2);
  CHECK(link.counts().longest_late_run == 2);
  CHECK(link.counts().missed_before == 248);
}

TEST_CASE("runs of late replies are told apart even if what came between them was lost",
          "[link_statistics]") {
  RestingLink link;
  const auto add = [&](std::uint64_t cycle, std::uint64_t delay) {
    link.add(1000 + 4 * cycle, kController, delay);
  };
  for (std::uint64_t cycle = 0; cycle < 10; ++cycle) add(cycle, 0);
  add(11, 1);  // the reply to cycle 10 was late: one
  add(14, 2);  // the Delay of 12 must have been 0, and 12 and 13 were late: two more
  add(17, 5);  // so were 14 to 16: three more in the same run
  add(18, 0);
  CHECK(link.counts().late_replies == 6);
  CHECK(link.counts().late_runs == 2);
  CHECK(link.counts().longest_late_run == 5);
}

TEST_CASE("loss, duplication and exchange at random are counted exactly", "[link_statistics]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<> chance;
  constexpr std::uint64_t kCycles = 100'000;
  std::uint64_t lost = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t swapped = 0;
  std::vector<std::uint64_t> kept;
  for (std::uint64_t k = 0; k < kCycles; ++k) {
    if (k > 0 && k + 1 < kCycles && chance(random) < 0.01)
      ++lost;
    else
      kept.push_back(1'525'084 + 4 * k);
  }
  RestingLink link;
  const auto send = [&](std::uint64_t ipoc) {
    link.add(ipoc, kController, {});
    if (chance(random) < 0.005) {
      ++duplicated;
      link.add(ipoc, kController, {});
    }
  };
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (i + 1 < kept.size() && chance(random) < 0.005) {
      ++swapped;
      send(kept[i + 1]);
      send(kept[i]);
      ++i;
    } else {
      send(kept[i]);
    }
  }
  CHECK(link.step() == 4u);
  CHECK(link.counts().telegrams == kept.size() + duplicated);
  CHECK(link.counts().lost == lost);
  CHECK(link.counts().duplicated == duplicated);
  CHECK(link.counts().reordered == swapped);
}

TEST_CASE("whether the IPOC counts milliseconds is told by the clock", "[link_statistics]") {
  struct Kind {
    std::uint64_t step;
    std::chrono::nanoseconds cycle;
    bool counts_ms;
    std::uint64_t known_by;
  };
  const auto kind = GENERATE(Kind{4, 4ms, true, 1}, Kind{12, 12ms, true, 1}, Kind{1, 4ms, false, 2},
                             Kind{2, 4ms, false, 65}, Kind{10, 4ms, false, 7},
                             Kind{400, 4ms, false, 2}, Kind{4000, 4ms, false, 2});
  CAPTURE(kind.step, kind.cycle.count());
  RestingLink link;
  for (std::uint64_t k = 0; k < 3000; ++k) {
    link.add(1000 + kind.step * k, "", static_cast<std::int64_t>(k) * kind.cycle);
    CAPTURE(k);
    if (k + 1 >= kind.known_by) REQUIRE(link.counts_ms() == kind.counts_ms);
  }
  CHECK((link.unit() == 1ms) == kind.counts_ms);
}

TEST_CASE("telegrams faster than any controller's tell nothing of the IPOC, and gaps are losses",
          "[link_statistics]") {
  RestingLink link;
  std::uint64_t lost = 0;
  for (std::uint64_t k = 0; k < 3000; ++k) {
    if (k >= 1000 && k < 1200) {  // more than 200 ms at the pace of its IPOC
      ++lost;
      continue;
    }
    link.add(1000 + 4 * k, "", static_cast<std::int64_t>(k) * 20us);
    REQUIRE(link.counts_ms());
  }
  CHECK(link.counts().restarts == 0);
  CHECK(link.counts().lost == lost);
}

TEST_CASE("a first telegram that is 15 ms late makes an IPOC of milliseconds no other",
          "[link_statistics]") {
  RestingLink link;
  for (std::uint64_t k = 0; k < 300; ++k) {
    link.add(1000 + 4 * k, "", k == 0 ? 15ms : std::max<std::chrono::milliseconds>(k * 4ms, 15ms));
    REQUIRE(link.counts_ms());
  }
}

namespace {

std::chrono::nanoseconds unit(std::vector<std::chrono::nanoseconds> per_count) {
  return rsi::ipoc_unit(per_count);
}

}  // namespace

TEST_CASE("an IPOC that counts milliseconds has a unit of exactly one", "[link_statistics]") {
  CHECK(unit({}) == 1ms);
  CHECK(unit({1007us, 998us, 700us, 1001us, 90ms}) == 1ms);
  CHECK(unit({1250us}) == 1ms);
  CHECK(unit({750us}) == 1ms);
  CHECK(unit({0us, 0us, 5us}) == 1ms);  // no times
}

TEST_CASE("any other IPOC has the median for its unit, however wild the rest is",
          "[link_statistics]") {
  CHECK(unit({4ms, 4001us, 3ms, 9s, 4002us}) == 4001us);
  CHECK(unit({2us}) == 2us);
  CHECK(unit({std::chrono::nanoseconds::max()}) == 1h);
}

TEST_CASE("the median alone decides on the unit, be it found or known to be near by counting",
          "[link_statistics]") {
  std::mt19937 random(11);
  const std::array some{0us, 749us, 750us, 1000us, 1250us, 1251us, 4000us};
  for (int k = 0; k < 5000; ++k) {
    std::vector<std::chrono::nanoseconds> times(1 + random() % 9);
    for (auto& time : times) time = some[random() % some.size()];
    auto sorted = times;
    std::sort(sorted.begin(), sorted.end());
    const auto median = sorted[sorted.size() / 2];
    const bool milliseconds = median == 0us || (median >= 750us && median <= 1250us);
    REQUIRE(unit(times) == (milliseconds ? 1ms : median));
  }
}
