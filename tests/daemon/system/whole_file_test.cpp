#include "daemon/system/whole_file.hpp"

#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::EndsWith;
using sweepd::whole_file;
using sweepd::test::TemporaryFolder;

TEST_CASE("a file is read whole, or the reason is said with its path", "[whole_file]") {
  const TemporaryFolder folder;
  const std::string bytes(300'000, '\0');
  CHECK(whole_file(folder.write("file", bytes)) == bytes);
  CHECK(whole_file(folder.write("empty", "")).empty());
  CHECK_THROWS_WITH(whole_file(folder / "none"),
                    EndsWith("/none: cannot be read: No such file or directory: check the path and "
                             "the permissions"));
  CHECK_THROWS_WITH(whole_file(folder.path()),
                    EndsWith(": cannot be read: Is a directory: check the path and the "
                             "permissions"));
}
