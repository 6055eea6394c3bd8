#include "daemon/system/line_file.hpp"

#include "tests/catch.hpp"
#include "tests/daemon/small_disk.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::LineFile;
using sweepd::test::content;
using sweepd::test::SmallDisk;
using sweepd::test::TemporaryFolder;

TEST_CASE("lines come out as they went in, after a flush and at the end", "[line_file]") {
  const TemporaryFolder folder;
  {
    LineFile file(folder / "samples.csv");
    file.append("t_s,ipoc");
    file.append("");
    file.flush();
    CHECK(content(folder / "samples.csv") == "t_s,ipoc\n\n");
    file.append("0.000,4");
    CHECK(file.error().empty());
  }
  CHECK(content(folder / "samples.csv") == "t_s,ipoc\n\n0.000,4\n");
}

TEST_CASE("a file of an earlier run is emptied", "[line_file]") {
  const TemporaryFolder folder;
  const auto path = folder.write("samples.csv", "old\n");
  LineFile file(path);
  CHECK(content(path).empty());
}

TEST_CASE("more than the buffer holds is written without a flush", "[line_file]") {
  const TemporaryFolder folder;
  LineFile file(folder / "samples.csv");
  const std::string line(999, 'x');
  for (int k = 0; k < 2000; ++k) file.append(line);
  CHECK(std::filesystem::file_size(folder / "samples.csv") > 1'000'000);
  file.flush();
  CHECK(std::filesystem::file_size(folder / "samples.csv") == 2'000'000);
}

TEST_CASE("a disk that refuses bytes never throws, and the first error is kept", "[line_file]") {
  LineFile file("/dev/full");
  file.append("a line");
  CHECK(file.error().empty());
  file.flush();
  CHECK_THAT(file.error(),
             ContainsSubstring("cannot write /dev/full") && ContainsSubstring("No space left"));
  const auto first = file.error();
  for (int k = 0; k < 2000; ++k) file.append(std::string(999, 'x'));
  file.flush();
  CHECK(file.error() == first);
}

TEST_CASE("a disk that was full for a while leaves whole lines only", "[line_file]") {
  const TemporaryFolder folder;
  LineFile file(folder / "samples.csv");
  {
    SmallDisk disk(1005);  // ends within a line
    for (int k = 100; k < 300; ++k) file.append("line " + std::to_string(k));
    file.flush();
    REQUIRE_FALSE(file.error().empty());
    disk.more();
  }
  file.append("line 300");
  file.flush();

  std::ifstream stream(folder / "samples.csv");
  int before = 99;
  for (std::string line; std::getline(stream, line);) {
    INFO(line);
    REQUIRE(line.size() == 8);
    REQUIRE(line.starts_with("line "));
    const int number = std::stoi(line.substr(5));
    CHECK(number > before);
    before = number;
  }
  CHECK(before == 300);
}

TEST_CASE("a line file that cannot be created says why", "[line_file]") {
  const TemporaryFolder folder;
  const auto file = folder.write("file", "");
  CHECK_THROWS_WITH(
      LineFile(file / "samples.csv"),
      ContainsSubstring((file / "samples.csv").string()) && ContainsSubstring("Not a directory"));
}
