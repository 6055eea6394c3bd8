#include "daemon/record/recording_files.hpp"

#include "tests/catch.hpp"
#include "tests/daemon/small_disk.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::line_size;
using sweepd::RecordFile;
using sweepd::whole_records;
using namespace sweepd::test;

TEST_CASE("whole records are counted up to the first that is not whole", "[recording_files]") {
  CHECK(whole_records("", line_size).count == 0);
  CHECK(whole_records("one", line_size).count == 0);
  const auto whole = whole_records("one\n\nthr", line_size);
  CHECK(whole.count == 2);
  CHECK(whole.bytes == 5);
}

TEST_CASE("a record file has its head from the first moment, and what was appended after it",
          "[recording_files]") {
  const TemporaryFolder folder;
  RecordFile file(folder / "samples.csv", "t_s\n", line_size);
  CHECK(content(folder / "samples.csv") == "t_s\n");
  std::string records = "0.000\n0.004\n";
  file.append(records);
  CHECK(records.empty());
  file.sync();
  CHECK(content(folder / "samples.csv") == "t_s\n0.000\n0.004\n");
  CHECK(file.bytes() == 16);
  CHECK(file.records() == 2);
  CHECK_FALSE(file.doubtful());
}

TEST_CASE("a record that a full disk cut off is taken back, and written once there is room",
          "[recording_files]") {
  const TemporaryFolder folder;
  RecordFile file(folder / "samples.csv", "t_s\n", line_size);
  std::string records = "0.000\n0.004\n0.008\n";
  {
    SmallDisk disk(19);  // within the third line
    CHECK_THROWS_WITH(file.append(records),
                      ContainsSubstring("cannot write") && ContainsSubstring("samples.csv"));
  }
  CHECK(content(folder / "samples.csv") == "t_s\n0.000\n0.004\n");
  CHECK(records == "0.008\n");
  CHECK(file.records() == 2);
  CHECK_FALSE(file.doubtful());
  file.append(records);
  CHECK(content(folder / "samples.csv") == "t_s\n0.000\n0.004\n0.008\n");
  CHECK(file.bytes() == 22);
}

TEST_CASE("a record file that somebody cuts is no longer in place", "[recording_files]") {
  const TemporaryFolder folder;
  RecordFile file(folder / "samples.csv", "t_s\n", line_size);
  std::string records = "0.000\n0.004\n";
  file.append(records);
  CHECK(file.in_place());
  std::filesystem::resize_file(folder / "samples.csv", 15);
  CHECK_FALSE(file.in_place());
}

TEST_CASE("a record file that cannot be made says why, and leaves nothing", "[recording_files]") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH(RecordFile(folder / "none/samples.csv", "t_s\n", line_size),
                    ContainsSubstring("none/samples.csv") && ContainsSubstring("No such file"));
  SmallDisk disk(2);
  CHECK_THROWS(RecordFile(folder / "samples.csv", "t_s\n", line_size));
  CHECK(std::filesystem::is_empty(folder.path()));
}
