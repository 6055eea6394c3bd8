#include <algorithm>
#include <sstream>

#include "daemon/results/link_files.hpp"
#include "rsi/link/link.hpp"
#include "tests/catch.hpp"
#include "tests/rsi/link_stream.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace rsi::test;

namespace {

const rsi::Conversation kConversation{kController.address, kServer};

std::string text_of(const rsi::Link& monitor) {
  return sweepd::link_text(kConversation, monitor.report());
}

/// Columns on a terminal: a µ is two bytes and one column.
std::size_t widest_line(const std::string& text) {
  std::istringstream lines(text);
  std::size_t widest = 0;
  for (std::string line; std::getline(lines, line);)
    widest = std::max<std::size_t>(
        widest, static_cast<std::size_t>(std::count_if(line.begin(), line.end(), [](char c) {
          return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
        })));
  return widest;
}

}  // namespace

TEST_CASE("a flawless link is reported in lined up figures", "[link_text]") {
  rsi::Link monitor;
  LinkStream stream(monitor);
  stream.cycles(0, 1000, 50us);
  stream.cycles(1000, 1002, 120us);
  CHECK(text_of(monitor) ==
        "Link of 192.168.1.20 with 192.168.1.10:49152\n"
        "4.004 s from 2025-01-01T00:00:00.000Z\n"
        "\n"
        "Verdict: good\n"
        "  Nothing is wrong with this link.\n"
        "\n"
        "Telegrams                     1002   one every 4 ms, IPOC rises by 4\n"
        "  lost                           0\n"
        "  duplicated                     0\n"
        "  reordered                      0\n"
        "  malformed                      0\n"
        "  restarts of RSI                0\n"
        "  late at controller             0   by its Delay\n"
        "\n"
        "Replies                       1002\n"
        "  in time                     1002   100.000 %, within a cycle\n"
        "  late                           0   later than a cycle\n"
        "  superseded                     0   a newer telegram was answered\n"
        "  unanswered                     0   telegrams without any reply\n"
        "\n"
        "                       p50       p90       p99     p99.9       max\n"
        // Quantiles are right to 1/128; the largest is exact.
        "Reply latency      49.9 µs   49.9 µs   49.9 µs    120 µs    120 µs\n"
        "Cycle jitter        0.0 µs    0.0 µs    0.0 µs    0.0 µs    0.0 µs\n"
        "                earliest 0.0 µs, latest +0.0 µs\n"
        "\n"
        "Reply latency\n"
        "  up to   50.0 µs      1000  ########################################\n"
        "  up to    100 µs         0  \n"
        "  up to    200 µs         2  #\n"
        "\n"
        "Cycle jitter, early or late\n"
        "  up to    1.0 µs      1001  ########################################\n"
        "\n"
        "Slowest replies\n"
        "     latency          at s                  IPOC\n"
        "      120 µs         4.000               1004000\n"
        "      120 µs         4.004               1004004\n"
        "     50.0 µs         0.000               1000000\n"
        "     50.0 µs         0.004               1000004\n"
        "     50.0 µs         0.008               1000008\n"
        "     50.0 µs         0.012               1000012\n"
        "     50.0 µs         0.016               1000016\n"
        "     50.0 µs         0.020               1000020\n"
        "     50.0 µs         0.024               1000024\n"
        "     50.0 µs         0.028               1000028\n");
}

TEST_CASE("a link with every fault fits the terminal and says each one", "[link_text]") {
  rsi::Link monitor;
  LinkStream stream(monitor);
  stream.reply(-1ms, 5);
  stream.cycles(0, 300);
  stream.cycles(310, 400, 4500us);
  stream.telegram(stream.at(400), stream.ipoc(400), 3);
  stream.telegram(stream.at(400), stream.ipoc(400), 3);
  stream.telegram(stream.at(402), stream.ipoc(402));
  stream.telegram(stream.at(402) + 1us, stream.ipoc(401));
  stream.reply(stream.at(403), 17);
  for (std::uint64_t k = 403; k < 450; ++k)
    stream.telegram(stream.at(k) + k % 5 * 1ms, stream.ipoc(k));
  stream.datagram(stream.at(450), "garbage");
  stream.cycles(450, 500);
  stream.clock_off = 100h;
  stream.cycles(500, 600);
  stream.reply(stream.at(600), stream.ipoc(599));
  stream.controller.port = 50001;
  stream.cycles(2'000'000'000, 2'000'000'100);
  const auto text = text_of(monitor);
  INFO(text);
  CHECK(widest_line(text) <= 80);
  for (const char* part :
       {"Verdict: bad", "\n  bad  ", "\n  marginal  ", "\n  note  ", "1 without an IPOC",
        "by its Delay, in 1 run of 3", "clock against IPOC", "repeated", "stray",
        "Telegrams in a row without a reply in time", "Runs of late replies"})
    CHECK_THAT(text, ContainsSubstring(part));
}

TEST_CASE("a stream that is only listened to has no replies to report, and says so",
          "[link_text]") {
  rsi::Link monitor;
  LinkStream stream(monitor);
  for (std::uint64_t k = 0; k < 1000; ++k) stream.telegram(stream.at(k), stream.ipoc(k), {});
  const auto text = text_of(monitor);
  CHECK_THAT(text, ContainsSubstring("Verdict: good\n  note      no reply was seen"));
  CHECK_THAT(text, ContainsSubstring("Replies                       none   ONLYSEND"));
  CHECK_THAT(text, ContainsSubstring("not known: the telegrams carry no Delay"));
  CHECK_THAT(text, !ContainsSubstring("latency"));
}

TEST_CASE("one telegram is enough for a report", "[link_text]") {
  rsi::Link monitor;
  LinkStream stream(monitor);
  stream.telegram(0ms, 7);
  const auto text = text_of(monitor);
  CHECK_THAT(text, ContainsSubstring("Telegrams                        1\n"));
  CHECK_THAT(text, !ContainsSubstring("jitter"));
}
