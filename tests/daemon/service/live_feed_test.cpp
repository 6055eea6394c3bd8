#include "daemon/service/live_feed.hpp"

#include <algorithm>
#include <atomic>
#include <optional>
#include <thread>

#include "tests/catch.hpp"
#include "tests/daemon/telegrams.hpp"

using sweepd::LiveFeed;
using sweepd::LiveSlices;
using namespace std::chrono_literals;

namespace {

identify::Sample sample_at(double time_s) {
  identify::Sample sample;
  sample.time_s = time_s;
  sample.position_mm = {100 * time_s, 0, 5};
  sample.has_position = true;
  sample.joints = 6;
  sample.angles_rad[2] = identify::kDegree;
  return sample;
}

/// 25 samples of 4 ms make a slice.
void feed(LiveFeed& feed, const rsi::Link& link, int slices) {
  static double now_s = 0;
  for (int i = 0; i < slices; ++i) {
    for (int k = 0; k < 25; ++k) feed.sample(sample_at(now_s += 0.004));
    feed.tick(link, true, now_s);
  }
}

/// A controller's telegrams and their replies, as the feed and the link see them.
struct Exchanges {
  Exchanges() { live.begin_session("s"); }

  /// The next telegram after `pace`, and its reply after `latency`, if any.
  void next(std::optional<std::chrono::microseconds> latency,
            std::chrono::microseconds pace = 4ms) {
    ipoc += 4;
    time += pace;
    see(latency);
  }
  /// The last telegram once more, half a millisecond later.
  void copy() {
    time += 500us;
    see(std::nullopt);
    time -= 500us;
  }

  LiveSlices slices;
  LiveFeed live{slices};
  rsi::Link link;

 private:
  void see(std::optional<std::chrono::microseconds> latency) {
    const auto telegram = sweepd::test::telegram(ipoc, "");
    link.telegram({time, sweepd::test::kController, sweepd::test::kServer, telegram});
    live.telegram();
    if (!latency) return;
    const auto reply = "<Sen Type=\"x\"><IPOC>" + std::to_string(ipoc) + "</IPOC></Sen>";
    link.reply({time + *latency, sweepd::test::kServer, sweepd::test::kController, reply});
  }

  std::uint64_t ipoc = 1000;
  std::chrono::microseconds time = 1s;
};

}  // namespace

TEST_CASE("a slice has one point, and four while somebody looks", "[live_feed]") {
  LiveSlices slices;
  LiveFeed live(slices);
  const rsi::Link link;
  live.begin_session("s");
  feed(live, link, 2);
  {
    const LiveSlices::Viewer viewer(slices);
    feed(live, link, 2);
  }
  const auto news = slices.after(0, 0, 600);
  REQUIRE(news.slices.size() == 4);
  CHECK(news.slices[0].count == 1);
  CHECK(news.slices[3].count >= 3);
  CHECK(news.slices[3].joints == 6);
  CHECK(news.slices[3].points[0].angles_deg[2] == Approx(1));
  CHECK(news.slices[3].number == 4);
  CHECK(news.slices[3].session == 1);
}

TEST_CASE("a reader is never waited for, and nothing is lost by it", "[live_feed]") {
  LiveSlices slices;
  LiveFeed live(slices);
  const rsi::Link link;
  live.begin_session("s");
  std::atomic<bool> stop = false;
  std::thread reader([&] {
    while (!stop) static_cast<void>(slices.after(0, 0, 600));
  });
  feed(live, link, 2000);
  stop = true;
  reader.join();
  feed(live, link, 1);
  const auto news = slices.after(0, 0, 600);
  REQUIRE_FALSE(news.slices.empty());
  CHECK(news.slices.back().number <= 2001);
  CHECK(news.slices.size() == std::min<std::size_t>(news.slices.back().number, 600));
  for (std::size_t i = 1; i < news.slices.size(); ++i)
    CHECK(news.slices[i].number == news.slices[i - 1].number + 1);
}

TEST_CASE("a slice tells latency, jitter, late and missing replies", "[live_feed]") {
  Exchanges seen;
  for (int i = 0; i < 50; ++i) seen.next(20us);
  seen.live.tick(seen.link, true, 0.1);
  for (int i = 0; i < 5; ++i) seen.next(20us);
  seen.next(5ms, 4300us);
  seen.next(std::nullopt, 3700us);
  for (int i = 0; i < 5; ++i) seen.next(20us);
  seen.next(std::nullopt);  // its reply is on its way
  seen.live.tick(seen.link, true, 0.2);
  const auto slice = seen.slices.after(0, 0, 600).slices.back();
  CHECK(slice.cycles == 12);
  CHECK(slice.late == 1);
  CHECK(slice.superseded == 1);
  CHECK(slice.latency_us == Approx(20));
  CHECK(slice.latency_max_us == Approx(5000));
  CHECK(slice.jitter_us == Approx(300).margin(1));
}

TEST_CASE("a slice counts a cycle as the link does: superseded, unanswered, and no copy",
          "[live_feed]") {
  Exchanges seen;
  for (int i = 0; i < 50; ++i) seen.next(20us);
  for (int i = 0; i < 4; ++i) seen.next(std::nullopt);
  seen.live.tick(seen.link, true, 0.1);  // of the last two nothing is known yet
  seen.next(20us);
  seen.copy();
  for (int i = 0; i < 5; ++i) seen.next(20us);
  seen.live.tick(seen.link, true, 0.2);
  std::uint64_t cycles = 0, superseded = 0, unanswered = 0;
  for (const auto& slice : seen.slices.after(0, 0, 600).slices) {
    cycles += slice.cycles;
    CHECK(slice.jitter_us < 1);  // a copy is no cycle that came early
    superseded += slice.superseded;
    unanswered += slice.unanswered;
  }
  const auto report = seen.link.report();
  CHECK(report.replies.superseded == 1);
  CHECK(report.replies.unanswered == 3);
  CHECK(superseded == report.replies.superseded);
  CHECK(unanswered == report.replies.unanswered);
  CHECK(cycles == 60);
}

TEST_CASE("a sweep has its path, and the sweeps of a session before go", "[live_feed]") {
  LiveSlices slices;
  LiveFeed live(slices);
  const rsi::Link link;
  identify::Sweep sweep;
  std::vector<identify::Sample> samples;
  for (int i = 0; i < 500; ++i) samples.push_back(sample_at(0.004 * i));
  sweep.samples = std::make_shared<const std::vector<identify::Sample>>(samples);
  sweep.range_rad = 30 * identify::kDegree;
  live.begin_session("first");
  for (int i = 0; i < 200; ++i) {
    live.sweep(sweep, 2, false, "words");
    live.tick(link, true, 0.1 * i);
  }
  auto sweeps = slices.after(0, 0, 600).sweeps;
  CHECK(sweeps.size() == LiveSlices::kSweeps);
  CHECK(sweeps.back()->number == 200);
  CHECK(sweeps.back()->joint == 3U);
  CHECK(sweeps.back()->range == Approx(30));
  CHECK(sweeps.back()->path.size() == 32);
  CHECK(sweeps.back()->path.front()[0] == 0);
  CHECK(sweeps.back()->path.back()[0] == Approx(199.6));
  live.begin_session("second");
  live.tick(link, true, 30);
  CHECK(slices.after(0, 0, 600).sweeps.empty());
}
