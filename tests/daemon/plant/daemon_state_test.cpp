#include "daemon/plant/daemon_state.hpp"

#include "tests/catch.hpp"

using sweepd::parse_daemon_state;

TEST_CASE("each robot's state is that of the page, with this robot alone", "[daemon_state]") {
  const auto state = parse_daemon_state(
      R"({"schema": "sweepd.state/1", "started": "s", "phase": "serving",
          "robots": [{"robot": "a", "sessions": 1}, {"robot": "b", "sessions": 2}]})",
      "now");
  CHECK(state.trouble.empty());
  REQUIRE(state.robots.size() == 2);
  CHECK(state.robots.at("b").dump() ==
        R"({"schema":"sweepd.state/1","at":"now","started":"s","phase":"serving",)"
        R"("robots":[{"robot":"b","sessions":2}]})");
}

TEST_CASE("an answer of something else is told as text, and short", "[daemon_state]") {
  const auto trouble = [](const std::string& answer) {
    return sweepd::parse_daemon_answer(answer, "here", "now").trouble;
  };
  CHECK(trouble("SSH-2.0\xff\x1b[31m\r\n\r\n") == "what answers on here is no sweepd");
  CHECK(trouble("HTTP/1.1 404 a\xff\x1b[31m\r\n\r\n") ==
        "here answers: HTTP/1.1 404 a\xEF\xBF\xBD [31m");
  CHECK(trouble("HTTP/1.1 404 " + std::string(1000, 'a') + "\r\n\r\n").size() < 100);
  CHECK(trouble("HTTP/1.1 200 OK\r\n\r\n[]") == "what answers is no sweepd");
}

TEST_CASE("who is no sweepd, or is not there, is told as such", "[daemon_state]") {
  CHECK(parse_daemon_state("<html>", "").trouble == "what answers is no sweepd");
  CHECK(parse_daemon_state("[]", "").trouble == "what answers is no sweepd");
  CHECK_THAT(sweepd::ask_daemon({0x7f000001, 1}).trouble,
             Catch::Matchers::ContainsSubstring("does not answer on http://127.0.0.1:1/api/state"));
}
