#include "daemon/stream/sample_relay.hpp"

#include <algorithm>
#include <future>
#include <stdexcept>
#include <string>

#include "tests/catch.hpp"

using sweepd::SampleRelay;
using sweepd::SeenSample;

namespace {

/// More than wait for the work at most.
constexpr int kMany = 20'000;
/// More than one block, and not so many that they have to wait.
constexpr int kSome = 3000;

/// Whose row is gone at once.
void pass(SampleRelay& relay, int number, bool with_currents = false) {
  const std::string row = "row " + std::to_string(number);
  SeenSample seen;
  seen.sample.time_s = number;
  seen.row = row;
  if (with_currents) seen.currents.emplace();
  relay.pass(seen);
}

}  // namespace

TEST_CASE("samples that are passed on are worked on in their order, whole, and all when drained",
          "[sample_relay]") {
  std::vector<std::string> rows;
  std::vector<double> times;
  std::vector<std::size_t> currents;
  SampleRelay relay([&](const SeenSample& seen) {
    rows.emplace_back(seen.row);
    times.push_back(seen.sample.time_s);
    if (seen.currents) currents.push_back(rows.size() - 1);
  });
  for (int n = 0; n < kMany; ++n) {
    pass(relay, n, n == 300);
    if (n == 1000) {
      relay.drain();
      REQUIRE(rows.size() == 1001);
    }
  }
  relay.drain();
  REQUIRE(rows.size() == kMany);
  CHECK(std::is_sorted(times.begin(), times.end()));
  CHECK(rows.back() == "row 19999");
  CHECK(times.back() == 19999);
  CHECK(currents == std::vector<std::size_t>{300});
  relay.drain();  // nothing is left
}

TEST_CASE("what the work on a sample throws is thrown where samples are passed on",
          "[sample_relay]") {
  const auto fails_at = [](double time_s) {
    return [time_s](const SeenSample& seen) {
      if (seen.sample.time_s == time_s) throw std::runtime_error("no room");
    };
  };
  SampleRelay last(fails_at(7));
  for (int n = 0; n < 8; ++n) pass(last, n);
  CHECK_THROWS_WITH(last.drain(), "no room");

  SampleRelay first(fails_at(0));
  const auto pass_all = [&] {
    for (int n = 0; n < kMany; ++n) pass(first, n);
  };
  CHECK_THROWS_WITH(pass_all(), "no room");
}

TEST_CASE("a relay whose reader has given up ends without what waits", "[sample_relay]") {
  std::promise<void> begun, go_on;
  int worked_on = 0;
  {
    SampleRelay relay([&, goes_on = go_on.get_future().share()](const SeenSample&) {
      if (worked_on++ == 0) begun.set_value();
      goes_on.wait();
    });
    for (int n = 0; n < kSome; ++n) pass(relay, n);
    begun.get_future().wait();
    go_on.set_value();
  }
  CHECK(worked_on < kSome);
}

TEST_CASE("other work is done where no sample waits, to its end", "[sample_relay]") {
  int worked_on = 0, left = 50;
  SampleRelay relay([&](const SeenSample&) { ++worked_on; }, [&] { return --left > 0; });
  for (int n = 0; n < kMany; ++n) pass(relay, n);
  relay.drain();
  relay.wait_for_beside();
  CHECK(worked_on == kMany);
  CHECK(left == 0);

  SampleRelay failing([](const SeenSample&) {}, []() -> bool { throw std::runtime_error("torn"); });
  CHECK_THROWS_WITH(failing.wait_for_beside(), "torn");
}
