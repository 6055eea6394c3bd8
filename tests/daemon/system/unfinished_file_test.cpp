#include "daemon/system/unfinished_file.hpp"

#include <csignal>
#include <optional>

#include <sys/wait.h>
#include <unistd.h>

#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using sweepd::UnfinishedFile;
using sweepd::test::TemporaryFolder;

namespace {

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

TEST_CASE("a signal ends the program without its unfinished files", "[unfinished_file]") {
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

TEST_CASE("a signal that is ignored stays ignored", "[unfinished_file]") {
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
