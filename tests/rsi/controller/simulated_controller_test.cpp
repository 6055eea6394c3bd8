#include "rsi/controller/simulated_controller.hpp"

#include <string>
#include <utility>

#include "rsi/telegram/ipoc.hpp"
#include "tests/catch.hpp"

using namespace std::chrono_literals;
using rsi::EthernetConfig;
using rsi::ReplyFault;
using rsi::ReplyRule;
using Type = EthernetConfig::Element::Type;
using Catch::Matchers::ContainsSubstring;

namespace {

const rsi::Endpoint kExpected{0x0a000005, 49152};
const rsi::Endpoint kStranger{0x0a000006, 49152};

EthernetConfig config_with_corrections() {
  EthernetConfig config;
  config.sentype = "ImFree";
  config.send = {{"DEF_Delay", Type::LONG, 0, false, 0}};
  config.receive = {{"AK.A1", Type::DOUBLE, 1, true, 0}, {"GPIO.01", Type::BOOL, 2, true, 0}};
  return config;
}

/// A controller at 4 ms with its time, cycle by cycle.
struct ControllerBench {
  EthernetConfig config = config_with_corrections();
  rsi::SimulatedController controller;
  rsi::Reply reply{config};
  std::chrono::nanoseconds now = 1000s;
  std::string telegram;

  explicit ControllerBench(EthernetConfig ethernet = config_with_corrections(),
                           std::uint64_t timeout = 100, ReplyRule rule = ReplyRule::sweepd)
      : config(std::move(ethernet)),
        controller(config, {.server = kExpected,
                            .cycle = 4ms,
                            .first_ipoc = 500,
                            .timeout = timeout,
                            .rule = rule}) {}

  bool cycle() {
    now += 4ms;
    telegram.clear();
    const bool runs = controller.next_telegram({}, telegram);
    controller.sent(now);
    return runs;
  }
  void answer(std::uint64_t ipoc, std::chrono::nanoseconds after = 100us) {
    controller.on_reply(reply.with_ipoc(std::to_string(ipoc)), kExpected, now + after);
  }
  void answer() { answer(controller.ipoc()); }
  void answer(const std::string& text) { controller.on_reply(text, kExpected, now + 1ms); }

  std::string delay() const {
    const auto at = telegram.find("D=\"") + 3;
    return telegram.substr(at, telegram.find('"', at) - at);
  }
  std::uint64_t count(ReplyFault fault) const { return controller.counts().of(fault); }
  std::uint64_t faults() const {
    std::uint64_t sum = 0;
    for (const auto number : controller.counts().faults) sum += number;
    return sum;
  }
};

}  // namespace

TEST_CASE("IPOC rises by the milliseconds of a cycle, whatever happens to replies",
          "[simulated_controller]") {
  ControllerBench bench;
  for (std::uint64_t k = 0; k < 20; ++k) {
    REQUIRE(bench.cycle());
    CHECK(rsi::find_ipoc(bench.telegram) == std::to_string(500 + 4 * k));
    if (k % 3 == 0) bench.answer();
  }
  rsi::SimulatedController slow(config_with_corrections(),
                                {.server = kExpected, .cycle = 12ms, .first_ipoc = 500});
  std::string telegrams;
  REQUIRE(slow.next_telegram({}, telegrams));
  REQUIRE(slow.next_telegram({}, telegrams));
  CHECK(slow.ipoc() == 512);
}

TEST_CASE("a reply in time is accepted and its latency counted", "[simulated_controller]") {
  ControllerBench bench;
  for (int k = 0; k < 10; ++k) {
    bench.cycle();
    bench.answer();
  }
  bench.controller.finish();
  CHECK(bench.controller.counts().telegrams == 10);
  CHECK(bench.controller.counts().replies == 10);
  CHECK(bench.controller.counts().accepted == 10);
  CHECK(bench.controller.counts().unanswered == 0);
  CHECK(bench.faults() == 0);
  CHECK(bench.controller.first_fault().empty());
  CHECK(bench.controller.latency().count() == 10);
  CHECK(bench.controller.latency().max() == 100us);
}

TEST_CASE("Delay is the run of late packets and 0 again after one in time",
          "[simulated_controller]") {
  // As it was recorded on a controller: 0 0 1 0 1 2 0 for replies yes no yes no no yes.
  ControllerBench bench;
  std::string delays;
  for (const bool answered : {true, false, true, false, false, true, true}) {
    bench.cycle();
    delays += bench.delay() + " ";
    if (answered) bench.answer();
  }
  CHECK(delays == "0 0 1 0 1 2 0 ");
  CHECK(bench.controller.counts().unanswered == 3);
  CHECK(bench.controller.counts().longest_unanswered == 2);
}

