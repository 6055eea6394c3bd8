#include "daemon/system/log_queue.hpp"

#include <csignal>
#include <string>

#include <fcntl.h>
#include <unistd.h>

#include "tests/catch.hpp"

using namespace std::chrono_literals;
using sweepd::LogQueue;
using sweepd::LogSink;

namespace {

/// Whose reader reads when it is told to.
class Pipe {
 public:
  Pipe() {
    REQUIRE(::pipe2(ends_, O_CLOEXEC) == 0);
    ::fcntl(ends_[0], F_SETFL, O_NONBLOCK);
  }
  ~Pipe() {
    leave();
    ::close(ends_[1]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  [[nodiscard]] int in() const { return ends_[1]; }
  void fill() {
    ::fcntl(ends_[1], F_SETFL, O_NONBLOCK);
    while (::write(ends_[1], "\n", 1) == 1) {
    }
    ::fcntl(ends_[1], F_SETFL, 0);
  }
  std::string read() {
    std::string text;
    char part[4096];
    for (ssize_t size = 0; (size = ::read(ends_[0], part, sizeof part)) > 0;)
      text.append(part, static_cast<std::size_t>(size));
    return text;
  }
  void leave() {
    if (ends_[0] >= 0) ::close(ends_[0]);
    ends_[0] = -1;
  }

 private:
  int ends_[2] = {-1, -1};
};

constexpr auto kLong = 20s;

}  // namespace

TEST_CASE("lines come out in their order, with time and importance",
          "[log_queue][issue11][point_5]") {
  Pipe pipe;
  LogQueue queue(std::make_shared<LogSink>(pipe.in()), 16);
  queue.write(spdlog::level::info, "first");
  queue.write(spdlog::level::err, "second");
  REQUIRE(queue.drain(kLong));
  const auto text = pipe.read();
  CHECK_THAT(text, Catch::Matchers::Matches("[0-9:.]{12} info first\n[0-9:.]{12} error second\n"));
  CHECK(queue.lost() == 0);
  CHECK(queue.is_read());
}

TEST_CASE("a reader that stands still keeps nobody: the oldest lines go, and are counted",
          "[log_queue][issue11][point_5]") {
  constexpr std::size_t kRoom = 8;
  Pipe pipe;
  pipe.fill();
  LogQueue queue(std::make_shared<LogSink>(pipe.in()), kRoom);
  for (int line = 0; line < 100; ++line)
    queue.write(spdlog::level::info, "line " + std::to_string(line));
  CHECK_FALSE(queue.idle());
  CHECK_FALSE(queue.drain(1ms));
  const auto lost = queue.lost();
  CHECK((lost == 100 - kRoom || lost == 100 - kRoom - 1));  // any one may be on its way

  std::string text;
  const auto deadline = std::chrono::steady_clock::now() + kLong;
  while (!queue.drain(1ms) && std::chrono::steady_clock::now() < deadline) text += pipe.read();
  text += pipe.read();
  REQUIRE(queue.idle());
  CHECK(queue.lost() == lost);
  CHECK(queue.is_read());
  for (int line = 100 - static_cast<int>(kRoom); line < 100; ++line)
    CHECK_THAT(text, Catch::Matchers::ContainsSubstring("line " + std::to_string(line) + "\n"));
  std::size_t written = 0;
  for (auto at = text.find("line "); at != text.npos; at = text.find("line ", at + 1)) ++written;
  CHECK(written == 100 - lost);
}

TEST_CASE("lines that cannot be written are lost, and counted", "[log_queue][issue11][point_5]") {
  std::signal(SIGPIPE, SIG_IGN);  // as in main()
  Pipe pipe;
  pipe.leave();
  LogQueue queue(std::make_shared<LogSink>(pipe.in()), 8);
  queue.write(spdlog::level::info, "for nobody");
  REQUIRE(queue.drain(kLong));
  CHECK(queue.lost() == 1);
  CHECK_FALSE(queue.is_read());
}
