#include "daemon/commands/simulation_report.hpp"

#include "tests/catch.hpp"

using Catch::Matchers::ContainsSubstring;
using End = rsi::ControllerLink::End;
using rsi::ReplyFault;
using sweepd::problem;
using sweepd::SimulationReport;
using namespace std::chrono_literals;

namespace {

/// A thousand cycles, each answered after 20 us.
SimulationReport flawless() {
  SimulationReport report;
  report.target = "127.0.0.1:49152";
  report.live = true;
  report.cycle = 4ms;
  report.planned = 1000;
  report.link.controller.telegrams = 1000;
  report.link.controller.replies = 1000;
  report.link.controller.accepted = 1000;
  for (int i = 0; i < 1000; ++i) report.link.latency.add(20us);
  return report;
}

void refuse(SimulationReport& report, ReplyFault kind, std::uint64_t count) {
  report.link.controller.faults[static_cast<std::size_t>(kind)] += count;
  report.link.first_fault = "reply to IPOC 7: " + std::string(rsi::text(kind));
}

}  // namespace

TEST_CASE("a flawless run is reported in lined up figures, and nothing is wrong with it",
          "[simulation_report]") {
  const auto report = flawless();
  CHECK(problem(report).empty());
  CHECK(text(report) ==
        "Simulated to 127.0.0.1:49152, 4.0 s of 4.0 s: the plan was played to its end.\n"
        "telegrams                     1000 one every 4 ms\n"
        "  lost on purpose                0\n"
        "  duplicated on purpose          0\n"
        "  swapped on purpose             0 pairs\n"
        "replies accepted              1000\n"
        "cycles unanswered                0 at most 0 in a row\n"
        "replies late                     0\n"
        "replies refused                  0\n"
        // Quantiles are right to 1/128.
        "latency p50                   20.0 µs\n"
        "latency p99                   20.0 µs\n"
        "latency p99.9                 20.0 µs\n"
        "latency max                   20.0 µs, of replies in time\n");
}

TEST_CASE("what a controller accepts is remarked on, and is no problem",
          "[simulation_report][issue11][point_18]") {
  auto report = flawless();
  auto& remarks = report.link.controller.remarks;
  remarks[static_cast<std::size_t>(ReplyFault::missing_tag)] = 1000;
  remarks[static_cast<std::size_t>(ReplyFault::not_zero)] = 7;
  report.link.first_remarks = {"reply to IPOC 7: missing tag: AK.A1",
                               "reply to IPOC 9: not zero: Tech.T21 = 1.09"};
  CHECK(problem(report).empty());
  CHECK_THAT(text(report),
             ContainsSubstring("replies accepted              1000\n"
                               "  with tags left out          1000 which controllers accept\n"
                               "  with values not zero           7 which controllers obey\n"
                               "  first reply to IPOC 7: missing tag: AK.A1\n"
                               "  first reply to IPOC 9: not zero: Tech.T21 = 1.09\n"));
}

TEST_CASE("lateness is told from replies that were wrong or did not come",
          "[simulation_report][issue11][point_17]") {
  auto late = flawless();
  refuse(late, ReplyFault::late, 7);
  CHECK_FALSE(problem(late).empty());
  CHECK(only_late(late));
  late.link.controller.unanswered = 3;  // of telegrams that waited together
  CHECK(only_late(late));

  auto wrong = late;
  refuse(wrong, ReplyFault::wrong_ipoc, 1);
  CHECK_FALSE(only_late(wrong));
  auto stopped = late;
  stopped.link.end = End::timed_out;
  CHECK_FALSE(only_late(stopped));
  auto silent = flawless();
  silent.link.controller.replies = 0;
  silent.link.controller.unanswered = 1000;
  CHECK_FALSE(only_late(silent));
  auto interrupted = late;
  interrupted.interrupted = true;
  CHECK_FALSE(only_late(interrupted));
}

TEST_CASE("a capture has no replies to report", "[simulation_report]") {
  SimulationReport report;
  report.target = "trace.pcap";
  report.cycle = 12ms;
  report.planned = 500;
  report.link.controller.telegrams = 500;
  report.link.wire = {.lost = 5, .duplicated = 3, .swapped = 2};
  CHECK(problem(report).empty());
  CHECK(text(report) ==
        "Simulated into trace.pcap, 6.0 s of 6.0 s: the plan was played to its end.\n"
        "telegrams                      500 one every 12 ms\n"
        "  lost on purpose                5\n"
        "  duplicated on purpose          3\n"
        "  swapped on purpose             2 pairs\n");
  report.link.controller.telegrams = 250;
  CHECK_THAT(text(report), ContainsSubstring("3.0 s of 6.0 s: it ended before the plan was over"));
}

TEST_CASE("each kind of refusal is counted, and the first fault said", "[simulation_report]") {
  auto report = flawless();
  refuse(report, ReplyFault::wrong_type, 2);
  refuse(report, ReplyFault::wrong_ipoc, 1);
  CHECK_THAT(text(report), ContainsSubstring("replies refused                  2 wrong Type\n"
                                             "replies refused                  1 wrong IPOC\n"
                                             "  first reply to IPOC 7: wrong IPOC\n"));
  CHECK(
      problem(report) ==
      "3 replies were refused (the first fault: reply to IPOC 7: wrong IPOC): correct the server");
  refuse(report, ReplyFault::late, 2);
  CHECK_THAT(problem(report), ContainsSubstring("3 replies were refused and 2 were late (the"));
}

