#include "daemon/system/file_hash.hpp"

#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using namespace sweepd;
using namespace sweepd::test;

TEST_CASE("a file's hash is SHA-256", "[file_hash]") {
  const TemporaryFolder folder;
  // FIPS 180-4's examples, and what is longer than a block of reading.
  CHECK(hash_of(folder.write("abc", "abc"))->sha256 ==
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(hash_of(folder.write("empty", ""))->sha256 ==
        "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  const auto million = hash_of(folder.write("a", std::string(1'000'000, 'a')));
  CHECK(million->sha256 == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  CHECK(million->bytes == 1'000'000);
}

TEST_CASE("what is no file, or is not there, has no hash", "[file_hash]") {
  const TemporaryFolder folder;
  CHECK_FALSE(hash_of(folder.path()));
  CHECK_FALSE(hash_of(folder / "missing"));
  CHECK_FALSE(hash_of("/dev/null"));  // a pipe would be read empty
  CHECK(hashes_of({folder / "missing", folder.write("abc", "abc")}).size() == 1);
}
