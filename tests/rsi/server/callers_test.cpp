#include "rsi/server/callers.hpp"

#include "tests/catch.hpp"

using namespace std::chrono_literals;
using rsi::Callers;

namespace {

constexpr std::uint32_t kCaller = 0x0a000001;
constexpr std::uint32_t kOther = 0x0a000002;
constexpr Callers::Time kBound{100s};

/// A port that is looked at every 20 ms, and controllers whose IPOC counts milliseconds since RSI
/// was switched on.
struct Port {
  Port() { callers.deaf_until(kBound); }
  void silent_until(Callers::Time end) {
    for (; now < end; now += 20ms) callers.heard_all_until(now);
  }
  bool hear(std::uint32_t address, std::uint64_t missed = 0) {
    callers.hear(address, now);
    const auto ipoc = std::chrono::duration_cast<std::chrono::milliseconds>(now - on_since);
    callers.telegram({address, source}, static_cast<std::uint64_t>(ipoc.count()), now, missed);
    return callers.began(address);
  }
  void switch_on_again() {
    on_since = now - 7s;
    ++source;
  }
  Callers callers;
  Callers::Time now = kBound, on_since = kBound - 50s;
  std::uint16_t source = 40000;
};

}  // namespace

TEST_CASE("a stream that is heard at once after the port was bound did not begin there",
          "[callers][issue11][point_1]") {
  Port port;
  for (port.now += 4ms; port.now < kBound + 5s; port.now += 4ms) {
    CHECK_FALSE(port.hear(kCaller));
    port.callers.heard_all_until(port.now);
  }
}

TEST_CASE("a stream begins behind a second of silence, and goes on after any pause",
          "[callers][issue11][point_1]") {
  Port port;
  SECTION("since the port was bound") {
    port.silent_until(kBound + 980ms);
    CHECK_FALSE(port.hear(kCaller));
  }
  SECTION("since its last telegram") {
    port.silent_until(kBound + 200ms);
    CHECK_FALSE(port.hear(kCaller));
    port.silent_until(kBound + 1s);
    CHECK_FALSE(port.hear(kCaller));
  }
  const auto last = port.now;
  port.silent_until(last + 1040ms);
  port.switch_on_again();
  CHECK(port.hear(kCaller));
  port.now += 4ms;
  CHECK(port.hear(kCaller));
  port.silent_until(port.now + 500ms);  // RSI is switched off and on
  CHECK(port.hear(kCaller));
}

TEST_CASE("a stream that goes on behind a silence, as where the network was down, did not begin",
          "[callers]") {
  Port port;
  port.silent_until(kBound + 20ms);
  const int heard = GENERATE(1, 5, 100);  // telegrams before it
  CAPTURE(heard);
  for (int k = 0; k < heard; ++k, port.now += 12ms) {
    CHECK_FALSE(port.hear(kCaller));
    port.callers.heard_all_until(port.now);
  }
  const auto last = port.now - 12ms;
  port.silent_until(port.now + GENERATE(1040ms, 20000ms));
  SECTION("at its pace") {
    CHECK_FALSE(port.hear(kCaller));
    port.now += 12ms;
    CHECK_FALSE(port.hear(kCaller));
    port.silent_until(port.now + 2s);  // and again
    CHECK_FALSE(port.hear(kCaller));
    port.silent_until(port.now + 2s);
    port.switch_on_again();
    CHECK(port.hear(kCaller));
  }
  SECTION("with one that was held up") {
    port.on_since += port.now - last + 5ms;
    CHECK_FALSE(port.hear(kCaller));
  }
  SECTION("or began anew, by another port") {
    ++port.source;
    CHECK(port.hear(kCaller));
  }
  SECTION("or by another IPOC") {
    port.on_since = port.now;
    CHECK(port.hear(kCaller));
  }
}

TEST_CASE("a stream whose controller has missed replies for long had begun before", "[callers]") {
  Port port;
  port.silent_until(kBound + 2s);
  CHECK_FALSE(port.hear(kCaller, 87));
  port.now += 12ms;
  CHECK_FALSE(port.hear(kCaller, 88));
  CHECK(port.hear(kOther, 3));  // its first telegrams were lost
}

TEST_CASE("a standstill of this program is no silence", "[callers][issue11][point_1]") {
  Port port;
  port.silent_until(kBound + 20ms);
  CHECK_FALSE(port.hear(kCaller));
  // Nobody has looked for five seconds; what came then waits.
  port.now += 5s;
  for (int waiting = 0; waiting < 10; ++waiting) CHECK_FALSE(port.hear(kCaller));
  // The look that took them began five seconds ago.
  port.callers.heard_all_until(port.now - 5s);
  CHECK_FALSE(port.hear(kCaller));
}

TEST_CASE("who was lost unseen may have spoken", "[callers][issue11][point_1]") {
  Port port;
  port.silent_until(kBound + 2s);
  port.callers.deaf_until(port.now);
  CHECK_FALSE(port.hear(kCaller));
  port.silent_until(port.now + 2s);
  port.switch_on_again();
  CHECK(port.hear(kCaller));
  port.callers.deaf_until(port.now);
  CHECK(port.hear(kCaller));  // it has begun before
}

TEST_CASE("another's silence tells nothing, and one that was pushed out counts as heard",
          "[callers][issue11][point_1]") {
  Port port;
  port.silent_until(kBound + 20ms);
  CHECK_FALSE(port.hear(kCaller));
  for (int k = 0; k < 200; ++k) {
    port.silent_until(port.now + 20ms);
    CHECK_FALSE(port.hear(kCaller));
  }
  CHECK(port.hear(kOther));
  for (std::uint32_t many = 1; many <= 8; ++many) port.hear(kOther + many);
  CHECK_FALSE(port.hear(kCaller));
}

TEST_CASE("a controller is known whatever its IPOC rises by, and nobody takes its place",
          "[callers]") {
  const std::uint64_t step = GENERATE(1u, 4u, 999u, 1000u, 4000u, 4'000'000u);
  CAPTURE(step);
  Callers callers;
  auto now = kBound;
  std::uint64_t ipoc = ~std::uint64_t{0} - 10 * step;  // it passes 2^64
  for (std::uint64_t k = 0; k < 300; ++k, now += 4ms) {
    callers.heard_all_until(now);
    callers.hear(kCaller, now);
    // A clock of microseconds is not even; some are lost.
    if (k % 50 < 48) callers.telegram({kCaller, 40000}, ipoc + (step > 1000 ? k % 3 : 0), now);
    ipoc += step;
    if (k < 5) continue;
    CHECK(callers.rank(kCaller) == Callers::kSteps);
    CHECK_FALSE(callers.may_be_controller(kOther));
  }
}

TEST_CASE("IPOCs that rise at random are no stream", "[callers]") {
  Callers callers;
  auto now = kBound;
  std::uint64_t ipoc = 1;
  for (int k = 0; k < 100; ++k, now += 4ms) {
    callers.heard_all_until(now);
    callers.hear(kCaller, now);
    callers.telegram({kCaller, 40000}, ipoc *= 0x9e37'79b9'7f4a'7c15, now);
    CHECK(callers.rank(kCaller) < Callers::kSteps);
  }
}
