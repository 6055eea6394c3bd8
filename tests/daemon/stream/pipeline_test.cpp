#include "daemon/stream/pipeline.hpp"

#include <chrono>
#include <cmath>
#include <memory>

#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/telegrams.hpp"

using sweepd::Pipeline;
using sweepd::SignalNames;
using namespace sweepd::test;
using namespace std::chrono_literals;

namespace {

/// A pipeline, and all that came out of it.
class Watched : public sweepd::StreamSink {
 public:
  explicit Watched(const SignalNames& signals = {}) : pipeline(6, signals, *this) {}

  void sample(const identify::Sample& sample, std::string_view row) override {
    samples.push_back(sample);
    rows.emplace_back(row);
  }
  void sweep(const identify::Sweep& sweep) override { sweeps.push_back(sweep); }

  bool add(std::string_view payload, rsi::Timestamp time = {}, rsi::Endpoint from = kController) {
    auto datagram = from_controller(payload, time);
    datagram.source = from;
    return pipeline.telegram(datagram);
  }
  void stroke(std::uint64_t ipoc, double from_deg, double to_deg, rsi::Timestamp time = {},
              rsi::Endpoint from = kController) {
    for (const double angle : stroke_deg(from_deg, to_deg)) {
      add(telegram(ipoc, joint_1_at(angle)), time, from);
      ipoc += 4;
      time += 4ms;
    }
  }
  [[nodiscard]] std::vector<std::uint64_t> ipocs() const {
    std::vector<std::uint64_t> all;
    for (const auto& row : rows) {
      const auto begin = row.find(',') + 1;
      all.push_back(std::stoull(row.substr(begin, row.find(',', begin) - begin)));
    }
    return all;
  }

  std::vector<identify::Sample> samples;
  std::vector<std::string> rows;
  std::vector<identify::Sweep> sweeps;
  Pipeline pipeline;
};

}  // namespace

TEST_CASE("each telegram becomes a sample with its time, and a row as the controller printed it",
          "[pipeline]") {
  Watched watched;
  CHECK(watched.pipeline.csv_header() ==
        "t_s,ipoc,x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg");
  CHECK(
      watched.add(telegram(1'525'084, R"(<RIst X="1.50" Y="-2.0" Z="3" A="0.0" B="90.0" C="0.0"/>)"
                                      R"(<AIPos A1="1" A2="2" A3="3" A4="4" A5="5" A6="6.00"/>)")));
  CHECK(watched.add(telegram(1'525'088, "<DiL>0</DiL>")));
  watched.pipeline.finish();
  CHECK(watched.rows ==
        std::vector<std::string>{"0.000,1525084,1.50,-2.0,3,0.0,90.0,0.0,1,2,3,4,5,6.00",
                                 "0.004,1525088,,,,,,,,,,,,"});
  REQUIRE(watched.samples.size() == 2);
  CHECK(watched.samples[0].has_position);
  CHECK(watched.samples[1].time_s == Approx(0.004));
  CHECK_FALSE(watched.samples[1].has_position);
  CHECK(watched.pipeline.counts().cycle == 4ms);  // by the IPOC: there are no times
}

TEST_CASE("swapped telegrams are put in order and counted, duplicates are dropped and counted",
          "[pipeline]") {
  Watched watched;
  for (const auto ipoc : {100U, 108U, 104U, 112U, 112U, 104U, 124U, 120U, 116U, 128U})
    CHECK(watched.add(telegram(ipoc, "")));
  watched.pipeline.finish();
  CHECK(watched.ipocs() == std::vector<std::uint64_t>{100, 104, 108, 112, 116, 120, 124, 128});
  const auto counts = watched.pipeline.counts();
  CHECK(counts.link.telegrams == 10);
  CHECK(counts.link.reordered == 3);
  CHECK(counts.link.duplicated == 2);
  CHECK(counts.link.lost == 0);
  CHECK(counts.malformed_in_all() == 0);
}

TEST_CASE("a lost telegram is counted and leaves a gap in time", "[pipeline]") {
  Watched watched;
  for (const auto ipoc : {100U, 104U, 112U, 116U}) watched.add(telegram(ipoc, ""));
  watched.pipeline.finish();
  CHECK(watched.pipeline.counts().link.lost == 1);
  REQUIRE(watched.samples.size() == 4);
  CHECK(watched.samples[2].time_s == Approx(0.012));
}

