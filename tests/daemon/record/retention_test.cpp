#include "daemon/record/retention.hpp"

#include <set>

#include <fcntl.h>
#include <sys/stat.h>

#include "daemon/record/session_folder.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using sweepd::delete_old_recordings;
using sweepd::Deleted;
using sweepd::InUse;
using namespace sweepd::test;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

namespace {

const auto kNow = std::chrono::system_clock::from_time_t(1'735'689'600);
using NameSet = std::set<std::string>;

/// A robot's folder in which every file was written so long before now.
class Recordings {
 public:
  void add(const std::string& name, std::chrono::hours ago, std::size_t bytes = 1000) const {
    fs::create_directories((folder_ / name).parent_path());
    age(folder_.write(name, std::string(bytes, 'x')), ago);
  }
  static void age(const fs::path& file, std::chrono::hours ago) {
    const timespec time{std::chrono::system_clock::to_time_t(kNow - ago), 0};
    const timespec times[] = {time, time};
    REQUIRE(utimensat(AT_FDCWD, file.c_str(), times, AT_SYMLINK_NOFOLLOW) == 0);
  }
  [[nodiscard]] NameSet names() const {
    NameSet names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
      if (!entry.is_directory() || entry.is_symlink())
        names.insert(fs::relative(entry.path(), folder_.path()).string());
    return names;
  }
  [[nodiscard]] Deleted clean(std::chrono::days keep, std::uint64_t keep_bytes,
                              const InUse& in_use = {}) const {
    sweepd::RecordingSettings settings;
    settings.keep = keep;
    settings.keep_bytes = keep_bytes;
    return delete_old_recordings(folder_.path(), settings, kNow, in_use);
  }
  [[nodiscard]] fs::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  TemporaryFolder folder_;
};

}  // namespace

TEST_CASE("without a limit nothing is deleted, however old and large", "[retention]") {
  const Recordings recordings;
  recordings.add("20130704T120000Z/trace.pcap", 100'000h);
  CHECK(recordings.clean(std::chrono::days(0), 0).files == 0);
  CHECK(recordings.names().size() == 1);
}

TEST_CASE("recordings older than the days to keep go, results stay",
          "[retention][issue11][point_12]") {
  const Recordings recordings;
  const std::string old = "20241201T000000Z/";
  for (const char* name : {"trace.pcap", "trace-0002.pcap", "samples.csv", "samples-0002.csv",
                           "result.json", "run.json", "dh.csv", "sweeps.csv", "report.txt"})
    recordings.add(old + name, 49h);
  recordings.add("20241230T120000Z/trace.pcap", 47h);
  // As old as the younger one of the two.
  recordings.add("20241229T000000Z/trace.pcap", 49h);
  recordings.add("20241229T000000Z/samples.csv", 47h);
  const auto deleted = recordings.clean(std::chrono::days(2), 0);
  CHECK(deleted.files == 5);
  CHECK(deleted.bytes == 5000);
  CHECK(deleted.trouble.empty());
  CHECK(recordings.names() == NameSet{old + "result.json", old + "run.json", old + "dh.csv",
                                      old + "report.txt", "20241230T120000Z/trace.pcap",
                                      "20241229T000000Z/trace.pcap",
                                      "20241229T000000Z/samples.csv"});
}

TEST_CASE("the oldest recordings go until all fit, in the order in which they were made",
          "[retention]") {
  const Recordings recordings;
  // By name, not by time: a copy has a time of its own.
  recordings.add("20241201T000000Z/trace.pcap", 1h);
  recordings.add("20241201T000000Z/samples.csv", 1h);
  recordings.add("20241201T000000Z-2/trace.pcap", 5h);
  recordings.add("20241201T000000Z-10/trace.pcap", 9h);
  recordings.add("20241202T000000Z/trace.pcap", 8h);
  recordings.add("20241202T000000Z/trace-0002.pcap", 7h);
  recordings.add("20241202T000000Z/trace-10000.pcap", 6h);
  const NameSet all = recordings.names();
  CHECK(recordings.clean(std::chrono::days(0), 7000).files == 0);
  CHECK(recordings.names() == all);

  CHECK(recordings.clean(std::chrono::days(0), 6000).files == 2);
  CHECK_FALSE(recordings.names().contains("20241201T000000Z/samples.csv"));
  CHECK(recordings.clean(std::chrono::days(0), 4500).files == 1);
  CHECK_FALSE(recordings.names().contains("20241201T000000Z-2/trace.pcap"));
  CHECK(recordings.clean(std::chrono::days(0), 1000).files == 3);
  CHECK(recordings.names() == NameSet{"20241202T000000Z/trace-10000.pcap"});
}

TEST_CASE("files that are being written stay, earlier ones of the same session may go",
          "[retention]") {
  const Recordings recordings;
  const std::string session = "20241201T000000Z/";
  for (const char* name : {"trace.pcap", "trace-0002.pcap", "trace-0003.pcap", "samples.csv",
                           "samples-0002.csv", "samples-0003.csv"})
    recordings.add(session + name, 1000h);
  CHECK(recordings.clean(std::chrono::days(1), 1, {"20241201T000000Z", 3}).files == 4);
  CHECK(recordings.names() == NameSet{session + "trace-0003.pcap", session + "samples-0003.csv"});
}

TEST_CASE("what another sweepd writes stays, and others go in its place", "[retention]") {
  const Recordings recordings;
  recordings.add("20241201T000000Z/trace.pcap", 1000h);
  recordings.add("20241202T000000Z/trace.pcap", 900h);
  {
    const sweepd::FolderLock theirs(recordings / "20241201T000000Z");
    REQUIRE(theirs.held());
    CHECK(recordings.clean(std::chrono::days(0), 1500).files == 1);
    CHECK(recordings.names() == NameSet{"20241201T000000Z/trace.pcap"});
    CHECK(recordings.clean(std::chrono::days(0), 1).files == 0);
  }
  CHECK(recordings.clean(std::chrono::days(0), 1).files == 1);
}

TEST_CASE("what is not exactly named as a recording is never touched", "[retention]") {
  const Recordings recordings;
  const NameSet names{
      "trace.pcap",
      "20241201T000000Z/trace.pcapng",
      "20241201T000000Z/my-trace.pcap",
      "20241201T000000Z/trace-2.pcap",
      "20241201T000000Z/trace-0001.pcap",
      "20241201T000000Z/trace-00002.pcap",
      "20241201T000000Z/trace-000a.pcap",
      "20241201T000000Z/trace-.pcap",
      "20241201T000000Z/trace.pcap.tmp",
      "20241201T000000Z/trace_0002.pcap",
      "20241201T000000Z/trace.csv",
      "20241201T000000Z/samples.pcap",
      "20241201T000000Z/samples.csv.bak",
      "20241201T000000Z/more/trace.pcap",
      "20241201T000000Z-1/trace.pcap",
      "20241201T000000Z-02/trace.pcap",
      "20241201T000000Z-/trace.pcap",
      "20241201T000000Z-2x/trace.pcap",
      "20241201T000000Z_2/trace.pcap",
      "20241201T000000/trace.pcap",
      "20241201t000000Z/trace.pcap",
      "2024120100000000/trace.pcap",
      "x20241201T000000Z/trace.pcap",
      "keep/trace.pcap",
  };
  for (const auto& name : names) recordings.add(name, 100'000h);
  fs::create_directories(recordings / "20241202T000000Z/trace.pcap");  // a folder of that name
  CHECK(recordings.clean(std::chrono::days(1), 1).files == 0);
  CHECK(recordings.names() == names);
}

TEST_CASE("everything but results counts, and a session without a result goes with its folder",
          "[retention][issue11][point_12]") {
  const Recordings recordings;
  const std::string with_table = "20241201T000000Z/";
  const std::string without = "20241202T000000Z/";
  for (const char* name : {"trace.pcap", "samples.csv", "sweeps.csv", "link.txt", "link.json",
                           "last_cycles.csv", "result.json", "run.json", "dh.csv", "report.txt"})
    recordings.add(with_table + name, 10h);
  for (const char* name : {"trace.pcap", "samples.csv", "result.json", "run.json"})
    recordings.add(without + name, 5h);
  recordings.add("20241203T000000Z/trace.pcap", 1h);
  recordings.add("20241203T000000Z/notes.txt", 1h);
  CHECK(recordings.clean(std::chrono::days(0), 11'000).files == 0);
  CHECK(recordings.clean(std::chrono::days(0), 10'999).files == 2);
  CHECK_FALSE(recordings.names().contains(with_table + "trace.pcap"));
  CHECK(recordings.names().contains(with_table + "sweeps.csv"));
  CHECK(recordings.clean(std::chrono::days(0), 1000).files == 8);
  CHECK(recordings.names() == NameSet{with_table + "result.json", with_table + "run.json",
                                      with_table + "dh.csv", with_table + "report.txt",
                                      "20241203T000000Z/trace.pcap", "20241203T000000Z/notes.txt"});
  CHECK_FALSE(fs::exists(recordings / without));
}

TEST_CASE("a clock that jumps deletes nothing, until more was recorded after it than before",
          "[retention][issue11][point_12]") {
  const Recordings recordings;
  constexpr auto kYears = 12 * 365 * 24h;  // the clock jumped so far just now
  const auto add = [&](const std::string& name, std::chrono::hours ago) {
    recordings.add(name + "/trace.pcap", ago);
  };
  for (int day = 0; day < 5; ++day)
    add("2012120" + std::to_string(5 - day) + "T000000Z", kYears + day * 24h);
  const auto all = recordings.names();
  CHECK(recordings.clean(std::chrono::days(7), 0).files == 0);
  for (int session = 1; session <= 5; ++session) {
    add("2024123" + std::to_string(session % 2) + "T00000" + std::to_string(session) + "Z", 1h);
    CAPTURE(session);
    CHECK(recordings.clean(std::chrono::days(7), 0).files == 0);
  }
  // Age goes on within what was recorded before.
  CHECK(recordings.clean(std::chrono::days(2), 0).files == 2);
  add("20241231T000009Z", 0h);
  CHECK(recordings.clean(std::chrono::days(2), 0).files == 3);
  CHECK(recordings.names().size() == 6);
  // What the clock put into the future is not old either.
  add("20370101T000000Z", -kYears);
  CHECK(recordings.clean(std::chrono::days(2), 0).files == 0);
}

TEST_CASE("symbolic links are neither followed nor deleted", "[retention]") {
  const Recordings recordings;
  const TemporaryFolder elsewhere;
  const auto precious = elsewhere.write("trace.pcap", "precious");
  Recordings::age(precious, 100'000h);
  fs::create_directory_symlink(elsewhere.path(), recordings / "20241201T000000Z");
  fs::create_directories(recordings / "20241202T000000Z");
  fs::create_symlink(precious, recordings / "20241202T000000Z/trace.pcap");
  Recordings::age(recordings / "20241202T000000Z/trace.pcap", 100'000h);
  CHECK(recordings.clean(std::chrono::days(1), 1).files == 0);
  CHECK(content(precious) == "precious");
  CHECK(fs::is_symlink(recordings / "20241202T000000Z/trace.pcap"));
}

TEST_CASE("a folder that is not there is told, not thrown", "[retention]") {
  sweepd::RecordingSettings settings;
  settings.keep_bytes = 1;
  const auto deleted = delete_old_recordings("/nowhere/at/all", settings, kNow, {});
  CHECK(deleted.files == 0);
  CHECK_THAT(deleted.trouble, Catch::Matchers::ContainsSubstring("/nowhere/at/all"));
}
