#include "rsi/file_bytes.hpp"

#include <cstdlib>
#include <fstream>
#include <system_error>

#include "tests/catch.hpp"

TEST_CASE("a file is read whole, or as far as it may be long", "[file_bytes]") {
  std::string folder = std::filesystem::temp_directory_path() / "sweepd-XXXXXX";
  REQUIRE(mkdtemp(folder.data()) != nullptr);
  const auto file = std::filesystem::path(folder) / "some";
  std::string all(200'000, 'a');
  all.back() = 'z';
  std::ofstream(file) << all;
  CHECK(rsi::file_bytes(file) == all);
  CHECK(rsi::file_bytes(file, all.size()) == all);
  CHECK(rsi::file_bytes(file, all.size() + 1) == all);
  // One byte more tells that there are more.
  CHECK(rsi::file_bytes(file, all.size() - 1) == all);
  CHECK(rsi::file_bytes(file, 100'000) == all.substr(0, 100'001));
  CHECK(rsi::file_bytes(file, 0) == "a");
  CHECK(rsi::file_bytes("/dev/zero", 70'000).size() == 70'001);
  std::filesystem::remove_all(folder);
  try {
    (void)rsi::file_bytes(file);
    FAIL("it is gone");
  } catch (const std::system_error& error) {
    CHECK(error.code() == std::errc::no_such_file_or_directory);
  }
  CHECK_THROWS_AS(rsi::file_bytes("/"), std::system_error);
}