TEST_CASE("a late reply counts for no cycle, neither before nor after the next telegram",
          "[simulated_controller]") {
  ControllerBench bench;
  bench.cycle();
  bench.answer(500, 4ms);  // the cycle is over, even if the next telegram is not out yet
  CHECK(bench.count(ReplyFault::late) == 1);
  CHECK_THAT(bench.controller.first_fault(),
             ContainsSubstring("reply to IPOC 500 from 10.0.0.5:49152: late: it took 4000 µs"));
  bench.cycle();
  CHECK(bench.delay() == "1");
  bench.answer(500);
  CHECK(bench.count(ReplyFault::late) == 2);
  bench.answer(504, 3999us);
  CHECK(bench.controller.counts().accepted == 1);
  bench.cycle();
  CHECK(bench.delay() == "0");
}

TEST_CASE("a reply that comes while the controller skips a cycle is late, and not a second one",
          "[simulated_controller]") {
  ControllerBench bench;
  bench.cycle();
  bench.controller.skip_cycle();
  bench.answer();
  CHECK(bench.count(ReplyFault::late) == 1);
  CHECK(bench.count(ReplyFault::repeated) == 0);
  CHECK(bench.controller.counts().accepted == 0);
  CHECK(bench.controller.counts().unanswered == 1);
}

TEST_CASE("the controller stops after as many unanswered cycles in a row as Timeout says",
          "[simulated_controller]") {
  ControllerBench bench(config_with_corrections(), 10);
  for (int k = 0; k < 9; ++k) REQUIRE(bench.cycle());
  bench.answer();
  for (int k = 0; k < 10; ++k) REQUIRE(bench.cycle());
  CHECK_FALSE(bench.controller.stopped());
  CHECK(bench.delay() == "9");
  CHECK_FALSE(bench.cycle());
  CHECK(bench.controller.stopped());
  CHECK(bench.telegram.empty());
  CHECK_FALSE(bench.cycle());
  CHECK(bench.controller.counts().telegrams == 19);
  CHECK(bench.controller.counts().unanswered == 18);
  CHECK(bench.controller.counts().longest_unanswered == 10);
}

TEST_CASE("with ONLYSEND the controller expects nothing and never stops",
          "[simulated_controller]") {
  auto config = config_with_corrections();
  config.only_send = true;
  ControllerBench bench(config, 3);
  for (int k = 0; k < 1000; ++k) REQUIRE(bench.cycle());
  CHECK(bench.delay() == "0");
  CHECK(bench.controller.counts().unanswered == 0);
  bench.answer();
  CHECK(bench.count(ReplyFault::unasked) == 1);
}

TEST_CASE("each kind of wrong reply is dropped, counted and put into words",
          "[simulated_controller]") {
  ControllerBench bench;
  bench.cycle();
  const std::string good =
      "<Sen Type=\"ImFree\"><AK A1=\"0.0\"/><GPIO 01=\"0\"/><IPOC>500</IPOC></Sen>";
  ReplyFault kind{};
  std::string words;

  SECTION("from elsewhere") {
    bench.controller.on_reply(good, kStranger, bench.now + 1ms);
    kind = ReplyFault::wrong_source;
    words = "reply from 10.0.0.6:49152: wrong source: expected 10.0.0.5:49152";
  }
  SECTION("unreadable") {
    bench.answer("<Sen Type=\"ImFree\"><IPOC>500</IPOC>");
    kind = ReplyFault::malformed;
    words = "malformed: it ends too early";
  }
  SECTION("another Type") {
    bench.answer("<Sen Type=\"KMC\"><AK A1=\"0\"/><GPIO 01=\"0\"/><IPOC>500</IPOC></Sen>");
    kind = ReplyFault::wrong_type;
    words = "to IPOC 500 from 10.0.0.5:49152: wrong Type: expected \"ImFree\", found \"KMC\"";
  }
  SECTION("an IPOC of the future") {
    bench.answer(504);
    kind = ReplyFault::wrong_ipoc;
    words = "reply to IPOC 504 from 10.0.0.5:49152: wrong IPOC: the last telegram has 500";
  }
  SECTION("a tag left out") {
    bench.answer("<Sen Type=\"ImFree\"><AK A1=\"0.0\"/><IPOC>500</IPOC></Sen>");
    kind = ReplyFault::missing_tag;
    words = "missing tag: GPIO.01";
  }

  CHECK(bench.faults() == 1);
  CHECK(bench.count(kind) == 1);
  CHECK_THAT(bench.controller.first_fault(), ContainsSubstring(words));
  CHECK(bench.controller.first_fault(kind) == bench.controller.first_fault());
  CHECK(bench.controller.counts().accepted == 0);
  // The cycle still waits, and a right reply ends it.
  bench.answer(good);
  CHECK(bench.controller.counts().accepted == 1);
  CHECK(bench.faults() == 1);
}