TEST_CASE("a late reply is a problem unless its telegram was swapped on purpose",
          "[simulation_report]") {
  auto report = flawless();
  refuse(report, ReplyFault::late, 2);
  report.link.controller.unanswered = 2;
  CHECK_THAT(problem(report), ContainsSubstring("2 replies were late (the first fault: "));
  report.link.wire.swapped = 2;
  CHECK(problem(report).empty());
}

TEST_CASE("the last telegram of all may be held back for a swap that never comes",
          "[simulation_report]") {
  auto report = flawless();
  refuse(report, ReplyFault::late, 1);
  report.link.controller.unanswered = 1;
  CHECK_THAT(problem(report), ContainsSubstring("1 reply was late"));
  report.swaps = true;
  CHECK(problem(report).empty());
}

TEST_CASE("a second reply is a problem unless its telegram was duplicated on purpose",
          "[simulation_report]") {
  auto report = flawless();
  refuse(report, ReplyFault::repeated, 3);
  CHECK_THAT(problem(report), ContainsSubstring("3 replies were refused"));
  report.link.wire.duplicated = 2;
  CHECK_THAT(problem(report), ContainsSubstring("1 reply was refused"));
  report.link.wire.duplicated = 3;
  CHECK(problem(report).empty());
}

TEST_CASE("an unanswered cycle is a problem unless its telegram was lost on purpose",
          "[simulation_report]") {
  auto report = flawless();
  report.link.controller.unanswered = 4;
  CHECK(problem(report) ==
        "4 cycles were not answered by 127.0.0.1:49152: see whether it was stopped, and what keeps "
        "it busy");
  report.link.wire.lost = 3;
  CHECK_THAT(problem(report), ContainsSubstring("1 cycle was not answered"));
  report.link.wire.lost = 4;
  CHECK(problem(report).empty());
}

TEST_CASE("a server that never answers is told from one that ceased to", "[simulation_report]") {
  auto report = flawless();
  report.link.end = End::timed_out;
  report.link.controller.unanswered = report.link.controller.longest_unanswered = 100;
  CHECK_THAT(text(report), ContainsSubstring("the controller stopped for want of replies"));
  CHECK_THAT(problem(report), ContainsSubstring("100 cycles were not answered"));

  // A plan that is shorter than the Timeout is over before the controller stops.
  report.link.controller.replies = report.link.controller.accepted = 0;
  for (const auto end : {End::timed_out, End::done}) {
    report.link.end = end;
    CHECK(problem(report) ==
          "nobody answered at 127.0.0.1:49152: start `sweepd run` there, or check address and "
          "port");
  }
}

TEST_CASE("a controller that stops is a problem though every loss was on purpose",
          "[simulation_report]") {
  auto report = flawless();
  report.link.end = End::timed_out;
  report.link.wire.lost = 10;
  report.link.controller.unanswered = report.link.controller.longest_unanswered = 10;
  CHECK_THAT(problem(report), ContainsSubstring("10 cycles were not answered"));
}

TEST_CASE("a connection that broke is a problem of its own, whatever else is missing then",
          "[simulation_report]") {
  auto report = flawless();
  report.link.end = End::disconnected;
  report.link.disconnection = "the server closed the connection";
  report.link.controller.unanswered = report.link.controller.longest_unanswered = 1;
  CHECK_THAT(text(report), ContainsSubstring("the connection broke"));
  CHECK_THAT(problem(report),
             ContainsSubstring("127.0.0.1:49152 broke: the server closed the connection: see"));
}

TEST_CASE("a controller that only sends is content without replies, not with them",
          "[simulation_report]") {
  auto report = flawless();
  report.only_send = true;
  report.link.controller.replies = report.link.controller.accepted = 0;
  CHECK(problem(report).empty());
  CHECK_THAT(text(report),
             ContainsSubstring("replies                          0 none expected: ONLYSEND"));
  report.link.controller.replies = 1;
  refuse(report, ReplyFault::unasked, 1);
  CHECK_THAT(problem(report), ContainsSubstring("1 reply was refused"));
}

TEST_CASE("a run that a signal ended is not whole", "[simulation_report]") {
  auto report = flawless();
  report.interrupted = true;
  CHECK_THAT(text(report), ContainsSubstring("a signal stopped it"));
  CHECK(problem(report) ==
        "a signal stopped the simulation before the plan was over: run it again");
}

TEST_CASE("what this machine could not send or slept over is said", "[simulation_report]") {
  auto report = flawless();
  report.link.skipped = 12;
  report.link.controller.telegrams -= 12;
  CHECK_THAT(text(report), ContainsSubstring("cycles overslept                12 by this machine: "
                                             "no telegrams, IPOC went on") &&
                               ContainsSubstring("the plan was played to its end"));
  CHECK(problem(report).empty());
  report.link.send_failures = 1;
  report.link.first_send_failure = "Network is unreachable";
  CHECK_THAT(text(report),
             ContainsSubstring("datagrams not sent               1 first: Network is unreachable"));
  CHECK_THAT(problem(report),
             ContainsSubstring("1 datagram could not be sent to 127.0.0.1:49152: Network"));
}
