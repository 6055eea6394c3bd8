#include "daemon/plant/topics.hpp"

#include "tests/catch.hpp"

using sweepd::parse_topic;
using sweepd::RobotPlace;
using sweepd::topic_of;

TEST_CASE("names that mean something in topics are escaped, and come back", "[topics]") {
  const RobotPlace plain{"north", "hall-2", "kr5_arc.1"};
  CHECK(topic_of(plain, "result/summary") == "sweepd/1/north/hall-2/kr5_arc.1/result/summary");
  const RobotPlace odd{"a/b", "+#", "100 %\n\xc3\xbc"};
  CHECK(topic_of(odd, "state") == "sweepd/1/a%2Fb/%2B%23/100%20%25%0A%C3%BC/state");
  for (const auto& place : {plain, odd}) {
    const auto topic = parse_topic(topic_of(place, "result/summary"));
    REQUIRE(topic);
    CHECK(topic->place == place);
    CHECK(topic->kind == "result/summary");
    CHECK(sweepd::parse_robot_place(text(place)) == place);
  }
}

TEST_CASE("what is no topic of a robot is none", "[topics]") {
  for (const char* const topic :
       {"", "sweepd/1", "sweepd/1/a/b/c", "sweepd/1/a/b/c/", "sweepd/2/a/b/c/result",
        "sweepd/1//b/c/result", "sweepd/1/a/b/%2/result", "sweepd/1/a/b/%2f/result",
        "sweepd/1/a/b/%41/result", "sweepd/1/a/b/c d/result", "sweepd/1/+/b/c/result"}) {
    INFO(topic);
    CHECK_FALSE(parse_topic(topic));
  }
  const RobotPlace spaced{"north", "hall 2", "kr+5"};
  for (const char* const written : {"north/hall 2/kr+5", "north/hall%202/kr%2B5"})
    CHECK(sweepd::parse_robot_place(written) == spaced);
  CHECK_FALSE(sweepd::parse_robot_place("north/50 % full/a"));
  CHECK_FALSE(sweepd::parse_robot_place("a/b"));
  CHECK_FALSE(sweepd::parse_robot_place("a/b/c/d"));
}
