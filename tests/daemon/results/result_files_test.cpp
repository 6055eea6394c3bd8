#include "daemon/results/result_files.hpp"

#include <algorithm>

#include "tests/catch.hpp"
#include "tests/daemon/outcomes.hpp"
#include "tests/daemon/temporary_folder.hpp"

using namespace sweepd;
using namespace sweepd::test;
namespace fs = std::filesystem;

TEST_CASE("a file that cannot be written keeps no other from it, and is all that is left to do",
          "[result_files][issue11][point_10]") {
  const TemporaryFolder folder;
  const Outcome outcome = partial_outcome();
  const auto names = result_file_names();
  CHECK(names.front() == "result.json");
  CHECK(names.back() == "report.html");  // made of the others
  fs::create_directory(folder / "result.json.tmp");
  std::set<std::string> written;
  CHECK_THROWS_WITH(write_result(folder.path(), outcome, written),
                    Catch::Matchers::ContainsSubstring("result.json"));
  for (const char* name : {"report.txt", "dh.csv", "sweeps.csv"}) CHECK(fs::exists(folder / name));
  CHECK_FALSE(fs::exists(folder / "result.json"));
  CHECK_FALSE(fs::exists(folder / "report.html"));  // it would tell of an earlier result

  CHECK(std::ranges::count(names, "validation.json") == 1);  // so that a stranger's is refused
  fs::remove(folder / "dh.csv");
  fs::remove(folder / "result.json.tmp");
  write_result(folder.path(), outcome, written);
  CHECK(fs::exists(folder / "result.json"));
  CHECK(fs::exists(folder / "report.html"));
  CHECK_FALSE(fs::exists(folder / "dh.csv"));  // it was written before
}
