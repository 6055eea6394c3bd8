#include "daemon/record/recording.hpp"

#include "tests/catch.hpp"

TEST_CASE("a recording tells of its pauses and of what is not in it", "[recording]") {
  sweepd::Recording::Counts counts;
  counts.recorded = {400, 398};
  CHECK(counts.gaps().empty());
  counts.pauses = 1;
  CHECK(counts.gaps() == "the recording of this session paused 1 time, and lacks nothing");
  counts.pauses = 2;
  counts.disk = {12, 6};
  counts.memory_full = {3, 1};
  CHECK(counts.gaps() ==
        "the recording of this session paused 2 times, and lacks 12 datagrams and 6 samples as the "
        "disk had no room or refused, 3 datagrams and 1 sample as the disk was too slow");
  counts = {};
  counts.files_deleted = 2;
  counts.deleted = {5, 4};
  CHECK(counts.gaps() ==
        "the recording of this session lacks 5 datagrams and 4 samples with a folder or file that "
        "somebody deleted, moved or cut, 2 files deleted as keep_bytes and keep_days say");
}
