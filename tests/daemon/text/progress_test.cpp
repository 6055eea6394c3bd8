#include "daemon/text/progress.hpp"

#include <cstddef>
#include <string>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "tests/catch.hpp"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;
using sweepd::Progress;
using namespace std::chrono_literals;

namespace {

const Progress::Clock::time_point kFirstShown{1h};
const std::string kWipe = "\r\x1b[K";

/// A terminal that keeps what is written to it.
struct Screen {
  std::vector<std::string> written;

  Progress::Terminal terminal() {
    return [this](std::string_view text) { written.emplace_back(text); };
  }
};

/// Puts another file in place of stderr.
class StandardError {
 public:
  explicit StandardError(int file) : saved_(dup(STDERR_FILENO)) { dup2(file, STDERR_FILENO); }
  ~StandardError() {
    dup2(saved_, STDERR_FILENO);
    close(saved_);
  }
  StandardError(const StandardError&) = delete;
  StandardError& operator=(const StandardError&) = delete;

 private:
  int saved_;
};

}  // namespace

TEST_CASE("the line tells work, detail, share and the time left", "[progress]") {
  Screen screen;
  Progress progress("simulate", screen.terminal(), kFirstShown);
  progress.update(1, 4, "joint 3", kFirstShown + 10s);
  REQUIRE(screen.written.size() == 1);
  CHECK(screen.written[0] ==
        kWipe + "simulate  joint 3   25 %  [######..................]  30 s left");
}

TEST_CASE("without a detail or before the first step the line is shorter", "[progress]") {
  Screen screen;
  Progress progress("replay", screen.terminal(), kFirstShown);
  progress.update(0, 100, {}, kFirstShown);
  REQUIRE(screen.written.size() == 1);
  CHECK(screen.written[0] == kWipe + "replay    0 %  [........................]");
}

TEST_CASE("long times are told in minutes, and no share is beyond its ends", "[progress]") {
  Screen screen;
  Progress progress("replay", screen.terminal(), kFirstShown);
  progress.update(1, 100, {}, kFirstShown + 10s);
  progress.update(120, 100, {}, kFirstShown + 20s);
  progress.update(5, 0, {}, kFirstShown + 30s);
  REQUIRE(screen.written.size() == 3);
  CHECK_THAT(screen.written[0], EndsWith("17 min left"));
  CHECK_THAT(screen.written[1], ContainsSubstring("100 %  [########################]  0 s left"));
  CHECK_THAT(screen.written[2], ContainsSubstring("  0 %"));
}

TEST_CASE("the line is drawn at most ten times a second", "[progress]") {
  Screen screen;
  Progress progress("replay", screen.terminal(), kFirstShown);
  for (int ms = 0; ms < 1000; ++ms) progress.update(ms, 1000, {}, kFirstShown + ms * 1ms);
  CHECK(screen.written.size() == 10);
}

TEST_CASE("the line is wiped once, at the end or before", "[progress]") {
  Screen screen;
  {
    Progress progress("replay", screen.terminal(), kFirstShown);
    progress.update(1, 2, {}, kFirstShown);
    progress.clear();
    progress.clear();
    CHECK(screen.written.size() == 2);
    progress.update(1, 2, {}, kFirstShown);
    CHECK(screen.written.size() == 3);
  }
  REQUIRE(screen.written.size() == 4);
  CHECK(screen.written[1] == kWipe);
  CHECK(screen.written[3] == kWipe);
}

TEST_CASE("what was never drawn is not wiped", "[progress]") {
  Screen screen;
  { const Progress progress("replay", screen.terminal(), kFirstShown); }
  CHECK(screen.written.empty());
}

TEST_CASE("without a terminal nothing is drawn", "[progress]") {
  Progress progress("replay", Progress::Terminal{}, kFirstShown);
  // An empty function that is called throws.
  CHECK_NOTHROW(progress.update(1, 2, {}, kFirstShown));
  CHECK_NOTHROW(progress.clear());
}

TEST_CASE("stderr is drawn on if it is a terminal, and left alone if it is a pipe", "[progress]") {
  int pipe_ends[2];
  REQUIRE(pipe(pipe_ends) == 0);
  {
    const StandardError redirected(pipe_ends[1]);
    CHECK_FALSE(Progress::standard_error());
  }
  close(pipe_ends[0]);
  close(pipe_ends[1]);

  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  if (terminal < 0) {
    WARN("no pseudo terminals here");
    return;
  }
  REQUIRE(grantpt(terminal) == 0);
  REQUIRE(unlockpt(terminal) == 0);
  const int user_side = open(ptsname(terminal), O_RDWR | O_NOCTTY);
  REQUIRE(user_side >= 0);
  {
    const StandardError redirected(user_side);
    Progress progress("replay", Progress::standard_error(), kFirstShown);
    progress.update(1, 2, {}, kFirstShown);
  }
  char read_back[256];
  const auto size = read(terminal, read_back, sizeof read_back);
  REQUIRE(size > 0);
  CHECK_THAT(std::string(read_back, static_cast<std::size_t>(size)),
             StartsWith(kWipe + "replay   50 %"));
  close(user_side);
  close(terminal);
}
