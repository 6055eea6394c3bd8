#include "rsi/link/link.hpp"

#include <random>

#include "tests/catch.hpp"
#include "tests/rsi/link_stream.hpp"

using rsi::LinkReport;
using rsi::Place;
using namespace rsi::test;
using std::chrono::nanoseconds;

namespace {

struct MonitoredLink {
  rsi::Link monitor;
  LinkStream<rsi::Link> stream{monitor};
  [[nodiscard]] LinkReport report() const { return monitor.report(); }
};

void check_place(const Place& place, nanoseconds at, std::uint64_t ipoc, std::int64_t amount) {
  CHECK(place.at == at);
  CHECK(place.ipoc == ipoc);
  CHECK(place.amount == amount);
}

std::uint64_t fates(const rsi::ReplyCounts& replies) {
  return replies.in_time + replies.not_in_time();
}

}  // namespace

TEST_CASE("nothing seen is an empty report", "[link]") {
  const auto report = rsi::Link().report();
  CHECK(report.link.telegrams == 0);
  CHECK(report.duration == 0ns);
  CHECK_FALSE(report.step);
  CHECK(report.cycle == 0ns);
  CHECK(report.jitter.count() == 0);
}

TEST_CASE("a flawless link has a cycle, no jitter, and the latency of its replies", "[link]") {
  MonitoredLink link;
  // More than the monitor keeps, so that most is settled on the way.
  link.stream.cycles(0, 5000, 70us);
  const auto report = link.report();
  CHECK(report.start == kStart);
  CHECK(report.duration == 4999 * 4ms);
  CHECK(report.link.telegrams == 5000);
  CHECK(report.step == 4u);
  CHECK(report.cycle == 4ms);
  CHECK(report.ipoc_counts_ms);
  CHECK(report.link.late_replies == 0U);
  CHECK(report.jitter.count() == 4999);
  CHECK(report.jitter.max() == 0ns);
  CHECK(report.replies.sent == 5000);
  CHECK(report.replies.in_time == 5000);
  CHECK(report.replies.not_in_time() == 0);
  CHECK(report.latency.count() == 5000);
  CHECK(report.latency.max() == 70us);
  CHECK(report.silent_runs.empty());
  CHECK(report.clock_steps == 0);
}

TEST_CASE("a report on the way changes nothing", "[link]") {
  MonitoredLink link;
  MonitoredLink undisturbed;
  for (std::uint64_t k = 0; k < 3000; ++k) {
    for (auto* one : {&link, &undisturbed}) one->stream.cycles(k, k + 1, k % 7 * 1us);
    if (k % 100 == 99) CHECK(link.report().replies.in_time == k + 1);
  }
  CHECK(link.report().latency.quantile(0.5) == undisturbed.report().latency.quantile(0.5));
  CHECK(link.report().jitter.count() == undisturbed.report().jitter.count());
}

TEST_CASE("what is settled is not taken back", "[link]") {
  MonitoredLink link;
  link.stream.cycles(0, 100);
  link.stream.telegram(400ms, link.stream.ipoc(100));
  link.stream.clock_off = 1s;  // the clock is set: the reply seems late until telegrams follow
  link.stream.reply(400ms + 50us, link.stream.ipoc(100));
  CHECK(link.report().replies.late == 1);
  CHECK(link.monitor.reports().settled.replies.late == 0);
  CHECK(link.monitor.reports().settled.replies.in_time == 101 - rsi::Link::kUnsettled);
  rsi::ReplyCounts before;
  for (std::uint64_t k = 101; k < 2500; ++k) {
    link.stream.cycles(k, k + 1, k % 9 == 0 ? 5ms : 50us);
    const auto [now, settled] = link.monitor.reports();
    CHECK(now.replies.late == link.report().replies.late);
    CHECK(now.replies.in_time == link.report().replies.in_time);
    CHECK(now.latency.count() == link.report().latency.count());
    CHECK(now.duration == link.report().duration);
    CHECK(settled.link.telegrams == k + 1);
    CHECK(settled.replies.in_time >= before.in_time);
    CHECK(settled.replies.late >= before.late);
    CHECK(settled.replies.not_in_time() == settled.replies.late);
    before = settled.replies;
  }
  CHECK(link.report().replies.late == 266);  // the multiples of 9 from 101 to 2499
}

