#include "daemon/system/atomic_file.hpp"

#include <csignal>
#include <optional>
#include <vector>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

namespace fs = std::filesystem;
using Catch::Matchers::ContainsSubstring;
using sweepd::replace_file;
using sweepd::sync_folder;
using sweepd::UnfinishedFile;
using sweepd::write_atomically;
using sweepd::test::content;
using sweepd::test::TemporaryFolder;

namespace {

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  return names;
}

/// No file grows beyond so many bytes meanwhile: a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    old_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, old_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*old_)(int) = nullptr;
};

/// How a process ends that does this, as waitpid() tells.
template <typename Work>
int end_of(const Work& work) {
  const pid_t child = fork();
  if (child == 0) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
    work();
    _exit(0);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  return status;
}

}  // namespace

TEST_CASE("a file is there with all its bytes, and nothing beside it", "[atomic_file]") {
  const TemporaryFolder folder;
  const std::string bytes("a\0b\n", 4);
  write_atomically(folder / "result.json", bytes);
  CHECK(content(folder / "result.json") == bytes);
  write_atomically(folder / "result.json", "");
  CHECK(content(folder / "result.json").empty());
  CHECK(names_in(folder.path()) == std::vector<std::string>{"result.json"});
}

TEST_CASE("files of one folder are synced each, and their folder once", "[atomic_file]") {
  const TemporaryFolder folder;
  replace_file(folder / "dh.csv", "a");
  replace_file(folder / "dh.csv", "b");
  replace_file(folder / "report.txt", "c");
  sync_folder(folder.path());
  sync_folder(folder / "nowhere");
  CHECK(content(folder / "dh.csv") == "b");
  CHECK(content(folder / "report.txt") == "c");
  CHECK(names_in(folder.path()).size() == 2);
}

TEST_CASE("a reader that has the old file open goes on reading the old one", "[atomic_file]") {
  const TemporaryFolder folder;
  write_atomically(folder / "result.json", std::string(100'000, 'a'));
  std::ifstream reader(folder / "result.json", std::ios::binary);
  std::string half(50'000, '\0');
  reader.read(half.data(), 50'000);
  write_atomically(folder / "result.json", "b");
  std::ostringstream rest;
  rest << reader.rdbuf();
  CHECK(half + rest.str() == std::string(100'000, 'a'));
  CHECK(content(folder / "result.json") == "b");
}

TEST_CASE("a disk without room leaves the old file, and no half of the new one", "[atomic_file]") {
  const TemporaryFolder folder;
  write_atomically(folder / "result.json", "old");
  {
    const FullDisk full(1000);
    CHECK_THROWS_WITH(write_atomically(folder / "result.json", std::string(100'000, 'x')),
                      ContainsSubstring("result.json") && ContainsSubstring("free space"));
  }
  CHECK(content(folder / "result.json") == "old");
  CHECK(names_in(folder.path()) == std::vector<std::string>{"result.json"});
}

TEST_CASE("what cannot be written is said with its path and the reason", "[atomic_file]") {
  const TemporaryFolder folder;
  const auto file = folder.write("file", "");
  CHECK_THROWS_WITH(
      write_atomically(file / "result.json", "x"),
      ContainsSubstring((file / "result.json").string()) && ContainsSubstring("Not a directory"));
  CHECK_THROWS_WITH(write_atomically(folder / "missing/result.json", "x"),
                    ContainsSubstring("No such file or directory") &&
                        ContainsSubstring("make that folder first, or name another one"));
  fs::create_directory(folder / "result.json");
  CHECK_THROWS_WITH(write_atomically(folder / "result.json", "x"),
                    ContainsSubstring((folder / "result.json").string()) &&
                        ContainsSubstring("(Is a directory): name a file"));
}

TEST_CASE("a signal ends the program without its unfinished files", "[atomic_file]") {
  const int signal = GENERATE(SIGINT, SIGTERM, SIGHUP);
  const TemporaryFolder folder;
  const auto finished = folder.write("finished", "whole");
  const auto half = folder.write("half", "ha");
  const auto other_half = folder.write("other", "lf");
  const int status = end_of([&] {
    sweepd::delete_unfinished_on_signals();
    const UnfinishedFile one(half);
    static_cast<void>(std::optional<UnfinishedFile>(std::in_place, finished));
    const UnfinishedFile another(other_half);
    raise(signal);
  });
  CHECK(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == signal);
  CHECK(std::filesystem::exists(finished));
  CHECK_FALSE(std::filesystem::exists(half));
  CHECK_FALSE(std::filesystem::exists(other_half));
}

TEST_CASE("a signal that is ignored stays ignored", "[atomic_file]") {
  const TemporaryFolder folder;
  const auto half = folder.write("half", "ha");
  const int status = end_of([&] {
    std::signal(SIGHUP, SIG_IGN);  // as nohup does
    sweepd::delete_unfinished_on_signals();
    const UnfinishedFile one(half);
    raise(SIGHUP);
  });
  CHECK(WIFEXITED(status));
  CHECK(std::filesystem::exists(half));
}
