#include "daemon/settings/answers.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/text/nearest_word.hpp"
#include "rsi/ascii.hpp"
#include "rsi/datagram.hpp"
#include "rsi/telegram/reply.hpp"

namespace sweepd {
namespace {

using Elements = std::vector<rsi::EthernetConfig::Element>;

constexpr std::size_t kMostDatagramBytes = 65'507;  // of a UDP datagram over IPv4

std::string place(const rsi::EthernetConfig& config, int line) {
  return fmt::format("{}:{}: RECEIVE: ", config.name, line);
}

/// "RKorr.X, RKorr.Y"; of many the first 64 and how many more.
std::string listed(const Elements& tags) {
  constexpr std::size_t kMost = 64;
  std::string text;
  for (std::size_t i = 0; i < std::min(tags.size(), kMost); ++i)
    text += (i == 0 ? "" : ", ") + rsi::in_short(tags[i].tag);
  if (tags.size() > kMost) text += fmt::format(" and {} more", tags.size() - kMost);
  return text;
}

std::string refusal(const rsi::EthernetConfig& config, const Elements& tags) {
  return place(config, tags.front().line) + "zeros for " + listed(tags) +
         " can move the robot or switch something: use the Ethernet file that sweepd ships, which "
         "has none of these, or set ONLYSEND to TRUE; whoever has made sure that zeros do no harm "
         "names each tag in `answers_with_zeros`";
}

/// Empty unless the replies are larger than that.
std::string oversize(const rsi::EthernetConfig& config, std::size_t limit) {
  if (config.only_send || config.receive.empty()) return {};
  const auto bytes = rsi::Reply(config).with_ipoc("18446744073709551615").size();
  if (bytes <= limit) return {};
  return fmt::format("{}expected replies of at most {} bytes, found {}: ",
                     place(config, config.receive.front().line), limit, bytes);
}

/// A name of the settings that RECEIVE does not have; empty if it has them all.
std::string misspelt(const RobotSettings& robot, const rsi::EthernetConfig& config) {
  std::vector<std::string_view> tags;
  for (const auto& element : config.receive) tags.push_back(element.tag);
  for (const auto& name : robot.answers_with_zeros.names) {
    if (std::count(tags.begin(), tags.end(), name) > 0) continue;
    const auto text = fmt::format(
        "answers_with_zeros of robot {}: \"{}\" is no tag in RECEIVE of {}: ", robot.name,
        rsi::in_short(name), config.name);
    if (const auto meant = nearest_word(name, tags); !meant.empty())
      return text + "did you mean \"" + rsi::in_short(meant) + "\"?";
    return text +
           (tags.empty() ? "it has none, leave the key out" : "it has " + listed(config.receive));
  }
  return {};
}

}  // namespace

std::vector<std::string> commanding_tags(const rsi::EthernetConfig& config) {
  std::vector<std::string> tags;
  if (config.only_send) return tags;
  for (const auto& element : config.commands()) tags.push_back(element.tag);
  return tags;
}

std::vector<std::string> objections_to_answers(const RobotSettings& robot,
                                               const rsi::EthernetConfig& config) {
  std::vector<std::string> objections;
  if (auto text = misspelt(robot, config); !text.empty()) objections.push_back(std::move(text));
  if (config.only_send) return objections;
  Elements tags = config.commands();
  const auto& allowed = robot.answers_with_zeros.names;
  std::erase_if(tags, [&](const auto& element) {
    return std::count(allowed.begin(), allowed.end(), element.tag) > 0;
  });
  if (!tags.empty()) objections.push_back(refusal(config, tags));
  if (const auto text = oversize(config, kMostDatagramBytes); !text.empty())
    objections.push_back(text + "no datagram holds more, so none would arrive; take tags out");
  return objections;
}

std::vector<std::string> warnings_of_answers(const rsi::EthernetConfig& config) {
  std::vector<std::string> warnings;
  const bool tcp = config.protocol == rsi::EthernetConfig::Protocol::TCP;
  if (const auto text = oversize(config, tcp ? kMostDatagramBytes : rsi::kOneFrame); !text.empty())
    warnings.push_back(text +
                       "larger ones travel in pieces, and one lost piece loses the reply; "
                       "take tags out, or shorten their names");
  return warnings;
}

std::string warning_of_commands(const rsi::EthernetConfig& config) {
  const Elements tags = config.only_send ? Elements{} : config.commands();
  return tags.empty() ? "" : refusal(config, tags);
}

}  // namespace sweepd
