#include "daemon/stream/sample_clock.hpp"

#include <chrono>
#include <vector>

#include "tests/catch.hpp"
#include "tests/rsi/link_stream.hpp"

using rsi::test::kStart;
using sweepd::SampleClock;
using namespace std::chrono_literals;

namespace {

// The time of reception is a difference of nanoseconds, the rest whole milliseconds.
const auto about = [](double seconds) { return Approx(seconds).margin(1e-9); };

}  // namespace

TEST_CASE("IPOC counts milliseconds: the network's jitter is not in the time", "[sample_clock]") {
  SampleClock clock;
  CHECK(clock.seconds(1'525'084, kStart, true, false) == 0);
  CHECK(clock.seconds(1'525'088, kStart + 9ms, true, false) == about(0.004));
  CHECK(clock.seconds(1'525'092, kStart + 9ms, true, false) == about(0.008));
  CHECK(clock.seconds(1'526'084, kStart + 1s, true, false) == about(1));
}

TEST_CASE("with a cycle of 12 ms an IPOC is a millisecond all the same", "[sample_clock]") {
  SampleClock clock;
  static_cast<void>(clock.seconds(12, kStart, true, false));
  CHECK(clock.seconds(1212, kStart + 5s, true, false) == about(1.2));
}

TEST_CASE("a telegram that was overtaken gets the time of its IPOC", "[sample_clock]") {
  SampleClock clock;
  static_cast<void>(clock.seconds(100, kStart, true, false));
  static_cast<void>(clock.seconds(108, kStart + 8ms, true, false));
  CHECK(clock.seconds(104, kStart + 9ms, true, false) == about(0.004));
  // Even one that is older than the first.
  CHECK(clock.seconds(96, kStart + 9ms, true, false) == about(-0.004));
}

TEST_CASE("an IPOC that rises by one a telegram is no clock: the time of reception is",
          "[sample_clock]") {
  SampleClock clock;
  CHECK(clock.seconds(1, kStart, false, false) == 0);
  CHECK(clock.seconds(2, kStart + 4ms, false, false) == about(0.004));
  CHECK(clock.seconds(3, kStart + 9ms, false, false) == about(0.009));
}

TEST_CASE("once it is known what the IPOC counts, time goes on from the newest sample",
          "[sample_clock]") {
  SampleClock clock;
  static_cast<void>(clock.seconds(1000, kStart, true, false));
  CHECK(clock.seconds(1010, kStart + 4ms, true, false) == about(0.010));
  CHECK(clock.seconds(1020, kStart + 9ms, false, false) == about(0.015));
  CHECK(clock.seconds(1040, kStart + 16ms, false, false) == about(0.022));
  // One that was overtaken came late: it has the time that its IPOC has at this pace.
  CHECK(clock.seconds(1030, kStart + 17ms, false, false) == about(0.018));
  CHECK(clock.seconds(1050, kStart + 21ms, true, false) == about(0.032));
}

TEST_CASE("after a restart time goes on by reception, and never back", "[sample_clock]") {
  SampleClock clock;
  static_cast<void>(clock.seconds(50'000, kStart, true, false));
  static_cast<void>(clock.seconds(50'004, kStart + 4ms, true, false));
  SECTION("after a while") {
    CHECK(clock.seconds(8, kStart + 30s, true, true) == about(30));
    CHECK(clock.seconds(12, kStart + 30s + 5ms, true, false) == about(30.004));
  }
  SECTION("at once: at least half a second later, so that no stroke spans it") {
    CHECK(clock.seconds(8, kStart + 8ms, true, true) == about(0.504));
    CHECK(clock.seconds(12, kStart + 12ms, true, false) == about(0.508));
  }
  SECTION("with the computer's clock set back in between") {
    CHECK(clock.seconds(8, kStart - 1h, true, true) == about(0.504));
  }
  SECTION("twice") {
    static_cast<void>(clock.seconds(8, kStart + 30s, true, true));
    CHECK(clock.seconds(8, kStart + 60s, true, true) == about(60));
  }
}

TEST_CASE("the same datagrams give the same times, bit for bit", "[sample_clock]") {
  const auto run = [] {
    SampleClock clock;
    std::vector<double> times;
    for (std::uint64_t k = 0; k < 1000; ++k)
      times.push_back(clock.seconds(1'525'084 + 4 * k, kStart + k * 4'000'123ns, true, k == 500));
    return times;
  };
  CHECK(run() == run());
}
