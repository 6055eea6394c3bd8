#include "rsi/link/link_verdict.hpp"

#include <algorithm>

#include "rsi/link/link.hpp"
#include "tests/catch.hpp"
#include "tests/rsi/link_stream.hpp"

using Catch::Matchers::ContainsSubstring;
using rsi::Grade;
using rsi::LinkReport;
using namespace rsi::test;

namespace {

/// 10,000 cycles of 4 ms, each answered after 50 us.
LinkReport flawless() {
  rsi::Link monitor;
  LinkStream stream(monitor);
  stream.cycles(0, 10'000);
  return monitor.report();
}

const rsi::Reason* reason(const rsi::Verdict& verdict, std::string_view code) {
  const auto found = std::find_if(verdict.reasons.begin(), verdict.reasons.end(),
                                  [&](const auto& one) { return one.code == code; });
  return found == verdict.reasons.end() ? nullptr : &*found;
}

/// The only reason that a report gives: its grade, and part of what it says.
void check_only(const LinkReport& report, Grade grade, std::string_view code,
                const std::string& says) {
  const auto verdict = rsi::verdict(report);
  CAPTURE(code, says);
  CHECK(verdict.grade == grade);
  REQUIRE(verdict.reasons.size() == 1);
  CHECK(verdict.reasons.front().code == code);
  CHECK(verdict.reasons.front().grade == grade);
  CHECK_THAT(verdict.reasons.front().message, ContainsSubstring(says));
}

}  // namespace

TEST_CASE("a flawless link is good, without a word", "[link_verdict]") {
  CHECK(rsi::verdict(flawless()).grade == Grade::good);
  CHECK(rsi::verdict(flawless()).reasons.empty());
  CHECK(rsi::verdict(LinkReport()).grade == Grade::good);
}

TEST_CASE("a link none of whose replies could be sent is bad", "[link_verdict]") {
  rsi::Link monitor;
  LinkStream stream(monitor);
  for (std::uint64_t k = 0; k < 1500; ++k) {
    stream.telegram(stream.at(k), stream.ipoc(k));
    monitor.reply({});
  }
  auto report = monitor.report();
  CHECK(report.replies.failed == 1500);
  CHECK(report.replies.unanswered > 1490);
  const auto verdict = rsi::verdict(report);
  CHECK(verdict.grade == Grade::bad);
  REQUIRE(reason(verdict, "not_sent") != nullptr);
  CHECK_THAT(reason(verdict, "not_sent")->message,
             ContainsSubstring("refused to send 1500 replies (100.00 %)"));
  CHECK(reason(verdict, "not_answered_in_time") == nullptr);
  CHECK(reason(verdict, "no_replies") == nullptr);
  report.link.late_replies = 1499;
  CHECK_THAT(reason(rsi::verdict(report), "late_at_controller")->message,
             Catch::Matchers::EndsWith("the system of this machine refused to send them"));
}

TEST_CASE("a link without any reply says so", "[link_verdict]") {
  rsi::Link monitor;
  LinkStream stream(monitor);
  for (std::uint64_t k = 0; k < 1500; ++k) stream.telegram(stream.at(k), stream.ipoc(k));
  check_only(monitor.report(), Grade::good, "no_replies", "record both directions");
  auto cut = monitor.report();
  cut.from_recording = true;
  CHECK_THAT(reason(rsi::verdict(cut), "no_replies")->message,
             ContainsSubstring("sweepd gave none on purpose"));
}

TEST_CASE("a link of few telegrams is not called good without a word", "[link_verdict]") {
  const auto link_of = [](std::uint64_t telegrams) {
    rsi::Link monitor;
    LinkStream stream(monitor);
    stream.cycles(0, telegrams);
    return monitor.report();
  };
  check_only(link_of(38), Grade::good, "few_telegrams", "38 telegrams are too few");
  CHECK(reason(rsi::verdict(link_of(999)), "few_telegrams") != nullptr);
  CHECK(reason(rsi::verdict(link_of(1000)), "few_telegrams") == nullptr);
}

TEST_CASE("what a tap has missed is not held against the link, and what goes beyond is",
          "[link_verdict]") {
  auto report = flawless();
  report.missed_by_tap = 12;
  report.link.lost = 12;
  report.replies.stray = 5;
  report.replies.unanswered = 3;
  check_only(report, Grade::good, "missed_by_tap", "12 packets passed the tap unseen");
  report.link.lost = 13;
  CHECK(reason(rsi::verdict(report), "lost") != nullptr);
}

TEST_CASE("what the queue had no room for is not held against the link", "[link_verdict]") {
  auto report = flawless();
  report.queue_full = 12;
  report.link.lost = 12;
  report.replies.stray = 5;
  report.replies.unanswered = 3;
  check_only(report, Grade::good, "queue_full",
             "12 datagrams were neither counted here nor recorded");
  report.link.lost = 13;
  CHECK(reason(rsi::verdict(report), "lost") != nullptr);
}

TEST_CASE("one late reply by the controller's Delay is marginal, five in a row or one per cent bad",
          "[link_verdict]") {
  auto report = flawless();
  report.link.late_replies = 1;
  report.link.late_runs = 1;
  report.link.longest_late_run = 1;
  report.late_runs.add({2s, 1'002'000, 1});
  check_only(report, Grade::marginal, "late_at_controller",
             "1 reply (0.01 %) missed the controller's cycle by its own Delay, in 1 run, at most 1 "
             "in a row (at 2.000 s, IPOC 1002000)");
  report.link.late_replies = report.link.longest_late_run = 5;
  check_only(report, Grade::bad, "late_at_controller", "at most 5 in a row");
  report.link = {.telegrams = 10'000, .late_replies = 101, .late_runs = 101, .longest_late_run = 1};
  check_only(report, Grade::bad, "late_at_controller", "101 replies (1.01 %)");
}

TEST_CASE("the controller's Delay is explained by what was seen here", "[link_verdict]") {
  auto report = flawless();
  report.link.late_replies = 2;
  report.link.late_runs = 1;
  report.link.longest_late_run = 2;
  check_only(report, Grade::marginal, "late_at_controller", "the way from or to the controller");
  report.replies = {};
  check_only(report, Grade::marginal, "late_at_controller", "record both directions");
  report.replies.sent = 9999;
  report.replies.late = 2;
  report.silent_runs.add({1s, 5, 2});
  const auto here = rsi::verdict(report);
  REQUIRE(reason(here, "late_at_controller") != nullptr);
  CHECK_THAT(reason(here, "late_at_controller")->message, ContainsSubstring("its slowest"));
  report.replies.late = 1;
  report.link.lost = 1;
  const auto both = rsi::verdict(report);
  REQUIRE(reason(both, "late_at_controller") != nullptr);
  CHECK_THAT(reason(both, "late_at_controller")->message,
             ContainsSubstring("1 telegram was not answered in time") &&
                 ContainsSubstring("1 never came"));
}

TEST_CASE("a stream that was not answered on purpose says so, and blames nothing else for it",
          "[link_verdict][issue11][point_1]") {
  auto report = flawless();
  report.replies = {};
  report.replies.withheld = 100;
  report.link.late_replies = report.link.longest_late_run = 100;
  report.link.late_runs = 1;
  check_only(report, Grade::bad, "not_begun", "100 telegrams (1.00 %) got no answer on purpose");
  report.link.late_replies = 101;  // one more than that
  CHECK(reason(rsi::verdict(report), "late_at_controller") != nullptr);
}

TEST_CASE("telegrams without a reply in time are graded by their run and their share",
          "[link_verdict]") {
  auto report = flawless();
  report.replies.unanswered = 3;
  report.replies.late = 1;
  report.silent_runs.add({1s, 1'001'000, 4});
  check_only(report, Grade::marginal, "not_answered_in_time",
             "4 telegrams (0.04 %) got no reply within a cycle (1 late, 0 superseded, 3 "
             "unanswered), at most 4 in a row (at 1.000 s, IPOC 1001000)");
  report.silent_runs.add({1s, 1'001'000, 5});
  check_only(report, Grade::bad, "not_answered_in_time", "realtime");
}

TEST_CASE("telegrams that came together are not laid to the server's machine", "[link_verdict]") {
  auto report = flawless();
  report.replies.superseded = 99;
  report.silent_runs.add({1s, 1'001'000, 2});
  check_only(report, Grade::marginal, "not_answered_in_time",
             "which were answered at once: see what holds telegrams up at the controller or on the "
             "way from it");
  report.replies.late = 1;
  check_only(report, Grade::marginal, "not_answered_in_time", "realtime");
}

TEST_CASE("a server that leaves telegrams out is not excused by their having come together",
          "[link_verdict]") {
  const auto after = [](auto skip) {
    rsi::Link link;
    rsi::test::LinkStream stream(link);
    stream.cycles(0, 1000);
    skip(stream);
    stream.cycles(1002, 2000);
    return rsi::verdict(link.report());
  };
  const auto left_out = after([](auto& stream) {
    stream.telegram(stream.at(1000), stream.ipoc(1000));
    stream.cycles(1001, 1002);
  });
  REQUIRE(reason(left_out, "not_answered_in_time") != nullptr);
  CHECK_THAT(reason(left_out, "not_answered_in_time")->message,
             ContainsSubstring("1 superseded") && ContainsSubstring("realtime") &&
                 !ContainsSubstring("came together"));
  const auto together = after([](auto& stream) {
    stream.telegram(stream.at(1001) - 10us, stream.ipoc(1000));
    stream.cycles(1001, 1002);
  });
  REQUIRE(reason(together, "not_answered_in_time") != nullptr);
  CHECK_THAT(reason(together, "not_answered_in_time")->message,
             ContainsSubstring("they came together"));
}

TEST_CASE("the share of lost telegrams is that of cycles, however often a telegram came",
          "[link_verdict]") {
  auto report = flawless();
  report.link.duplicated = 5000;
  report.link.lost = 5000;
  CHECK_THAT(reason(rsi::verdict(report), "lost")->message,
             Catch::Matchers::StartsWith("5000 telegrams (50.00 %) never came"));
}

TEST_CASE("lost telegrams point at cable and buffer, a long gap at sleep or a cable that was out",
          "[link_verdict]") {
  auto report = flawless();
  report.link.lost = 4;
  report.longest_gap = {2s, 1'002'000, 2};
  check_only(report, Grade::marginal, "lost", "receive buffer");
  report.link.lost = 1500;
  report.longest_gap = {2s, 1'002'000, 1400};
  check_only(report, Grade::bad, "lost", "suspended");
}

TEST_CASE("half a cycle is the limit of the latency: at 99.9 % marginal, at 50 % bad",
          "[link_verdict]") {
  auto report = flawless();
  const auto slow = [&](int count, std::chrono::nanoseconds latency) {
    for (int i = 0; i < count; ++i) report.latency.add(latency);
    report.slowest.add({3s, 1'003'000, latency.count()});
  };
  slow(9, 2500us);  // of 10,009: less than one in 1000
  CHECK(rsi::verdict(report).reasons.empty());
  slow(10, 2500us);
  check_only(report, Grade::marginal, "latency", "at 3.000 s, IPOC 1003000");
  slow(10'000, 2500us);
  check_only(report, Grade::bad, "latency", "half of the replies");
}

TEST_CASE("jitter beyond half a cycle is marginal, telegrams in bunches are bad",
          "[link_verdict]") {
  auto report = flawless();
  for (int i = 0; i < 9; ++i) report.jitter.add(2500us);
  CHECK(rsi::verdict(report).reasons.empty());
  for (int i = 0; i < 10; ++i) report.jitter.add(2500us);
  check_only(report, Grade::marginal, "jitter", "one in 1000 of the telegrams");
  for (int i = 0; i < 200; ++i) report.jitter.add(8ms);
  check_only(report, Grade::bad, "jitter", "one in 100 of the telegrams");
}

TEST_CASE("what is malformed, doubled, overtaken or answered wrongly has a reason each",
          "[link_verdict]") {
  auto report = flawless();
  report.malformed = 3;
  report.unanswerable = 2;
  check_only(report, Grade::marginal, "malformed", "2 of them could not even be answered");
  report.malformed = 300;
  check_only(report, Grade::bad, "malformed",
             "300 datagrams (3.00 %) held no whole telegram, and 2 of them");

  report = flawless();
  report.link.duplicated = 2;
  report.replies.repeated = 2;  // each was answered again
  check_only(report, Grade::marginal, "duplicated", "2 telegrams (0.02 %) came twice");
  report.link.duplicated = 0;
  check_only(report, Grade::marginal, "repeated_replies", "two servers");

  report = flawless();
  report.link.reordered = 1;
  check_only(report, Grade::marginal, "reordered", "1 telegram (0.01 %) came after");

  report = flawless();
  report.replies.stray = 1;
  check_only(report, Grade::marginal, "stray_replies", "1 reply (0.01 %) had");
  report.replies.stray = 500;
  check_only(report, Grade::bad, "stray_replies", "correct the server");
}

TEST_CASE(
    "two controllers behind one address are named, and one that begins anew now and then is not",
    "[link_verdict]") {
  rsi::Link link;
  LinkStream one(link), other(link);
  other.controller.port = kRestarted.port;
  for (std::uint64_t k = 0; k < 1000; ++k) {
    one.cycles(k, k + 1);
    other.telegram(one.at(k) + 2ms, 9'000'000 + 4 * k);
    other.reply(one.at(k) + 2ms + 50us, 9'000'000 + 4 * k);
  }
  const auto verdict = rsi::verdict(link.report());
  CHECK(verdict.grade == Grade::bad);
  const auto* named = reason(verdict, "two_senders");
  REQUIRE(named != nullptr);
  CHECK_THAT(named->message, ContainsSubstring("192.168.1.20:49154 and 192.168.1.20:49153") ||
                                 ContainsSubstring("192.168.1.20:49153 and 192.168.1.20:49154"));
  CHECK(reason(verdict, "restarts") == nullptr);

  rsi::Link calm;
  LinkStream stream(calm);
  for (std::uint64_t session = 0; session < 6; ++session) {  // from two ports by turns
    stream.controller.port = session % 2 == 0 ? kController.port : kRestarted.port;
    stream.cycles(1000 * session, 1000 * session + 500);
  }
  CHECK(reason(rsi::verdict(calm.report()), "two_senders") == nullptr);
  CHECK_THAT(reason(rsi::verdict(calm.report()), "restarts")->message,
             ContainsSubstring("5 times"));
}

TEST_CASE("restarts, clock steps and missing Delay are good to know, and no fault of the link",
          "[link_verdict]") {
  auto report = flawless();
  report.link.restarts = 1;
  check_only(report, Grade::good, "restarts", "1 time");
  report = flawless();
  report.clock_steps = report.clock_steps_back = 2;
  report.largest_clock_step = -1500ms;
  check_only(report, Grade::good, "clock_steps", "-1.500 s");
  report = flawless();
  report.link.late_replies.reset();
  check_only(report, Grade::good, "no_delay", "DEF_Delay");
  report.malformed = 10'000;  // what was cut may have it
  CHECK(reason(rsi::verdict(report), "no_delay") == nullptr);
  report.malformed = 0;
  report.replies = {};
  check_only(report, Grade::good, "no_replies", "nothing is known of what it got");
  report = flawless();
  report.link.missed_before = 248;
  check_only(report, Grade::good, "missed_before", "had missed 248 replies before");
  report.link.missed_before = 0;
  report.from_recording = true;
  check_only(report, Grade::good, "from_recording", "its recording alone tells of the link");
  report = flawless();
  report.ipoc_counts_ms = false;
  check_only(report, Grade::good, "ipoc_no_clock", "simulator");
}

TEST_CASE("only a clock that goes back was set for certain: else the sender may have paused",
          "[link_verdict][issue11][point_16]") {
  const auto message = [](std::chrono::nanoseconds jump) {
    rsi::Link monitor;
    LinkStream stream(monitor);
    stream.cycles(0, 100);
    stream.clock_off = jump;
    stream.cycles(100, 200);
    const auto verdict = rsi::verdict(monitor.report());
    const auto* found = reason(verdict, "clock_steps");
    return found == nullptr ? std::string() : found->message;
  };
  CHECK(message(-2s) ==
        "the clock of the machine was set back 1 time (let chrony slew it instead); by at most "
        "-2.000 s, and replies around it are not timed");
  CHECK_THAT(message(30ms), ContainsSubstring("1 time the clock of the machine ran ahead") &&
                                ContainsSubstring("or the sender paused with its IPOC") &&
                                !ContainsSubstring("chrony") && !ContainsSubstring("set back"));
}

TEST_CASE("no cable, switch or loop is blamed for telegrams that never left the machine",
          "[link_verdict][issue11][point_16]") {
  for (const bool loopback : {true, false}) {
    CAPTURE(loopback);
    rsi::Link monitor;
    LinkStream stream(monitor);
    if (loopback) stream.controller = {0x7f000001, 49153};
    stream.cycles(0, 300);
    stream.telegram(stream.at(300), stream.ipoc(300), 3);
    stream.telegram(stream.at(300), stream.ipoc(300), 3);
    stream.cycles(310, 320);
    stream.telegram(stream.at(320), stream.ipoc(305));
    for (std::uint64_t k = 321; k < 400; ++k)
      stream.telegram(stream.at(k) + k % 5 * 1ms, stream.ipoc(k));
    const auto verdict = rsi::verdict(monitor.report());
    std::string all;
    for (const char* code : {"lost", "duplicated", "reordered", "jitter", "late_at_controller"}) {
      CAPTURE(code);
      REQUIRE(reason(verdict, code) != nullptr);
      all += reason(verdict, code)->message + "\n";
    }
    INFO(all);
    for (const char* network : {"cable", "switch", "loop", "wireless", "network card"})
      CHECK((all.find(network) == all.npos) == loopback);
  }
}

TEST_CASE("the worst reason stands first and makes the verdict", "[link_verdict]") {
  auto report = flawless();
  report.link.restarts = 1;
  report.link.reordered = 1;
  report.malformed = 500;
  const auto verdict = rsi::verdict(report);
  CHECK(verdict.grade == Grade::bad);
  REQUIRE(verdict.reasons.size() == 3);
  CHECK(verdict.reasons[0].code == "malformed");
  CHECK(verdict.reasons[1].code == "reordered");
  CHECK(verdict.reasons[2].code == "restarts");
}