TEST_CASE("a controller accepts what is left out, what it does not know, and any value",
          "[simulated_controller][issue11][point_18]") {
  ControllerBench bench(config_with_corrections(), 100, ReplyRule::controller);
  const auto answered = [&](const std::string& tags) {
    bench.cycle();
    bench.answer("<Sen Type=\"ImFree\">" + tags + "<IPOC>" +
                 std::to_string(bench.controller.ipoc()) + "</IPOC></Sen>");
  };
  answered("");
  answered("<AK A1=\"0\"/><Unknown x=\"1\"/>");
  CHECK(bench.controller.counts().remarks_of(ReplyFault::missing_tag) == 2);
  CHECK_THAT(bench.controller.first_fault(ReplyFault::missing_tag),
             ContainsSubstring("reply to IPOC 500") && ContainsSubstring("missing tag: AK.A1"));
  answered("<AK A1=\"1.09\"/><GPIO 01=\"0\"/>");
  CHECK(bench.controller.counts().remarks_of(ReplyFault::not_zero) == 1);
  CHECK_THAT(bench.controller.first_fault(ReplyFault::not_zero),
             ContainsSubstring("not zero: AK.A1 = 1.09"));
  CHECK(bench.controller.counts().accepted == 3);
  CHECK(bench.faults() == 0);
  CHECK(bench.controller.first_fault().empty());

  bench.cycle();
  bench.answer("<Sen Type=\"KMC\"><IPOC>512</IPOC></Sen>");
  CHECK(bench.count(ReplyFault::wrong_type) == 1);
  CHECK(bench.controller.counts().accepted == 3);
}

TEST_CASE("a value is obeyed as a controller would, but counted with its tag",
          "[simulated_controller]") {
  ControllerBench bench;
  bench.cycle();
  bench.answer("<Sen Type=\"ImFree\"><AK A1=\"0.1\"/><GPIO 01=\"0\"/><IPOC>500</IPOC></Sen>");
  CHECK(bench.count(ReplyFault::not_zero) == 1);
  CHECK_THAT(bench.controller.first_fault(), ContainsSubstring("not zero: AK.A1 = 0.1"));
  CHECK(bench.controller.counts().accepted == 1);
  // Nor does one go unseen because it came late.
  bench.cycle();
  bench.answer("<Sen Type=\"ImFree\"><AK A1=\"0.0\"/><GPIO 01=\"1\"/><IPOC>500</IPOC></Sen>");
  CHECK(bench.count(ReplyFault::not_zero) == 2);
  CHECK(bench.count(ReplyFault::late) == 1);
}

TEST_CASE("a second reply to one telegram is counted once", "[simulated_controller]") {
  ControllerBench bench;
  bench.cycle();
  bench.answer();
  bench.answer();
  CHECK(bench.controller.counts().accepted == 1);
  CHECK(bench.count(ReplyFault::repeated) == 1);
}

TEST_CASE("a reply before the first telegram, or with an IPOC of none, answers nothing",
          "[simulated_controller]") {
  ControllerBench bench;
  bench.answer(0);
  CHECK(bench.count(ReplyFault::wrong_ipoc) == 1);
  bench.cycle();
  bench.cycle();
  bench.answer(502);
  bench.answer(496);
  CHECK(bench.count(ReplyFault::wrong_ipoc) == 3);
}

TEST_CASE("after a restart of RSI the IPOC starts again and old replies are of no telegram",
          "[simulated_controller]") {
  ControllerBench bench(config_with_corrections(), 2);
  while (bench.cycle()) {
  }
  CHECK(bench.controller.stopped());
  bench.controller.restart(40);
  CHECK_FALSE(bench.controller.stopped());
  bench.answer(500);
  CHECK(bench.count(ReplyFault::wrong_ipoc) == 1);
  REQUIRE(bench.cycle());
  CHECK(bench.controller.ipoc() == 40);
  CHECK(bench.delay() == "0");
  bench.answer(500);
  CHECK(bench.count(ReplyFault::wrong_ipoc) == 2);
  bench.answer(40);
  CHECK(bench.controller.counts().accepted == 1);
}

TEST_CASE("an IPOC that passes 2^64 is none but the next one", "[simulated_controller]") {
  ControllerBench bench;
  bench.controller.restart(0 - std::uint64_t{8});
  for (int k = 0; k < 4; ++k) {
    REQUIRE(bench.cycle());
    bench.answer();
  }
  CHECK(bench.controller.ipoc() == 4);
  CHECK(bench.controller.counts().accepted == 4);
  bench.answer(0);
  CHECK(bench.count(ReplyFault::late) == 1);
  bench.answer(8);
  CHECK(bench.count(ReplyFault::wrong_ipoc) == 1);
}

TEST_CASE("options that no controller has are refused", "[simulated_controller]") {
  const auto refused = [](auto change) {
    rsi::SimulatedController::Options options;
    change(options);
    CHECK_THROWS_AS(rsi::SimulatedController({}, options), std::invalid_argument);
  };
  refused([](auto& options) { options.cycle = 0ms; });
  refused([](auto& options) { options.timeout = 0; });
  refused([](auto& options) { options.precision = 99; });
}
