#include "daemon/plant/topics.hpp"

#include <utility>

namespace sweepd {
namespace {

constexpr std::string_view kBegin = "sweepd/1/";
constexpr std::string_view kHex = "0123456789ABCDEF";
constexpr std::string_view kPlain =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.~";

std::string escaped(std::string_view name) {
  std::string text;
  for (const char c : name) {
    if (kPlain.find(c) != kPlain.npos) {
      text += c;
      continue;
    }
    const auto byte = static_cast<unsigned char>(c);
    text += '%';
    text += kHex[byte >> 4];
    text += kHex[byte & 15];
  }
  return text;
}

/// Nothing where % begins no byte, and of nothing.
std::optional<std::string> unescaped(std::string_view text) {
  std::string name;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      name += text[i];
      continue;
    }
    if (i + 2 >= text.size()) return std::nullopt;
    const auto high = kHex.find(text[i + 1]), low = kHex.find(text[i + 2]);
    if (high == kHex.npos || low == kHex.npos) return std::nullopt;
    name += static_cast<char>(high << 4 | low);
    i += 2;
  }
  if (name.empty()) return std::nullopt;
  return name;
}

/// Takes the first name off `text`, and the / behind it. `written`: only as escaped() writes it.
std::optional<std::string> take_name(std::string_view& text, bool written) {
  const auto end = text.find('/');
  const auto part = text.substr(0, end);
  auto name = unescaped(part);
  if (name && written && escaped(*name) != part) name.reset();
  text.remove_prefix(end == text.npos ? text.size() : end + 1);
  return name;
}

/// Takes three names off `text`.
std::optional<RobotPlace> take_place(std::string_view& text, bool written) {
  auto site = take_name(text, written), cell = take_name(text, written),
       robot = take_name(text, written);
  if (!site || !cell || !robot) return std::nullopt;
  return RobotPlace{std::move(*site), std::move(*cell), std::move(*robot)};
}

}  // namespace

std::string text(const RobotPlace& place) {
  return escaped(place.site) + '/' + escaped(place.cell) + '/' + escaped(place.robot);
}

std::optional<RobotPlace> parse_robot_place(std::string_view text) {
  auto place = take_place(text, false);
  if (!text.empty()) return std::nullopt;
  return place;
}

std::string topic_of(const RobotPlace& place, std::string_view kind) {
  return std::string(kBegin) + text(place) + '/' + std::string(kind);
}

std::optional<RobotTopic> parse_topic(std::string_view topic) {
  if (!topic.starts_with(kBegin)) return std::nullopt;
  topic.remove_prefix(kBegin.size());
  auto place = take_place(topic, true);
  if (!place || topic.empty()) return std::nullopt;
  return RobotTopic{std::move(*place), std::string(topic)};
}

std::string topics_of_all(std::string_view kind) {
  return std::string(kBegin) + "+/+/+/" + std::string(kind);
}

}  // namespace sweepd
