#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace sweepd {

/// Which robot of a plant. Any text; unique together.
struct RobotPlace {
  std::string site;
  std::string cell;
  std::string robot;
  bool operator==(const RobotPlace&) const = default;
};

/// For a person, and for a log: SITE/CELL/ROBOT, each as in a topic.
[[nodiscard]] std::string text(const RobotPlace& place);
/// As a person writes it: of what a topic escapes only / and % have to be.
[[nodiscard]] std::optional<RobotPlace> parse_robot_place(std::string_view text);

/// sweepd/1/SITE/CELL/ROBOT/KIND. What is neither letter, digit nor one of - _ . ~ stands in a name
/// as % and two hexadecimal digits for each byte, as in a URL: / is %2F.
[[nodiscard]] std::string topic_of(const RobotPlace& place, std::string_view kind);

struct RobotTopic {
  RobotPlace place;
  std::string kind;  ///< "result", "result/summary", …
};
/// Nothing of what is no such topic.
[[nodiscard]] std::optional<RobotTopic> parse_topic(std::string_view topic);

/// The topic `kind` of every robot, to subscribe to.
[[nodiscard]] std::string topics_of_all(std::string_view kind);

}  // namespace sweepd