TEST_CASE("the cycle is 4 or 12 ms by the IPOC, and by the clock where IPOC rises by one",
          "[link]") {
  std::mt19937 random(7);
  std::normal_distribution<> jitter_us(0, 30);
  struct Kind {
    std::uint64_t step;
    nanoseconds cycle;
    bool counts_ms;
  };
  for (const auto& kind : {Kind{4, 4ms, true}, Kind{12, 12ms, true}, Kind{1, 4ms, false},
                           Kind{4, 40ms, false}, Kind{1, 1ms, true}}) {
    CAPTURE(kind.step, kind.cycle.count());
    MonitoredLink link;
    for (std::uint64_t k = 0; k < 2000; ++k) {
      const auto at = static_cast<std::int64_t>(k) * kind.cycle +
                      nanoseconds(static_cast<std::int64_t>(1e3 * jitter_us(random)));
      link.stream.telegram(at, 77 + kind.step * k);
      link.stream.reply(at + 20us, 77 + kind.step * k);
    }
    const auto report = link.report();
    CHECK(report.step == kind.step);
    CHECK(report.ipoc_counts_ms == kind.counts_ms);
    // A median of 1000 or so differences with sigma 42 us is good to 1.25 * 42 / sqrt(1000) = 1.7.
    const auto margin = kind.counts_ms ? 0ns : 10us;
    CHECK(std::chrono::abs(report.cycle - kind.cycle) <= margin);
    // Size of a difference of two times with sigma 30 us: its median is 0.6745 * sqrt(2) * 30.
    CHECK(static_cast<double>(report.jitter.quantile(0.5).count()) == Approx(28'600).epsilon(0.1));
    CHECK(report.clock_steps == 0);
    CHECK(report.replies.in_time == 2000);
  }
}

TEST_CASE("jitter is the time between telegrams minus the IPOC's rise, early and late", "[link]") {
  MonitoredLink link;
  link.stream.cycles(0, 100);
  link.stream.telegram(LinkStream<rsi::Link>::at(100) + 1500us, 1'000'400);
  link.stream.reply(402ms, 1'000'400);
  link.stream.cycles(101, 200);
  const auto report = link.report();
  CHECK(report.latest == 1500us);
  CHECK(report.earliest == -1500us);
  CHECK(report.jitter.count() == 199);
  CHECK(report.jitter.max() == 1500us);
  CHECK(report.jitter.quantile(197.0 / 199) == 0ns);
}

TEST_CASE("quantiles of the latency are those put in, and the ten slowest are named", "[link]") {
  MonitoredLink link;
  // 1000 latencies of 1 to 1000 us, in a mixed order.
  for (std::uint64_t k = 0; k < 1000; ++k)
    link.stream.cycles(k, k + 1,
                       nanoseconds(1000 * (1 + static_cast<std::int64_t>(k * 387 % 1000))));
  const auto report = link.report();
  for (const double q : {0.1, 0.5, 0.9, 0.99})
    CHECK(static_cast<double>(report.latency.quantile(q).count()) ==
          Approx(1e6 * q).epsilon(1.0 / 128));
  const auto slowest = report.slowest.places();
  REQUIRE(slowest.size() == 10);
  for (std::size_t i = 0; i < 10; ++i) {
    const auto us = 1000 - static_cast<std::int64_t>(i);
    CHECK(slowest[i].amount == 1000 * us);
    // The inverse of 387 modulo 1000 is 323.
    const auto k = static_cast<std::uint64_t>(us - 1) * 323 % 1000;
    CHECK(slowest[i].ipoc == 1'000'000 + 4 * k);
    CHECK(slowest[i].at == std::chrono::milliseconds(4 * k));
  }
}

TEST_CASE("a reply later than a cycle is late, and counts in the run of those not in time",
          "[link]") {
  MonitoredLink link;
  link.stream.cycles(0, 50);
  link.stream.cycles(50, 53, 4001us);
  link.stream.cycles(53, 100, 4000us);
  const auto report = link.report();
  CHECK(report.replies.late == 3);
  CHECK(report.replies.in_time == 97);
  REQUIRE(report.silent_runs.places().size() == 1);
  check_place(report.silent_runs.worst(), 200ms, 1'000'200, 3);
}

TEST_CASE("after a stall the newest is answered: the last before it are superseded", "[link]") {
  MonitoredLink link;
  link.stream.cycles(0, 20);
  for (std::uint64_t k = 20; k < 25; ++k)
    link.stream.telegram(link.stream.at(k), link.stream.ipoc(k));
  link.stream.reply(link.stream.at(24) + 1ms, link.stream.ipoc(24));
  link.stream.cycles(25, 40);
  const auto report = link.report();
  // The telegrams 20..22 waited 17, 13 and 9 ms for any answer, number 23 only 5 ms.
  CHECK(report.replies.unanswered == 3);
  CHECK(report.replies.superseded == 1);
  CHECK(report.replies.in_time == 36);
  REQUIRE(report.silent_runs.places().size() == 1);
  check_place(report.silent_runs.worst(), 80ms, 1'000'080, 4);
}

TEST_CASE("telegrams that come in a bunch are superseded by the newest of it", "[link]") {
  MonitoredLink link;
  link.stream.cycles(0, 20);
  for (const std::uint64_t k : {20u, 21u, 22u})
    link.stream.telegram(88ms + nanoseconds(k), link.stream.ipoc(k));
  link.stream.reply(88ms + 50us, link.stream.ipoc(22));
  link.stream.cycles(23, 40);
  const auto report = link.report();
  CHECK(report.replies.superseded == 2);
  CHECK(report.replies.unanswered == 0);
  CHECK(report.clock_steps == 0);
  CHECK(report.latest == 8ms + 20ns);
}

TEST_CASE("the last telegram before the end is not missing its reply yet, the ones before it are",
          "[link]") {
  MonitoredLink link;
  link.stream.cycles(0, 20);
  for (std::uint64_t k = 20; k < 24; ++k)
    link.stream.telegram(link.stream.at(k), link.stream.ipoc(k));
  const auto report = link.report();
  CHECK(report.replies.unanswered == 3);
  CHECK(fates(report.replies) == 23);
}

TEST_CASE("a controller with ONLYSEND misses nothing", "[link]") {
  MonitoredLink link;
  for (std::uint64_t k = 0; k < 3000; ++k)
    link.stream.telegram(link.stream.at(k), link.stream.ipoc(k), {});
  const auto report = link.report();
  CHECK(report.replies.sent == 0);
  CHECK(fates(report.replies) == 0);
  CHECK(report.silent_runs.empty());
  CHECK(report.latency.count() == 0);
  CHECK(report.jitter.count() == 2999);
  CHECK_FALSE(report.link.late_replies);
}

TEST_CASE("replies that the capture begins or ends with, repeated and wrong ones are told apart",
          "[link]") {
  MonitoredLink link;
  link.stream.reply(0ms, 999'996);  // its telegram came before the capture
  link.stream.cycles(1, 10);
  link.stream.reply(37ms, link.stream.ipoc(9));
  link.stream.reply(38ms, 5);
  link.stream.reply_datagram(39ms, "no IPOC");
  link.stream.cycles(10, 20);
  const auto report = link.report();
  CHECK(report.replies.sent == 23);
  CHECK(report.replies.repeated == 1);
  CHECK(report.replies.stray == 2);
  CHECK(report.replies.in_time == 19);
}

TEST_CASE("duplicates and latecomers are counted, and have one fate each", "[link]") {
  MonitoredLink link;
  link.stream.cycles(0, 10);
  link.stream.telegram(40ms, link.stream.ipoc(10));
  link.stream.telegram(40ms + 10us, link.stream.ipoc(10));  // both waited: one reply
  link.stream.reply(40ms + 30us, link.stream.ipoc(10));
  link.stream.cycles(12, 13);  // overtakes number 11
  link.stream.telegram(48ms + 200us, link.stream.ipoc(11));
  link.stream.reply(48ms + 300us, link.stream.ipoc(11));
  link.stream.cycles(13, 30);
  const auto report = link.report();
  CHECK(report.link.duplicated == 1);
  CHECK(report.link.reordered == 1);
  CHECK(report.link.lost == 0);
  CHECK(report.replies.in_time == 30);
  CHECK(report.replies.not_in_time() == 0);
  CHECK(report.replies.repeated == 0);
  CHECK(report.jitter.max() == 0ns);  // neither says anything of the controller's pace
}

TEST_CASE("a gap is lost telegrams and no jitter, and its place is named", "[link]") {
  MonitoredLink link;
  link.stream.cycles(0, 10);
  link.stream.cycles(12, 600);
  link.stream.cycles(2000, 2100);  // the machine slept for more than five seconds
  const auto report = link.report();
  CHECK(report.link.lost == 1402);
  CHECK(report.link.restarts == 0);
  CHECK(report.jitter.max() == 0ns);
  CHECK(report.clock_steps == 0);
  check_place(report.longest_gap, 8s, 1'008'000, 1400);
  CHECK(report.replies.in_time == 698);
}

TEST_CASE("the clock set forwards is neither jitter nor latency, wherever in the cycle it is set",
          "[link]") {
  for (const bool before_reply : {false, true}) {
    CAPTURE(before_reply);
    MonitoredLink link;
    link.stream.cycles(0, 100);
    link.stream.telegram(400ms, link.stream.ipoc(100));
    if (before_reply) link.stream.clock_off = 1h;
    link.stream.reply(400ms + 50us, link.stream.ipoc(100));
    link.stream.clock_off = 1h;
    link.stream.cycles(101, 1000);
    const auto report = link.report();
    CHECK(report.clock_steps == 1);
    CHECK(report.largest_clock_step == 1h);
    CHECK(report.jitter.max() == 0ns);
    CHECK(report.latency.max() == 50us);
    CHECK(report.replies.untimed == 1);
    CHECK(report.replies.in_time == 1000);
    CHECK(report.duration == 999 * 4ms);
  }
}

TEST_CASE("the clock set backwards is neither jitter nor latency, wherever in the cycle it is set",
          "[link]") {
  for (const bool before_reply : {false, true}) {
    CAPTURE(before_reply);
    MonitoredLink link;
    link.stream.cycles(0, 100);
    link.stream.telegram(400ms, link.stream.ipoc(100));
    if (before_reply) link.stream.clock_off = -10s;
    link.stream.reply(400ms + 50us, link.stream.ipoc(100));
    link.stream.clock_off = -10s;
    link.stream.cycles(101, 2000);
    const auto report = link.report();
    CHECK(report.clock_steps == 1);
    CHECK(report.largest_clock_step == -10s);
    CHECK(report.jitter.max() == 0ns);
    CHECK(report.latency.max() == 50us);
    CHECK(report.replies.untimed == 1);
    CHECK(report.replies.in_time == 2000);
    CHECK(report.duration == 1999 * 4ms);
  }
}

TEST_CASE("telegrams held up by the network are jitter, not a clock that was set", "[link]") {
  MonitoredLink link;
  link.stream.cycles(0, 100);
  // Numbers 100 to 119 were held up until number 120 was due.
  for (std::uint64_t k = 100; k < 120; ++k) {
    link.stream.telegram(480ms + nanoseconds(1000 * k), link.stream.ipoc(k));
    link.stream.reply(480ms + nanoseconds(1000 * k + 500), link.stream.ipoc(k));
  }
  link.stream.cycles(121, 200);
  const auto report = link.report();
  CHECK(report.clock_steps == 0);
  CHECK(report.latest == 80ms + 100us);
  CHECK(report.link.lost == 1);
}

TEST_CASE("a reply that stands before its telegram in a capture answers it", "[link]") {
  MonitoredLink link;
  link.stream.reply(link.stream.at(0) + 50us, link.stream.ipoc(0));
  link.stream.telegram(link.stream.at(0), link.stream.ipoc(0));
  link.stream.cycles(1, 100);
  for (std::uint64_t k = 100; k < 110; ++k) {
    link.stream.reply(link.stream.at(k) + 50us, link.stream.ipoc(k));
    link.stream.telegram(link.stream.at(k), link.stream.ipoc(k));
  }
  link.stream.cycles(110, 200);
  CHECK(link.report().replies.stray == 0);
  CHECK(link.report().replies.in_time == 200);
  CHECK(link.report().latency.max() == 50us);
  // One that was sent before has guessed.
  link.stream.reply(link.stream.at(200) - 1ms, link.stream.ipoc(200));
  link.stream.telegram(link.stream.at(200), link.stream.ipoc(200));
  link.stream.cycles(201, 210);
  CHECK(link.report().replies.stray == 1);
  CHECK(link.report().replies.in_time == 209);
}

TEST_CASE("RSI that begins anew on another port is a restart; so is an IPOC that wraps", "[link]") {
  MonitoredLink link;
  constexpr std::uint64_t kWrap = std::uint64_t{1} << 32;
  for (std::uint64_t k = 0; k < 100; ++k) {
    const auto ipoc = (kWrap - 200 + 4 * k) % kWrap;
    link.stream.telegram(link.stream.at(k), ipoc);
    link.stream.reply(link.stream.at(k) + 10us, ipoc);
  }
  CHECK(link.report().link.restarts == 1);
  CHECK(link.report().jitter.count() == 98);
  link.stream.controller.port = 50001;
  link.stream.clock_off = 3s;
  link.stream.cycles(100, 200);
  const auto report = link.report();
  CHECK(report.link.restarts == 2);
  CHECK(report.link.lost == 0);
  CHECK(report.clock_steps == 0);
  CHECK(report.jitter.count() == 197);
  CHECK(report.jitter.max() == 0ns);
  CHECK(report.replies.in_time == 200);
  CHECK(report.duration == 3s + 199 * 4ms);
}

TEST_CASE("what is no telegram is malformed; with an IPOC it came all the same", "[link]") {
  MonitoredLink link;
  link.stream.cycles(0, 10);
  link.stream.datagram(40ms, "<Rob><A>1</A><IPOC>1000040</IPOC>");  // ends too early
  link.stream.reply(40ms + 50us, 1'000'040);
  link.stream.datagram(41ms, "binary \xff");
  link.stream.datagram(44ms, telegram_text(1'000'044), true);
  link.stream.reply(44ms + 50us, 1'000'044);
  link.stream.cycles(12, 20);
  const auto report = link.report();
  CHECK(report.malformed == 3);
  CHECK(report.unanswerable == 1);
  CHECK(report.link.telegrams == 20);
  CHECK(report.link.lost == 0);
  CHECK(report.replies.in_time == 20);
}

TEST_CASE("runs of late replies by the controller's Delay have their places, the longest first",
          "[link]") {
  MonitoredLink link;
  const std::vector<std::uint64_t> delays{0, 1, 2, 0, 0, 1, 0, 1, 2, 3, 1, 0, 2};
  for (std::uint64_t k = 0; k < delays.size(); ++k)
    link.stream.telegram(link.stream.at(k), link.stream.ipoc(k), delays[k]);
  const auto report = link.report();
  CHECK(report.link.late_runs == 5);
  CHECK(report.link.late_replies == 2 + 1 + 3 + 1 + 2);
  const auto runs = report.late_runs.places();
  REQUIRE(runs.size() == 5);
  check_place(runs[0], 28ms, 1'000'028, 3);
  check_place(runs[1], 4ms, 1'000'004, 2);
  check_place(runs[2], 48ms, 1'000'048, 2);
  check_place(runs[3], 20ms, 1'000'020, 1);
  check_place(runs[4], 40ms, 1'000'040, 1);
}

TEST_CASE("a Delay that does not go back counts what it rises by, once", "[link]") {
  MonitoredLink link;
  const auto telegrams = [&](std::initializer_list<std::uint64_t> delays, std::uint64_t from,
                             std::uint64_t apart) {
    for (const std::uint64_t delay : delays) {
      link.stream.telegram(link.stream.at(from), link.stream.ipoc(from), delay);
      from += apart;
    }
  };
  telegrams({0, 0, 1, 1, 1, 3, 3}, 0, 1);  // of all since the start, as some simulators tell it
  CHECK(link.report().link.late_replies == 3);
  CHECK(link.report().link.late_runs == 2);
  telegrams({0}, 7, 1);
  // The controller missed a cycle of its own now and then, and counts replies, not cycles.
  telegrams({1, 2, 3, 4, 5}, 8, 2);
  CHECK(link.report().link.late_replies == 3 + 5);
  CHECK(link.report().link.late_runs == 3);
  CHECK(link.report().link.longest_late_run == 5);
}

TEST_CASE("a run of late replies begins with the first one that was seen", "[link]") {
  MonitoredLink link;
  const std::vector<std::uint64_t> delays{248, 249, 250, 0, 0, 1, 0};
  for (std::uint64_t k = 0; k < delays.size(); ++k)
    link.stream.telegram(link.stream.at(k), link.stream.ipoc(k), delays[k]);
  const auto runs = link.report().late_runs;
  REQUIRE(runs.places().size() == 2);
  check_place(runs.places()[0], 4ms, 1'000'004, 2);
  check_place(runs.places()[1], 20ms, 1'000'020, 1);
}

TEST_CASE("faults at random are counted exactly over a long stream", "[link]") {
  std::mt19937 random(11);
  std::uniform_real_distribution<> chance;
  constexpr std::uint64_t kCycles = 100'000;
  MonitoredLink link;
  rsi::LinkCounts put{};
  rsi::ReplyCounts replies;
  for (std::uint64_t k = 0; k < kCycles; ++k) {
    const auto at = link.stream.at(k);
    const auto ipoc = link.stream.ipoc(k);
    // Ends that are whole, so that no loss goes unseen and no reply is still awaited.
    const double dice = k == 0 || k + 2 > kCycles ? 1 : chance(random);
    if (dice < 0.01) {
      ++put.lost;
      continue;
    }
    link.stream.telegram(at, ipoc);
    if (dice < 0.02) {
      ++replies.superseded;  // the next one, even after a loss or two, comes too soon to tell
      continue;
    }
    if (dice < 0.03) {
      ++replies.late;
      link.stream.reply(at + 5ms, ipoc);
      continue;
    }
    link.stream.reply(at + 100us, ipoc);
    ++replies.in_time;
    if (dice < 0.04) {
      ++put.duplicated;
      link.stream.telegram(at + 1ms, ipoc);
      link.stream.reply(at + 1ms + 100us, ipoc);
    }
  }
  const auto report = link.report();
  CHECK(report.link.lost == put.lost);
  CHECK(report.link.duplicated == put.duplicated);
  CHECK(report.replies.in_time == replies.in_time);
  CHECK(report.replies.late == replies.late);
  CHECK(report.replies.superseded + report.replies.unanswered == replies.superseded);
  CHECK(report.replies.superseded > 10 * report.replies.unanswered);
  CHECK(report.replies.repeated == put.duplicated);
  CHECK(report.jitter.max() == 0ns);
}

TEST_CASE("time stamps of any value are taken", "[link]") {
  std::mt19937_64 random(13);
  MonitoredLink link;
  // From 1970 to 2262, as captures can have them.
  const auto stamp = [&] { return nanoseconds(static_cast<std::int64_t>(random() >> 1)) - kStart; };
  for (std::uint64_t k = 0; k < 5000; ++k) {
    const auto ipoc = k % 50 == 0 ? random() : link.stream.ipoc(k);
    link.stream.telegram(stamp(), ipoc);
    link.stream.reply(stamp(), ipoc);
  }
  const auto report = link.report();
  CHECK(report.link.restarts >= 198);  // to a random IPOC and back, but for the first
  CHECK(report.clock_steps > 4000);
  CHECK(report.replies.in_time == 5000);
  CHECK(report.latency.count() < 10);  // less than an hour apart: one in a million
  CHECK(report.duration > 0ns);
}

TEST_CASE("of the last cycles as many are told as are asked for, the newest ones", "[link]") {
  MonitoredLink link;
  link.stream.cycles(0, 3000, 70us);
  const auto all = link.monitor.last();
  CHECK(all.size() == rsi::Link::kLast);
  CHECK(link.monitor.last(1000).size() == rsi::Link::kLast);
  const auto three = link.monitor.last(3);
  REQUIRE(three.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) CHECK(three[i].ipoc == all[all.size() - 3 + i].ipoc);
  CHECK(link.monitor.last(0).empty());
}

TEST_CASE("Delay is what the controller says of its late packets", "[link]") {
  const auto told = [](const std::string& element) {
    rsi::Link link;
    LinkStream<rsi::Link>(link).datagram(
        0ms, "<Rob Type=\"KUKA\">" + element + "<IPOC>1000</IPOC></Rob>");
    return link.last().at(0).delay;
  };
  CHECK(told("<Delay D=\"3\"/>") == 3U);
  CHECK(told("<Delay D=\"-1\"/>") == std::nullopt);
  CHECK(told("<Delay D=\"x\"/>") == std::nullopt);
  CHECK(told("<DiL>0</DiL>") == std::nullopt);
}

TEST_CASE("what is no whole telegram begins no stream anew, but may carry one by itself",
          "[link]") {
  const auto broken = [](std::uint64_t ipoc) {
    return "<Rob Type=\"KUKA\"><IPOC>" + std::to_string(ipoc) + "</IPOC>";
  };
  rsi::Link whole;
  LinkStream<rsi::Link> stream(whole);
  stream.cycles(0, 20);
  stream.datagram(79ms, broken(7));
  stream.cycles(20, 30);
  CHECK(whole.report().link.telegrams == 30);
  CHECK(whole.report().link.restarts == 0);
  CHECK(whole.report().link.lost == 0);
  CHECK(whole.report().malformed == 1);

  rsi::Link other;  // of a controller whose telegrams sweepd cannot read
  LinkStream<rsi::Link> unread(other);
  for (std::uint64_t k = 0; k < 20; ++k) unread.datagram(unread.at(k), broken(unread.ipoc(k)));
  for (std::uint64_t k = 20; k < 40; ++k) unread.datagram(unread.at(k), broken(k * 4));
  CHECK(other.report().link.telegrams == 40);
  CHECK(other.report().link.restarts == 1);
}
