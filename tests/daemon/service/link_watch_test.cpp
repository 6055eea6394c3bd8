#include "daemon/service/link_watch.hpp"

#include "tests/catch.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace std::chrono_literals;

TEST_CASE("trouble on the link is said at once, and then once a minute with all that came since",
          "[link_watch][issue11][point_16]") {
  sweepd::LinkComplaints complaints;
  rsi::Server::Counts counts;
  auto now = std::chrono::steady_clock::time_point(1h);
  counts.answered = counts.superseded = counts.unanswerable = 1000;  // no trouble of the link's
  CHECK(complaints.about(counts, now).empty());

  counts.foreign = 1;
  const auto first = complaints.about(counts, now);
  REQUIRE(first.size() == 1);
  CHECK_THAT(first[0], ContainsSubstring("1 datagram or connection was not from the controller"));
  CHECK_THAT(first[0], ContainsSubstring("or without an IPOC before anything"));
  for (int second = 0; second < 59; ++second) {
    counts.foreign += 250;
    CHECK(complaints.about(counts, now += 1s).empty());
  }
  const auto again = complaints.about(counts, now += 1s);
  REQUIRE(again.size() == 1);
  CHECK_THAT(again[0], ContainsSubstring("14750 datagrams or connections were not"));
  CHECK(complaints.about(counts, now += 5min).empty());
}

TEST_CASE("what waits for its minute is said at the end", "[link_watch]") {
  sweepd::LinkComplaints complaints;
  rsi::Server::Counts counts;
  const auto now = std::chrono::steady_clock::time_point(1h);
  counts.foreign = 1;
  CHECK(complaints.about(counts, now).size() == 1);
  counts.foreign = 8;
  CHECK(complaints.about(counts, now + 1s).empty());
  const auto rest = complaints.rest(counts);
  REQUIRE(rest.size() == 1);
  CHECK(rest[0].starts_with("7 datagrams or connections were not from the controller"));
  CHECK(complaints.rest(counts).empty());
}

TEST_CASE("bytes of a TCP stream that are no telegram are said", "[link_watch]") {
  sweepd::LinkComplaints complaints;
  rsi::Server::Counts counts;
  counts.skipped = 15;
  const auto said = complaints.about(counts, std::chrono::steady_clock::time_point(1h));
  REQUIRE(said.size() == 1);
  CHECK(said[0].starts_with("15 bytes were left out of a TCP stream, being in no telegram: "));
}

TEST_CASE("each kind of trouble is said by itself, with what to do", "[link_watch]") {
  sweepd::LinkComplaints complaints;
  rsi::Server::Counts counts;
  counts.refused = counts.send_failures = counts.dropped = counts.cut = counts.foreign =
      counts.overflows = counts.not_begun = counts.missed = counts.skipped = 7;
  const auto all = complaints.about(counts, std::chrono::steady_clock::time_point(1h));
  REQUIRE(all.size() == 9);
  for (const auto& text : all) {
    INFO(text);
    CHECK(text.starts_with("7 "));
    CHECK(text.find(": ") != text.npos);
  }
}

TEST_CASE("a stream that is not answered is said at once, however soon it follows another",
          "[link_watch][issue11][point_1]") {
  sweepd::LinkComplaints complaints;
  rsi::Server::Counts counts;
  auto now = std::chrono::steady_clock::time_point(1h);
  for (int stream = 0; stream < 3; ++stream) {
    complaints.new_stream();
    ++counts.not_begun;
    CHECK_THAT(complaints.about(counts, now += 1s).at(0),
               ContainsSubstring("1 telegram was not answered: the stream had begun before"));
    counts.not_begun += 100;
    CHECK(complaints.about(counts, now += 1s).empty());
    complaints.new_stream();
    CHECK(complaints.about(counts, now += 1s).size() == 1);
  }
}
