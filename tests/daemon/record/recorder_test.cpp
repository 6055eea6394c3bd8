#include "daemon/record/recorder.hpp"

#include <algorithm>
#include <atomic>
#include <future>
#include <sstream>

#include <sys/resource.h>

#include "rsi/capture/capture_reader.hpp"
#include "rsi/capture/packet.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/small_disk.hpp"
#include "tests/daemon/telegrams.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/eventually.hpp"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::EndsWith;
using sweepd::DiskRoom;
using sweepd::Importance;
using sweepd::RecordCount;
using sweepd::Recorder;
using sweepd::Recording;
using namespace sweepd::test;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

namespace {

using Steady = std::chrono::steady_clock;
constexpr std::uint64_t kMebibyte = 1 << 20;

/// What the recorder said.
class Said {
 public:
  void add(Importance importance, const std::string& text) {
    const std::lock_guard lock(mutex_);
    lines_.push_back(std::string(importance == Importance::error ? "E " : "  ") + text);
  }
  [[nodiscard]] std::vector<std::string> lines() const {
    const std::lock_guard lock(mutex_);
    return lines_;
  }
  [[nodiscard]] std::string all() const {
    std::string text;
    for (const auto& line : lines()) text += line + '\n';
    return text;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
};

/// A recorder on a disk and a clock that the test holds.
class RecorderBench {
 public:
  explicit RecorderBench(const std::function<void(sweepd::RecordingSettings&)>& change = {})
      : threads(own_threads) {
    set_up(change);
  }
  /// On a disk of this number, with threads that others use, too.
  RecorderBench(sweepd::TurnThreads& shared, sweepd::TurnThreads::Group its_disk)
      : disk(its_disk), threads(shared) {
    set_up({});
  }

 private:
  void set_up(const std::function<void(sweepd::RecordingSettings&)>& change) {
    settings.keep_free_bytes = 0;
    if (change) change(settings);
    sweepd::RecorderOptions options;
    options.period = 1ms;
    options.now = [this] { return Steady::time_point(1h + std::chrono::seconds(seconds.load())); };
    options.room = [this](const fs::path&) {
      ++room_asked;
      return DiskRoom{free, 1000 * kMebibyte};
    };
    options.disk_of = [this](const fs::path&) { return disk.load(); };
    recorder.emplace(
        threads, disk, settings,
        [this](Importance importance, const std::string& text) { log.add(importance, text); },
        options);
  }

 public:
  std::shared_ptr<const Recording> begin(const std::string& name = "20250101T000000Z",
                                         std::function<void(const fs::path&)> on_folder = {}) {
    sent = 0;
    return recorder->begin({folder / "robot", name, true, "t_s,ipoc", {}, std::move(on_folder)});
  }
  /// A datagram with its number and a row with the same. How many of the two were taken.
  int send() {
    const auto number = std::to_string(sent);
    const std::string payload = number + std::string(500 - number.size(), '.');
    ++sent;
    return (recorder->datagram(from_controller(payload, 1h + 4ms * sent)) ? 1 : 0) +
           (recorder->line(number + ",row") ? 1 : 0);
  }
  void send(int count) {
    for (int k = 0; k < count; ++k) send();
  }
  /// Whether it comes to be as time goes on. One step of time may fall between two looks at the
  /// clock in one turn of the recorder, so that the turn counts from behind it.
  bool in_time(const std::function<bool()>& condition) {
    return eventually([&] {
      seconds += 2;
      return condition();
    });
  }
  [[nodiscard]] fs::path session(const std::string& name = "20250101T000000Z") const {
    return folder / "robot" / name;
  }

