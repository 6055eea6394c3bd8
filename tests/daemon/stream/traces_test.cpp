#include "daemon/stream/traces.hpp"

#include <array>
#include <string>

#include <unistd.h>

#include "rsi/capture/capture_reader.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/telegrams.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd::test;

TEST_CASE("a pipe is no capture, as captures are read more than once", "[traces]") {
  const TemporaryFolder folder;
  Capture(folder / "a.pcap").add(telegram(1, joint_1_at(0)));
  std::array<int, 2> ends{};
  REQUIRE(pipe(ends.data()) == 0);
  close(ends[1]);  // whoever reads it comes to its end
  const std::string piped = "/dev/fd/" + std::to_string(ends[0]);
  CHECK(sweepd::traces_in_order({folder / "a.pcap"}).size() == 1);
  CHECK_THROWS_WITH(
      sweepd::traces_in_order({folder / "a.pcap", piped}),
      ContainsSubstring(piped + " is a pipe, which can be read once only: save it to a"));
  close(ends[0]);
}

TEST_CASE("a capture that is given twice, by whatever name, is refused", "[traces]") {
  const TemporaryFolder folder;
  for (const char* name : {"a.pcap", "b.pcap"})
    Capture(folder / name).add(telegram(1, joint_1_at(0)));
  std::filesystem::create_symlink(folder / "a.pcap", folder / "link.pcap");
  CHECK(sweepd::traces_in_order({folder / "a.pcap", folder / "b.pcap"}).size() == 2);
  CHECK_THROWS_WITH(
      sweepd::traces_in_order({folder / "a.pcap", folder / "b.pcap", folder / "link.pcap"}),
      ContainsSubstring("link.pcap is given twice: give each capture once"));
}