TEST_CASE("a telegram that is overtaken by very many comes late, but spoils no stroke",
          "[pipeline]") {
  Watched straight;
  straight.stroke(4000, 0, 30);
  straight.pipeline.finish();
  REQUIRE(straight.sweeps.size() == 1);

  Watched watched;
  std::string held;
  std::uint64_t ipoc = 4000;
  std::size_t k = 0;
  for (const double angle : stroke_deg(0, 30)) {
    auto text = telegram(ipoc, joint_1_at(angle));
    if (k == 150)
      held = std::move(text);
    else
      watched.add(text);
    if (k == 200) watched.add(held);
    ipoc += 4;
    ++k;
  }
  watched.pipeline.finish();
  CHECK(watched.pipeline.counts().link.reordered == 1);
  CHECK(watched.pipeline.counts().link.lost == 0);
  CHECK(watched.samples.size() == straight.samples.size());
  REQUIRE(watched.sweeps.size() == 1);
  CHECK(watched.sweeps[0].range_rad == Approx(straight.sweeps[0].range_rad));
  CHECK(watched.sweeps[0].samples->size() == straight.sweeps[0].samples->size() - 1);
}

TEST_CASE("what is no telegram is counted by its kind and changes nothing else", "[pipeline]") {
  Watched watched;
  CHECK(watched.add(telegram(100, "")));
  const auto whole = telegram(104, joint_1_at(0));
  CHECK_FALSE(watched.add(""));
  CHECK_FALSE(watched.add(std::string(3, '\0')));
  CHECK_FALSE(watched.add("GET / HTTP/1.1\r\n"));
  CHECK_FALSE(watched.add(std::string(65'507, '\xff')));
  CHECK_FALSE(watched.add("<Sen Type=\"ImFree\"><IPOC>104</IPOC></Sen>"));
  CHECK_FALSE(watched.add(whole.substr(0, whole.size() / 2)));
  CHECK_FALSE(watched.add("<Rob Type=\"KUKA\"><DiL>0</DiL></Rob>"));
  CHECK_FALSE(watched.add("<Rob Type=\"KUKA\"><IPOC>99999999999999999999</IPOC></Rob>"));
  CHECK(watched.add(telegram(104, "")));
  watched.pipeline.finish();

  const auto counts = watched.pipeline.counts();
  const auto of = [&](rsi::Defect kind) {
    return counts.malformed[static_cast<std::size_t>(kind)];
  };
  CHECK(of(rsi::Defect::empty) == 2);
  CHECK(of(rsi::Defect::not_a_telegram) == 3);
  CHECK(of(rsi::Defect::truncated) == 1);
  CHECK(of(rsi::Defect::no_ipoc) == 2);
  CHECK(counts.malformed_in_all() == 8);
  CHECK(counts.link.telegrams == 3);  // one was a reply's text, which has an IPOC
  CHECK(counts.link.duplicated == 0);
  CHECK(counts.link.lost == 0);
  CHECK(watched.samples.size() == 2);
}

TEST_CASE("a datagram that was cut is truncated, even where the rest makes a telegram",
          "[pipeline]") {
  Watched watched;
  const auto text = telegram(100, joint_1_at(0));
  auto datagram = from_controller(text);
  datagram.cut = true;
  CHECK_FALSE(watched.pipeline.telegram(datagram));
  const auto counts = watched.pipeline.counts();
  CHECK(counts.malformed[static_cast<std::size_t>(rsi::Defect::truncated)] == 1);
  CHECK(counts.link.telegrams == 1);  // it came, and can be answered
  CHECK(watched.samples.empty());
}

TEST_CASE("values that are no numbers are counted, and the telegram still counts", "[pipeline]") {
  Watched watched;
  CHECK(watched.add(telegram(100, R"(<RIst X="nan" Y="1.0" Z="oops" A="0" B="0" C="0"/>)")));
  watched.pipeline.finish();
  CHECK(watched.pipeline.counts().unusable_values == 2);
  CHECK(watched.pipeline.counts().link.telegrams == 1);
  REQUIRE(watched.samples.size() == 1);
  CHECK_FALSE(watched.samples[0].has_position);
}

TEST_CASE("a stroke is reported once it is over", "[pipeline]") {
  Watched watched;
  watched.stroke(4000, 0, 30);
  REQUIRE(watched.sweeps.size() == 1);
  const auto& sweep = watched.sweeps[0];
  CHECK(sweep.joint == std::size_t{0});
  CHECK(sweep.direction == 1);
  // The window of +-0.1 s may cut a little off the soft ends.
  CHECK(sweep.range_rad == Approx(sweepd::radians(30)).margin(sweepd::radians(0.5)));
  CHECK(sweep.defect == identify::SweepDefect::none);
  watched.pipeline.finish();
  CHECK(watched.sweeps.size() == 1);
}

TEST_CASE("the end of the stream ends the stroke that is under way, once", "[pipeline]") {
  Watched watched;
  auto angles = stroke_deg(0, 30);
  angles.resize(250);
  std::uint64_t ipoc = 4000;
  for (const double angle : angles) watched.add(telegram(ipoc += 4, joint_1_at(angle)));
  CHECK(watched.sweeps.empty());
  watched.pipeline.finish();
  CHECK(watched.sweeps.size() == 1);
  CHECK(watched.samples.size() == 250);
  watched.pipeline.finish();
  CHECK(watched.sweeps.size() == 1);
  CHECK(watched.samples.size() == 250);
}

TEST_CASE("an RSI restart ends the stroke, and the next ones are found as well", "[pipeline]") {
  Watched watched;
  auto angles = stroke_deg(0, 30);
  angles.resize(200);
  std::uint64_t ipoc = 1'000'000;
  rsi::Timestamp time = 1h;
  for (const double angle : angles)
    watched.add(telegram(ipoc += 4, joint_1_at(angle)), time += 4ms);
  CHECK(watched.sweeps.empty());
  auto restarted = kController;
  ++restarted.port;
  watched.stroke(8, 30, 60, time + 10s, restarted);
  watched.pipeline.finish();

  CHECK(watched.pipeline.counts().link.restarts == 1);
  CHECK(watched.pipeline.counts().link.lost == 0);
  REQUIRE(watched.sweeps.size() == 2);
  CHECK(watched.sweeps[1].range_rad == Approx(sweepd::radians(30)).margin(sweepd::radians(0.5)));
  REQUIRE(watched.samples.size() == 600);
  for (std::size_t k = 1; k < watched.samples.size(); ++k)
    CHECK(watched.samples[k].time_s > watched.samples[k - 1].time_s);
  CHECK(watched.samples[200].time_s == Approx(200 * 0.004 - 0.004 + 10.0));
}

TEST_CASE("an RSI that restarts from the same IPOC after a short run is a restart, not duplicates",
          "[pipeline]") {
  Watched watched;
  watched.stroke(4000, 0, 30, 1h);
  auto restarted = kController;
  ++restarted.port;
  watched.stroke(4000, 30, 60, 1h + 5s, restarted);
  watched.pipeline.finish();
  CHECK(watched.pipeline.counts().link.duplicated == 0);
  CHECK(watched.pipeline.counts().link.restarts == 1);
  CHECK(watched.samples.size() == 800);
  CHECK(watched.sweeps.size() == 2);
}

TEST_CASE("RSI that restarts on its port from the same IPOC loses no telegram",
          "[pipeline][issue11][point_13]") {
  Watched watched;
  watched.stroke(4000, 0, 30, 1h);
  watched.stroke(4000, 30, 60, 1h + 5s);
  watched.pipeline.finish();
  CHECK(watched.pipeline.counts().link.duplicated == 0);
  CHECK(watched.pipeline.counts().link.restarts == 1);
  CHECK(watched.samples.size() == 800);
  CHECK(watched.sweeps.size() == 2);
}

TEST_CASE("one decimal, KUKA's default, is enough to find a stroke", "[pipeline]") {
  Watched watched;
  std::uint64_t ipoc = 4000;
  for (const double angle : stroke_deg(0, 30))
    watched.add(telegram(ipoc += 4, joint_1_at(angle, 1)));
  watched.pipeline.finish();
  CHECK(watched.pipeline.resolution().position_mm == Approx(0.1));
  REQUIRE(watched.sweeps.size() == 1);
  CHECK(watched.sweeps[0].joint == std::size_t{0});
  // Quantised to 0.1 deg at both ends, besides what the window cuts off.
  CHECK(watched.sweeps[0].range_rad == Approx(sweepd::radians(30)).margin(sweepd::radians(1.0)));
}

TEST_CASE("positions alone make a stroke of no joint, angles alone one without positions",
          "[pipeline]") {
  const auto elements = [](double angle, const char* wanted) {
    const auto all = joint_1_at(angle);
    const auto cut = all.find("<AIPos");
    return std::string(wanted) == "RIst" ? all.substr(0, cut) : all.substr(cut);
  };
  for (const std::string wanted : {"RIst", "AIPos"}) {
    INFO(wanted);
    Watched watched;
    std::uint64_t ipoc = 4000;
    for (const double angle : stroke_deg(0, 30))
      watched.add(telegram(ipoc += 4, elements(angle, wanted.c_str())));
    watched.pipeline.finish();
    REQUIRE(watched.sweeps.size() == 1);
    CHECK(watched.sweeps[0].joint.has_value() == (wanted == "AIPos"));
    CHECK(watched.sweeps[0].first().has_position == (wanted == "RIst"));
    CHECK(watched.sweeps[0].range_rad == Approx(sweepd::radians(30)).margin(sweepd::radians(0.5)));
  }
}

TEST_CASE("where IPOC rises by one, the time of reception tells the cycle and the robot's speed",
          "[pipeline][issue11][point_15]") {
  Watched watched;
  std::uint64_t ipoc = 1;
  rsi::Timestamp time = 1h;
  for (const double angle : stroke_deg(0, 30))
    watched.add(telegram(ipoc++, joint_1_at(angle)), time += 4ms);
  watched.pipeline.finish();
  CHECK(watched.pipeline.counts().cycle == 4ms);
  REQUIRE(watched.sweeps.size() == 1);
  CHECK(watched.samples.back().time_s == Approx(399 * 0.004));
}

TEST_CASE("the cycle is the one that telegrams keep, whatever the IPOC counts",
          "[pipeline][issue11][point_15]") {
  struct Kind {
    std::uint64_t step;
    rsi::Timestamp cycle;
    std::optional<rsi::Timestamp> expected;
  };
  for (const auto& kind : {Kind{4, 4ms, 4ms}, Kind{12, 12'001us, 12ms}, Kind{4, 40ms, 40ms},
                           Kind{1, 12ms, 12ms}, Kind{1, 0ms, {}}, Kind{12, 0ms, 12ms}}) {
    CAPTURE(kind.step, kind.cycle.count());
    Watched watched;
    CHECK_FALSE(watched.pipeline.counts().cycle);
    for (std::uint64_t k = 0; k < 100; ++k)
      // Every tenth is late, and one came after the clock was set.
      watched.add(telegram(1000 + kind.step * k, ""),
                  1h + k * kind.cycle + (k % 10 == 0 ? kind.cycle / 2 : 0ns) +
                      (k > 50 && kind.cycle > 0ms ? 1min : 0min));
    CHECK(watched.pipeline.counts().cycle == kind.expected);
  }
}

TEST_CASE("whether replies were late is not known where telegrams carry no Delay",
          "[pipeline][issue11][point_15]") {
  Watched watched;
  watched.add(telegram(1000, ""));
  CHECK_FALSE(watched.pipeline.counts().link.late_replies);
  watched.add(telegram(1004, R"(<Delay D="0"/>)"));
  CHECK(watched.pipeline.counts().link.late_replies == 0U);
  watched.add(telegram(1008, R"(<Delay D="1"/>)"));
  CHECK(watched.pipeline.counts().link.late_replies == 1U);
}

TEST_CASE("a sink may listen to nothing", "[pipeline]") {
  sweepd::StreamSink nobody;
  Pipeline pipeline(6, SignalNames{}, nobody);
  std::uint64_t ipoc = 4000;
  for (const double angle : stroke_deg(0, 30)) {
    const auto text = telegram(ipoc += 4, joint_1_at(angle));
    CHECK(pipeline.telegram(from_controller(text)));
  }
  pipeline.finish();
  CHECK(pipeline.counts().link.telegrams == 400);
}

TEST_CASE("what is no whole telegram counts in the link, and cuts no stroke", "[pipeline]") {
  Watched watched;
  std::uint64_t ipoc = 4000;
  int k = 0;
  for (const double angle : stroke_deg(0, 30)) {
    const auto text = telegram(ipoc, joint_1_at(angle));
    ++k;
    if (k == 100) {  // cut short, but answered: it came
      CHECK_FALSE(watched.add("<Rob><IPOC>" + std::to_string(ipoc) + "</IPOC>"));
    } else {
      if (k == 200) CHECK_FALSE(watched.add("<Rob><IPOC>77</IPOC>"));  // of no stream
      CHECK(watched.add(text));
    }
    ipoc += 4;
  }
  watched.pipeline.finish();
  const auto counts = watched.pipeline.counts();
  CHECK(counts.link.telegrams == 400);
  CHECK(counts.link.lost == 0);
  CHECK(counts.link.restarts == 0);
  CHECK(counts.malformed_in_all() == 2);
  CHECK(watched.sweeps.size() == 1);
}

TEST_CASE("on two threads a pipeline finds what it finds on one", "[pipeline]") {
  const auto run = [](bool two_threads) {
    auto watched = std::make_unique<Watched>();
    if (two_threads) watched->pipeline.use_two_threads();
    watched->stroke(1000, 0, 30);
    watched->stroke(5, 30, 0);  // the controller begins anew
    watched->add("no telegram");
    watched->pipeline.finish();
    return watched;
  };
  const auto one = run(false), two = run(true);
  CHECK(one->rows == two->rows);
  REQUIRE(one->sweeps.size() == 2);
  REQUIRE(two->sweeps.size() == 2);
  for (std::size_t s = 0; s < 2; ++s) {
    CHECK(one->sweeps[s].range_rad == two->sweeps[s].range_rad);
    CHECK(one->sweeps[s].samples->size() == two->sweeps[s].samples->size());
  }
  CHECK(two->pipeline.counts().malformed_in_all() == 1);
  CHECK(two->pipeline.counts().link.restarts == 1);
}

TEST_CASE("samples of an IPOC that does not count milliseconds have the time of reception",
          "[pipeline]") {
  struct Kind {
    std::uint64_t step;
    double late_s;  // at most: what the first ones got before it was known
  };
  const auto kind = GENERATE(Kind{1, 0}, Kind{2, 0.128}, Kind{10, 0.036}, Kind{400, 0},
                             Kind{4000, 0}, Kind{4, 0});
  CAPTURE(kind.step);
  Watched watched;
  for (std::uint64_t k = 0; k < 1000; ++k)
    watched.add(telegram(50'000 + kind.step * k, joint_1_at(20)), k * 4ms);
  watched.pipeline.finish();
  REQUIRE(watched.samples.size() == 1000);
  double before_s = -1;
  for (std::size_t k = 0; k < 1000; ++k) {
    CAPTURE(k);
    const double time_s = watched.samples[k].time_s;
    REQUIRE(time_s > before_s);
    REQUIRE(std::abs(time_s - 0.004 * static_cast<double>(k)) < kind.late_s + 1e-9);
    before_s = time_s;
  }
}

TEST_CASE("swapped telegrams are put in order by their IPOC, whatever it counts", "[pipeline]") {
  // Of one that counts no milliseconds, and of telegrams that come faster than it counts.
  struct Kind {
    std::uint64_t step;
    rsi::Timestamp cycle;
  };
  const auto kind = GENERATE(Kind{1, 4ms}, Kind{4, 1ms}, Kind{4, 4ms});
  const std::uint64_t step = kind.step;
  const rsi::Timestamp cycle = kind.cycle;
  CAPTURE(step, cycle.count());
  constexpr std::uint64_t kMany = 1000;
  Watched watched;
  // The counter passes over among them. They come unevenly, and every tenth after its follower.
  const std::uint64_t start = 0 - step * kMany / 2;
  const auto add = [&](std::uint64_t number, std::uint64_t place) {
    const auto uneven = place % 7 == 0 ? cycle / 2 : 0ns;
    watched.add(telegram(start + step * number, joint_1_at(20)), place * cycle + uneven);
  };
  for (std::uint64_t k = 0; k < kMany; ++k) {
    const bool first = k % 10 == 8, second = k % 10 == 9;
    add(first ? k + 1 : second ? k - 1 : k, k);
  }
  watched.pipeline.finish();
  CHECK(watched.pipeline.counts().link.reordered == kMany / 10);
  const auto found = watched.ipocs();
  REQUIRE(found.size() == kMany);
  std::uint64_t misplaced = 0, backwards = 0;
  for (std::uint64_t k = 1; k < kMany; ++k) {
    misplaced += found[k] != start + step * k ? 1U : 0U;
    backwards += watched.samples[k].time_s > watched.samples[k - 1].time_s ? 0U : 1U;
  }
  CHECK(misplaced == 0);
  CHECK(backwards == 0);
}