  TemporaryFolder folder;
  Said log;
  std::atomic<int> seconds{0};
  std::atomic<std::uint64_t> free{900 * kMebibyte};
  std::atomic<int> room_asked{0};
  std::atomic<sweepd::TurnThreads::Group> disk{1};
  sweepd::RecordingSettings settings;
  int sent = 0;
  sweepd::TurnThreads own_threads{"recorder", 1, 1};
  sweepd::TurnThreads& threads;
  std::optional<Recorder> recorder;
};

/// The numbers in a trace; it must be in order.
std::vector<int> numbers(const fs::path& trace) {
  std::vector<int> found;
  rsi::CaptureReader reader(trace);
  while (const auto datagram = reader.next()) {
    CHECK(datagram->payload.size() == 500);
    found.push_back(std::stoi(std::string(datagram->payload.substr(0, 8))));
  }
  CHECK(reader.notes().empty());
  return found;
}

/// The numbers in samples, behind a header.
std::vector<int> rows(const fs::path& samples) {
  std::vector<int> found;
  std::istringstream text(content(samples));
  std::string line;
  REQUIRE(std::getline(text, line));
  CHECK(line == "t_s,ipoc");
  while (std::getline(text, line)) {
    REQUIRE(line.ends_with(",row"));
    found.push_back(std::stoi(line));
  }
  CHECK(content(samples).ends_with('\n'));
  return found;
}

std::vector<int> up_to(int count) {
  std::vector<int> all;
  for (int k = 0; k < count; ++k) all.push_back(k);
  return all;
}

std::vector<std::string> files(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// Holds the recorder's thread where the folder is made, as a disk that stands still would.
class StoppedDisk {
 public:
  ~StoppedDisk() { go_on(); }
  std::function<void(const fs::path&)> here() {
    return [this](const fs::path&) {
      stopped_.set_value();
      released_.get_future().wait();
    };
  }
  void wait() { stopped_.get_future().wait(); }
  void go_on() {
    if (!std::exchange(gone_on_, true)) released_.set_value();
  }

 private:
  std::promise<void> stopped_;
  std::promise<void> released_;
  bool gone_on_ = false;
};

}  // namespace

TEST_CASE("what was handed over is in the files when the recording has ended", "[recorder]") {
  RecorderBench bench;
  const auto recording = bench.begin();
  for (int k = 0; k < 1000; ++k) CHECK(bench.send() == 2);
  bench.recorder->end();
  recording->wait();
  CHECK(recording->folder() == bench.session());
  CHECK(files(bench.session()) == std::vector<std::string>{"samples.csv", "trace.pcap"});
  CHECK(numbers(bench.session() / "trace.pcap") == up_to(1000));
  CHECK(rows(bench.session() / "samples.csv") == up_to(1000));
  const auto counts = recording->counts();
  CHECK(counts.recorded == RecordCount{1000, 1000});
  CHECK(counts.complete());
  CHECK(counts.files == 2);
  CHECK(counts.bytes == fs::file_size(bench.session() / "trace.pcap") +
                            fs::file_size(bench.session() / "samples.csv"));
  CHECK(counts.pauses == 0);
  CHECK(bench.log.all().empty());
}

TEST_CASE("what was handed over is in the files soon, while the session goes on", "[recorder]") {
  RecorderBench bench;
  const auto recording = bench.begin();
  bench.send(10);
  CHECK(eventually([&] { return recording->counts().recorded == RecordCount{10, 10}; }));
  CHECK(numbers(bench.session() / "trace.pcap") == up_to(10));
  CHECK(rows(bench.session() / "samples.csv") == up_to(10));
}

// Sanitizers leave it out, whose memory is always new.
TEST_CASE("while the disk keeps up, memory for the recording is used again", "[recorder][long]") {
  const auto new_pages = [] {
    rusage use{};
    getrusage(RUSAGE_THREAD, &use);
    return use.ru_minflt;
  };
  RecorderBench bench;
  const auto recording = bench.begin();
  const auto record = [&](int rounds) {
    for (int round = 0; round < rounds; ++round) {
      bench.send(200);
      REQUIRE(eventually([&] {
        return recording->counts().recorded.datagrams == static_cast<std::uint64_t>(bench.sent);
      }));
    }
  };
  record(10);
  const auto before = new_pages();
  record(50);  // 5.7 MB, which are 1,400 pages
  CHECK(new_pages() - before < 200);
}

TEST_CASE("sessions follow each other, in the order in which they came", "[recorder]") {
  RecorderBench bench;
  std::vector<std::shared_ptr<const Recording>> recordings;
  StoppedDisk disk;
  recordings.push_back(bench.begin("20250101T000000Z", disk.here()));
  bench.send(3);
  recordings.push_back(bench.begin());  // in the same second
  bench.send(4);
  recordings.push_back(bench.begin("20250101T000001Z"));
  bench.recorder->end();
  recordings.push_back(bench.begin("20250101T000002Z"));
  bench.send(5);
  bench.recorder->end();
  bench.recorder->end();
  CHECK(bench.send() == 0);  // of no session
  disk.go_on();
  for (const auto& recording : recordings) recording->wait();
  CHECK(numbers(bench.session() / "trace.pcap") == up_to(3));
  CHECK(recordings[1]->folder() == bench.session("20250101T000000Z-2"));
  CHECK(rows(bench.session("20250101T000000Z-2") / "samples.csv") == up_to(4));
  CHECK(files(bench.session("20250101T000001Z")).empty());
  CHECK(numbers(bench.session("20250101T000002Z") / "trace.pcap") == up_to(5));
}

TEST_CASE("without a trace the samples are recorded all the same", "[recorder]") {
  RecorderBench bench;
  const auto recording =
      bench.recorder->begin({bench.folder / "robot", "20250101T000000Z", false, "t_s,ipoc", {}});
  bench.send(5);
  bench.recorder->end();
  recording->wait();
  CHECK(files(bench.session()) == std::vector<std::string>{"samples.csv"});
  CHECK(rows(bench.session() / "samples.csv") == up_to(5));
  CHECK(recording->counts().complete());
}

TEST_CASE("a payload larger than UDP can carry is recorded as far as it can be", "[recorder]") {
  RecorderBench bench;
  const auto recording = bench.begin();
  CHECK(bench.recorder->datagram(from_controller(std::string(70'000, 'x'), 1h)));
  bench.recorder->end();
  recording->wait();
  rsi::CaptureReader reader(bench.session() / "trace.pcap");
  const auto datagram = reader.next();
  REQUIRE(datagram);
  CHECK(datagram->payload == std::string(rsi::max_udp_payload, 'x'));
}

TEST_CASE("a recording goes on in new files by size, in both at the same moment", "[recorder]") {
  RecorderBench bench([](auto& settings) { settings.rotate_bytes = 200'000; });
  StoppedDisk disk;  // so that all is written at once, in the same portions each time
  const auto recording = bench.begin("20250101T000000Z", disk.here());
  disk.wait();
  bench.send(1500);  // 544 bytes each in the trace
  disk.go_on();
  bench.recorder->end();
  recording->wait();
  CHECK(files(bench.session()) == std::vector<std::string>{"samples-0002.csv", "samples-0003.csv",
                                                           "samples-0004.csv", "samples-0005.csv",
                                                           "samples.csv", "trace-0002.pcap",
                                                           "trace-0003.pcap", "trace-0004.pcap",
                                                           "trace-0005.pcap", "trace.pcap"});
  std::vector<int> all;
  std::vector<int> all_rows;
  for (const std::string part : {"", "-0002", "-0003", "-0004", "-0005"}) {
    const auto trace = bench.session() / ("trace" + part + ".pcap");
    CHECK(fs::file_size(trace) <= 200'000);
    const auto found = numbers(trace);
    all.insert(all.end(), found.begin(), found.end());
    const auto beside = rows(bench.session() / ("samples" + part + ".csv"));
    all_rows.insert(all_rows.end(), beside.begin(), beside.end());
    // Files change between any two records, so also between a datagram and its row.
    CHECK(all.size() - all_rows.size() <= 1);
  }
  CHECK(all == up_to(1500));
  CHECK(all_rows == all);
  CHECK(recording->counts().recorded == RecordCount{1500, 1500});
  CHECK(recording->counts().files == 10);
}

TEST_CASE("a recording goes on in new files by age, but never in empty ones", "[recorder]") {
  RecorderBench bench([](auto& settings) { settings.rotate = 100s; });
  const auto recording = bench.begin();
  const auto written = [&](std::uint64_t count) {
    return eventually([&] { return recording->counts().recorded == RecordCount{count, count}; });
  };
  bench.send(2);
  REQUIRE(written(2));
  bench.seconds = 99;
  bench.send(1);
  REQUIRE(written(3));
  bench.seconds = 1000;
  bench.send(1);
  REQUIRE(written(4));
  bench.recorder->end();
  recording->wait();
  CHECK(files(bench.session()) == std::vector<std::string>{"samples-0002.csv", "samples.csv",
                                                           "trace-0002.pcap", "trace.pcap"});
  CHECK(numbers(bench.session() / "trace.pcap") == up_to(3));
  CHECK(numbers(bench.session() / "trace-0002.pcap") == std::vector<int>{3});
}

TEST_CASE("a disk that stands still costs nothing as long as memory suffices", "[recorder]") {
  RecorderBench bench;
  StoppedDisk disk;
  const auto recording = bench.begin("20250101T000000Z", disk.here());
  disk.wait();
  for (int k = 0; k < 5000; ++k) REQUIRE(bench.send() == 2);
  CHECK(fs::is_empty(bench.session()));
  disk.go_on();
  bench.recorder->end();
  recording->wait();
  CHECK(numbers(bench.session() / "trace.pcap") == up_to(5000));
  CHECK(rows(bench.session() / "samples.csv") == up_to(5000));
  CHECK(bench.log.all().empty());
}

TEST_CASE("beyond its memory whole records are left out, counted, and said once", "[recorder]") {
  RecorderBench bench([](auto& settings) { settings.memory_bytes = kMebibyte; });
  StoppedDisk disk;
  const auto recording = bench.begin("20250101T000000Z", disk.here());
  disk.wait();
  RecordCount taken;
  const auto send = [&] {
    const std::string payload(500, '.');
    taken.datagrams += bench.recorder->datagram(from_controller(payload, 1h)) ? 1U : 0U;
    taken.samples += bench.recorder->line("row") ? 1U : 0U;
  };
  for (int k = 0; k < 5000; ++k) send();
  // 544 and 4 bytes each, and some for the session.
  CHECK(taken.datagrams == Approx(kMebibyte / 548.0).margin(3));
  const RecordCount lost = RecordCount{5000, 5000} - taken;
  CHECK(recording->counts().memory_full == lost);
  REQUIRE(bench.log.lines().size() == 1);
  CHECK_THAT(bench.log.lines()[0], ContainsSubstring("memory for the recording is full") &&
                                       ContainsSubstring("raise memory_bytes"));

  disk.go_on();
  REQUIRE(eventually([&] { return recording->counts().recorded == taken; }));
  send();
  REQUIRE(bench.log.lines().size() == 2);
  CHECK_THAT(bench.log.lines()[1], ContainsSubstring(text(lost) + " were not recorded"));
  bench.recorder->end();
  recording->wait();
  const auto counts = recording->counts();
  CHECK(counts.recorded == taken);
  CHECK(counts.memory_full == lost);
  CHECK(counts.disk == RecordCount{});
  CHECK_FALSE(counts.complete());
  rsi::CaptureReader reader(bench.session() / "trace.pcap");
  std::uint64_t found = 0;
  while (reader.next()) ++found;
  CHECK(found == taken.datagrams);
  CHECK(reader.notes().empty());
}

TEST_CASE("a session for which memory has no room is counted, not recorded", "[recorder]") {
  RecorderBench bench([](auto& settings) { settings.memory_bytes = kMebibyte; });
  StoppedDisk disk;
  const auto first = bench.begin("20250101T000000Z", disk.here());
  disk.wait();
  while (bench.recorder->line(std::string(100, 'x'))) {
  }
  const auto second = bench.begin("20250101T000001Z");
  bench.send(7);
  bench.recorder->end();
  second->wait();
  CHECK(second->folder().empty());
  CHECK(second->counts().memory_full == RecordCount{7, 7});
  disk.go_on();
  first->wait();
  CHECK_FALSE(fs::exists(bench.session("20250101T000001Z")));
}

TEST_CASE("below the floor of free disk recording pauses, and memory bridges it", "[recorder]") {
  RecorderBench bench([](auto& settings) { settings.keep_free_bytes = 160 * kMebibyte; });
  bench.free = 160 * kMebibyte - 1;
  const auto recording = bench.begin();
  bench.send(10);
  REQUIRE(eventually([&] { return recording->counts().pauses == 1; }));
  CHECK(recording->folder() == bench.session());  // for the results
  CHECK(files(bench.session()).empty());
  // There must be a margin before it goes on: 1/8, or 1/20 of the disk.
  for (const auto free : {160 * kMebibyte, 179 * kMebibyte}) {
    bench.free = free;
    const int asked = bench.room_asked;
    REQUIRE(bench.in_time([&] { return bench.room_asked > asked; }));
    CHECK(files(bench.session()).empty());
  }
  bench.free = 180 * kMebibyte;
  REQUIRE(bench.in_time([&] { return bench.log.lines().size() == 2; }));
  bench.send(5);
  bench.recorder->end();
  recording->wait();
  CHECK(numbers(bench.session() / "trace.pcap") == up_to(15));
  CHECK(recording->counts().complete());
  CHECK(recording->counts().pauses == 1);
  const auto lines = bench.log.lines();
  CHECK_THAT(lines[0], ContainsSubstring("E recording pauses, replies go on: the disk of") &&
                           ContainsSubstring("keep_free_bytes is 167772160"));
  CHECK_THAT(lines[1], ContainsSubstring("recording goes on") &&
                           ContainsSubstring("0 datagrams and 0 samples were not recorded"));
}

TEST_CASE("what a pause left out is counted by the disk, and said when it is over", "[recorder]") {
  RecorderBench bench([](auto& settings) {
    settings.keep_free_bytes = 1;
    settings.memory_bytes = kMebibyte;
  });
  const auto recording = bench.begin();
  bench.send(10);
  REQUIRE(eventually([&] { return recording->counts().recorded.samples == 10; }));
  bench.free = 0;
  bench.seconds += 2;
  bench.send(1);
  REQUIRE(eventually([&] { return recording->counts().pauses == 1; }));
  int taken = 22;
  for (int k = 0; k < 5000; ++k) taken += bench.send();
  const auto lost = recording->counts().disk;
  CHECK(lost.datagrams > 2000);
  CHECK(static_cast<std::uint64_t>(taken) + lost.datagrams + lost.samples == 2 * 5011);
  CHECK(bench.log.lines().size() == 1);  // and nothing about memory

  bench.free = 100 * kMebibyte;
  bench.seconds += 2;
  REQUIRE(eventually([&] { return bench.log.lines().size() == 2; }));
  CHECK_THAT(bench.log.lines()[1], ContainsSubstring(text(lost) + " were not recorded meanwhile"));
  bench.send(1);
  bench.recorder->end();
  recording->wait();
  const auto counts = recording->counts();
  CHECK(counts.disk == lost);
  CHECK(counts.memory_full == RecordCount{});
  CHECK(counts.recorded == RecordCount{5012, 5012} - lost);
  const auto found = numbers(bench.session() / "trace.pcap");
  CHECK(found.size() == counts.recorded.datagrams);
  CHECK(found.back() == 5011);
}

TEST_CASE("a session that ends while recording is paused is over at once", "[recorder]") {
  RecorderBench bench([](auto& settings) { settings.keep_free_bytes = 1; });
  bench.free = 0;
  const auto first = bench.begin();
  bench.send(10);
  bench.recorder->end();
  first->wait();
  CHECK(first->counts().disk == RecordCount{10, 10});
  CHECK(files(bench.session()).empty());
  CHECK(bench.recorder->paused());  // the next one would not be recorded, either

  bench.free = 500 * kMebibyte;
  CHECK(bench.in_time([&] { return !bench.recorder->paused(); }));
  const auto second = bench.begin("20250101T000001Z");
  bench.send(20);
  bench.recorder->end();
  second->wait();
  CHECK(second->counts().complete());
  CHECK(numbers(bench.session("20250101T000001Z") / "trace.pcap") == up_to(20));
  REQUIRE(bench.log.lines().size() == 2);
  CHECK_THAT(bench.log.lines()[1], ContainsSubstring(text(RecordCount{10, 10})));
}

TEST_CASE("a disk that refuses in the middle of a record leaves whole ones, and goes on",
          "[recorder]") {
  RecorderBench bench;
  const auto recording = bench.begin();
  {
    SmallDisk disk(100'000);  // in the middle of a packet
    bench.send(400);
    REQUIRE(eventually([&] { return recording->counts().pauses == 1; }));
    // 24 bytes, and 544 a record.
    CHECK(numbers(bench.session() / "trace.pcap") == up_to((100'000 - 24) / 544));
    disk.more();
  }
  bench.seconds += 2;
  REQUIRE(eventually([&] { return bench.log.lines().size() == 2; }));
  bench.send(10);
  bench.recorder->end();
  recording->wait();
  CHECK(numbers(bench.session() / "trace.pcap") == up_to(410));
  CHECK(rows(bench.session() / "samples.csv") == up_to(410));
  CHECK(recording->counts().complete());
  CHECK_THAT(bench.log.lines()[0],
             ContainsSubstring("trace.pcap") && ContainsSubstring("File too large"));
}

TEST_CASE("a disk that has room for moments only is asked, and spoken of, less and less often",
          "[recorder]") {
  RecorderBench bench([](auto& settings) { settings.keep_free_bytes = kMebibyte; });
  const auto recording = bench.begin();
  // Each second the room that a margin needs, then none again.
  for (int second = 0; second < 240; ++second) {
    bench.free = second % 2 == 0 ? 100 * kMebibyte : 0;
    ++bench.seconds;
    const auto handled = [&, asked = bench.room_asked.load()] {
      const auto counts = recording->counts();
      return bench.room_asked > asked || counts.pauses > 0 ||
             counts.recorded.samples == static_cast<std::uint64_t>(bench.sent);
    };
    bench.send(1);
    REQUIRE(eventually(handled));
  }
  CHECK(recording->counts().pauses <= 12);
  bench.recorder->end();
  recording->wait();
  const auto counts = recording->counts();
  CHECK(counts.recorded.samples + counts.disk.samples == 240);
}

TEST_CASE("a folder that cannot be made is tried again, and said once", "[recorder]") {
  RecorderBench bench;
  const auto in_the_way = bench.folder.write("robot", "a file");
  const auto recording = bench.begin();
  bench.send(10);
  REQUIRE(eventually([&] { return recording->counts().pauses == 1; }));
  CHECK(recording->folder().empty());
  fs::remove(in_the_way);
  bench.seconds += 2;
  REQUIRE(eventually([&] { return recording->counts().recorded.samples == 10; }));
  bench.recorder->end();
  recording->wait();
  CHECK(numbers(bench.session() / "trace.pcap") == up_to(10));
  REQUIRE(bench.log.lines().size() == 2);
  CHECK_THAT(bench.log.lines()[0], ContainsSubstring("cannot make a folder in") &&
                                       ContainsSubstring("check its permissions"));
}

TEST_CASE("a session for which no folder could be made goes to the one that is given later",
          "[recorder]") {
  RecorderBench bench;
  const auto in_the_way = bench.folder.write("robot", "a file");
  REQUIRE(std::filesystem::is_regular_file(in_the_way));
  const auto recording = bench.begin();
  bench.send(10);
  REQUIRE(eventually([&] { return recording->counts().pauses == 1; }));
  const auto elsewhere = bench.folder / "elsewhere";
  bench.recorder->write_to(elsewhere);
  REQUIRE(eventually([&] { return recording->counts().recorded.samples == 10; }));
  CHECK(recording->folder() == elsewhere / "20250101T000000Z");
  bench.send(5);
  bench.recorder->end();
  recording->wait();
  CHECK(numbers(recording->folder() / "trace.pcap") == up_to(15));
  CHECK(recording->counts().complete());
}

TEST_CASE("a session that has a folder stays in it, and its full disk is told to", "[recorder]") {
  RecorderBench bench([](auto& settings) { settings.keep_free_bytes = 1; });
  const auto recording = bench.begin();
  bench.send(10);
  REQUIRE(eventually([&] { return recording->counts().recorded.samples == 10; }));
  bench.recorder->write_to(bench.folder / "robot");  // the same: nothing to say
  bench.free = 0;
  REQUIRE(bench.in_time([&] {
    bench.send(1);
    return recording->counts().pauses == 1;
  }));
  bench.recorder->write_to(bench.folder / "elsewhere");
  REQUIRE(eventually([&] { return bench.log.lines().size() == 2; }));
  CHECK_THAT(bench.log.lines()[1],
             ContainsSubstring("the session under way stays in " + bench.session().string()));
  bench.free = 500 * kMebibyte;
  const auto all = static_cast<std::uint64_t>(bench.sent);
  REQUIRE(bench.in_time([&] { return recording->counts().recorded.samples == all; }));
  CHECK(recording->folder() == bench.session());
}

TEST_CASE("a folder that is deleted while it is written is said, counted, and made anew",
          "[recorder][issue11][point_12]") {
  RecorderBench bench;
  std::atomic<int> folders = 0;
  const auto recording = bench.begin("20250101T000000Z", [&](const fs::path&) { ++folders; });
  bench.send(10);
  REQUIRE(eventually([&] { return recording->counts().recorded.samples == 10; }));
  fs::remove_all(bench.session());
  bench.send(5);
  REQUIRE(eventually([&] { return recording->counts().recorded.samples == 15; }));
  bench.recorder->end();
  recording->wait();
  CHECK(numbers(bench.session() / "trace.pcap") == std::vector<int>{10, 11, 12, 13, 14});
  const auto counts = recording->counts();
  CHECK(counts.folders_deleted == 1);
  CHECK(counts.deleted == RecordCount{10, 10});
  CHECK(counts.recorded == RecordCount{15, 15});
  CHECK_FALSE(counts.complete());
  CHECK(folders == 2);
  REQUIRE(bench.log.lines().size() == 1);
  CHECK_THAT(bench.log.all(),
             ContainsSubstring("somebody deleted or moved " + bench.session().string()) &&
                 ContainsSubstring("10 datagrams and 10 samples went with it"));
}

TEST_CASE("of a folder that takes the place of a deleted one it is told", "[recorder]") {
  RecorderBench bench;
  std::atomic<int> told = 0;
  sweepd::SessionStart start{bench.folder / "robot", "20250101T000000Z", true, "t_s,ipoc"};
  start.on_loss = [&](const fs::path& folder) {
    if (folder == bench.session()) ++told;
  };
  const auto recording = bench.recorder->begin(start);
  bench.send(10);
  REQUIRE(eventually([&] { return recording->counts().recorded.samples == 10; }));
  CHECK(told == 0);
  fs::remove_all(bench.session());
  bench.send(5);
  REQUIRE(eventually([&] { return recording->counts().recorded.samples == 15; }));
  bench.recorder->end();
  recording->wait();
  CHECK(told == 1);
}

TEST_CASE("a file that is cut while it is written is said and counted, also at the end",
          "[recorder]") {
  RecorderBench bench;
  const auto recording = bench.begin();
  bench.send(10);
  REQUIRE(eventually([&] { return recording->counts().recorded.samples == 10; }));
  fs::resize_file(bench.session() / "trace.pcap", 0);
  bench.send(5);
  REQUIRE(eventually([&] { return recording->counts().recorded.samples == 15; }));
  const auto second = recording->folder();
  CHECK(numbers(second / "trace.pcap") == std::vector<int>{10, 11, 12, 13, 14});
  CHECK(recording->counts().deleted == RecordCount{10, 10});
  fs::resize_file(second / "samples.csv", 0);
  bench.recorder->end();
  recording->wait();
  CHECK(recording->counts().deleted == RecordCount{15, 15});
  CHECK(recording->counts().recorded == RecordCount{15, 15});
  CHECK(recording->counts().folders_deleted == 2);
  REQUIRE(bench.log.lines().size() == 2);
  CHECK_THAT(bench.log.lines()[0], ContainsSubstring("cut such a file, while it was written: 10 "
                                                     "datagrams and 10 samples went with it; "));
  CHECK_THAT(bench.log.lines()[1], EndsWith("5 datagrams and 5 samples went with it"));
}

TEST_CASE("of each folder is told that its recording pauses", "[recorder]") {
  RecorderBench bench([](auto& settings) { settings.keep_free_bytes = 1; });
  bench.free = 0;
  for (const char* name : {"20250101T000000Z", "20250101T000001Z"}) {
    std::vector<fs::path> told;
    const auto recording = bench.recorder->begin(
        {bench.folder / "robot", name, true, "t_s,ipoc", {}, {}, [&](const fs::path& folder) {
           told.push_back(folder);
         }});
    bench.send(10);
    bench.recorder->end();
    recording->wait();
    CHECK(told == std::vector{bench.session(name)});
  }
}

TEST_CASE("old recordings go at the start of a session and when files change, said in one line",
          "[recorder]") {
  RecorderBench bench([](auto& settings) {
    settings.keep_bytes = 300'000;
    settings.rotate_bytes = 100'000;
  });
  fs::create_directories(bench.session("20240101T000000Z"));
  for (const char* name : {"trace.pcap", "trace-0002.pcap", "samples.csv", "dh.csv"}) {
    std::ofstream(bench.session("20240101T000000Z") / name) << std::string(200'000, 'x');
  }
  const auto recording = bench.begin();
  REQUIRE(eventually([&] { return bench.log.lines().size() == 1; }));
  CHECK(files(bench.session("20240101T000000Z")) ==
        std::vector<std::string>{"dh.csv", "trace-0002.pcap"});
  CHECK_THAT(bench.log.lines()[0], ContainsSubstring("2 files, 0.4 MB"));
  for (int k = 0; k < 10; ++k) {
    bench.send(100);
    const auto all = static_cast<std::uint64_t>(bench.sent);
    REQUIRE(eventually([&] { return recording->counts().recorded.samples == all; }));
  }
  bench.recorder->end();
  recording->wait();
  CHECK(files(bench.session("20240101T000000Z")) == std::vector<std::string>{"dh.csv"});
  CHECK_FALSE(fs::exists(bench.session() / "trace.pcap"));
  CHECK(recording->counts().recorded.samples == 1000);
}

TEST_CASE("other settings hold at once", "[recorder]") {
  RecorderBench bench;
  fs::create_directories(bench.session("20240101T000000Z"));
  const auto old = bench.session("20240101T000000Z") / "trace.pcap";
  std::ofstream(old) << std::string(1000, 'x');
  const auto recording = bench.begin();
  bench.send(10);
  REQUIRE(eventually([&] { return recording->counts().recorded.samples == 10; }));
  CHECK(fs::exists(old));
  auto settings = bench.settings;
  settings.keep_bytes = 1;
  bench.recorder->reconfigure(settings);
  CHECK(eventually([&] { return !fs::exists(old); }));
  CHECK(fs::exists(bench.session() / "trace.pcap"));
}

TEST_CASE("a stop ends the session under way, with everything on the disk", "[recorder]") {
  RecorderBench bench;
  const auto recording = bench.begin();
  bench.send(100);
  CHECK(bench.recorder->stop(Steady::now() + 20s));
  recording->wait();
  CHECK(numbers(bench.session() / "trace.pcap") == up_to(100));
  CHECK(bench.recorder->stop(Steady::now()));  // again
}

TEST_CASE("a stop gives up a disk that stands still, and says what was lost", "[recorder]") {
  RecorderBench bench;
  StoppedDisk disk;
  const auto recording = bench.begin("20250101T000000Z", disk.here());
  disk.wait();
  bench.send(100);
  CHECK_FALSE(bench.recorder->stop(Steady::now() + 5ms));
  recording->wait();  // nobody waits for it any longer
  CHECK(recording->counts().disk == RecordCount{100, 100});
  REQUIRE(bench.log.lines().size() == 1);
  CHECK_THAT(bench.log.lines()[0],
             ContainsSubstring("given up") && ContainsSubstring(text(RecordCount{100, 100})));
  disk.go_on();
  bench.recorder.reset();
  CHECK(recording->counts().disk == RecordCount{100, 100});
  CHECK(files(bench.session()).empty());
}

TEST_CASE("a disk that stands still holds up those on it, and no other disk's", "[recorder]") {
  sweepd::TurnThreads threads("recorder", 1, 1);
  RecorderBench stopped(threads, 1);
  RecorderBench same(threads, 1);
  RecorderBench other(threads, 2);
  StoppedDisk disk;
  const auto held = stopped.begin("20250101T000000Z", disk.here());
  disk.wait();
  const auto behind = same.begin();
  const auto beside = other.begin();
  for (auto* bench : {&same, &other}) {
    bench->send(100);
    bench->recorder->end();
  }
  beside->wait();
  CHECK(numbers(other.session() / "trace.pcap") == up_to(100));
  CHECK_FALSE(behind->finished());
  CHECK_FALSE(same.recorder->stop(Steady::now()));  // it is given up with the disk
  disk.go_on();
  stopped.recorder->end();
  held->wait();
}

TEST_CASE("a recorder goes to the thread of the disk on which its folder turns out to be",
          "[recorder]") {
  sweepd::TurnThreads threads("recorder", 1, 1);
  RecorderBench moved(threads, 1);
  moved.disk = 2;
  const auto first = moved.begin();
  REQUIRE(eventually([&] { return !first->folder().empty(); }));
  RecorderBench stopped(threads, 1);
  StoppedDisk disk;
  static_cast<void>(stopped.begin("20250101T000000Z", disk.here()));
  disk.wait();
  moved.send(100);
  moved.recorder->end();
  first->wait();
  CHECK(numbers(moved.session() / "trace.pcap") == up_to(100));
  CHECK(first->counts().complete());
}

TEST_CASE("a session on another disk is begun by that disk's thread, behind the one before",
          "[recorder]") {
  sweepd::TurnThreads threads("recorder", 1, 1);
  RecorderBench bench(threads, 1);
  const auto first = bench.begin();
  bench.send(10);
  bench.recorder->end();
  first->wait();
  RecorderBench stopped(threads, 1);
  StoppedDisk disk;
  static_cast<void>(stopped.begin("20250101T000000Z", disk.here()));
  disk.wait();
  bench.disk = 2;
  const auto second =
      bench.recorder->begin({bench.folder / "robot", "20250101T000001Z", true, "t_s,ipoc", 2});
  bench.sent = 0;
  bench.send(10);
  bench.recorder->end();
  // One turn of its old thread may be over already, and the move with it.
  disk.go_on();
  second->wait();
  CHECK(numbers(bench.session("20250101T000001Z") / "trace.pcap") == up_to(10));
}
