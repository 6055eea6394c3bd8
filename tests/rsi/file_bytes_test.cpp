#include "rsi/file_bytes.hpp"

#include <chrono>
#include <fstream>
#include <thread>

#include <sys/stat.h>

#include "tests/catch.hpp"
#include "tests/rsi/capture_bytes.hpp"

using Catch::Matchers::EndsWith;
using rsi::file_bytes;
using rsi::test::TemporaryFile;

TEST_CASE("a file is read whole, or the reason is said with its path", "[file_bytes]") {
  const std::string bytes(300'000, '\0');
  CHECK(file_bytes(TemporaryFile(bytes).path()) == bytes);
  CHECK(file_bytes(TemporaryFile().path()).empty());
  CHECK(rsi::readable_bytes(TemporaryFile(bytes).path()) == bytes);
  CHECK_FALSE(rsi::readable_bytes("/nowhere/none"));
  CHECK_FALSE(rsi::readable_bytes(std::filesystem::temp_directory_path()));
  CHECK_THROWS_WITH(file_bytes("/nowhere/none"),
                    EndsWith("/none: cannot be read: No such file or directory: check the path and "
                             "the permissions"));
  CHECK_THROWS_WITH(file_bytes(std::filesystem::temp_directory_path()),
                    EndsWith(": cannot be read: Is a directory: check the path and the "
                             "permissions"));
  CHECK_THROWS_AS(file_bytes<std::logic_error>("/nowhere/none"), std::logic_error);
  std::error_code why;
  CHECK(file_bytes("/nowhere/none", 10, why).empty());
  CHECK(why == std::errc::no_such_file_or_directory);
  CHECK(file_bytes("/dev/null", 10, why).empty());
  CHECK_FALSE(why);
}

TEST_CASE("of a file that is longer than it may be, one byte more tells that", "[file_bytes]") {
  std::string all(200'000, 'a');
  all.back() = 'z';
  const TemporaryFile file(all);
  CHECK(file_bytes(file.path(), all.size() + 1) == all);
  CHECK(file_bytes(file.path(), all.size()) == all);
  CHECK(file_bytes(file.path(), all.size() - 1) == all);
  CHECK(file_bytes(file.path(), 100'000) == all.substr(0, 100'001));
  CHECK(file_bytes(file.path(), 0) == "a");
  CHECK(file_bytes("/dev/zero", 70'000).size() == 70'001);
}

TEST_CASE("a pipe that nobody fills is given up, and one that is filled is read to its end",
          "[file_bytes]") {
  const TemporaryFile place;
  std::filesystem::remove(place.path());
  REQUIRE(mkfifo(place.path().c_str(), 0600) == 0);
  std::error_code why;
  CHECK(file_bytes(place.path(), 10, why, std::chrono::milliseconds(20)).empty());
  CHECK(why == std::errc::timed_out);
  std::thread writer([&] { std::ofstream(place.path()) << std::string(300'000, 'a'); });
  CHECK(file_bytes(place.path()).size() == 300'000);
  writer.join();
}
