#include "rsi/telegram/wire_layout.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <unordered_map>
#include <utility>

namespace rsi {
namespace {

using Type = EthernetConfig::Element::Type;

constexpr std::string_view kInternal = "DEF_";

/// What a tag's attributes are called.
enum class TagAttributes { none, pose, axes, external_axes, delay, parameters };

struct InternalRow {
  std::string_view name;  ///< without DEF_; of Tech.C and Tech.T, a digit follows
  Type type;
  TagAttributes names;
  bool only_sent;  ///< measured by the controller
};

constexpr auto kInternalTags = std::to_array<InternalRow>({
    {"RIst", Type::DOUBLE, TagAttributes::pose, true},
    {"RSol", Type::DOUBLE, TagAttributes::pose, true},
    {"AIPos", Type::DOUBLE, TagAttributes::axes, true},
    {"ASPos", Type::DOUBLE, TagAttributes::axes, true},
    {"MACur", Type::DOUBLE, TagAttributes::axes, true},
    {"EIPos", Type::DOUBLE, TagAttributes::external_axes, true},
    {"ESPos", Type::DOUBLE, TagAttributes::external_axes, true},
    {"MECur", Type::DOUBLE, TagAttributes::external_axes, true},
    {"Delay", Type::LONG, TagAttributes::delay, true},
    {"EStr", Type::STRING, TagAttributes::none, false},
    {"Tech.C", Type::DOUBLE, TagAttributes::parameters, false},
    {"Tech.T", Type::DOUBLE, TagAttributes::parameters, false},
});

std::vector<std::string> numbered(std::string_view prefix, int count) {
  std::vector<std::string> names;
  for (int i = 1; i <= count; ++i) names.push_back(std::string(prefix) + std::to_string(i));
  return names;
}

/// `name` is without DEF_.
std::vector<std::string> attributes_of(TagAttributes names, std::string_view name) {
  switch (names) {
    case TagAttributes::none:
      return {};
    case TagAttributes::pose:
      return {"X", "Y", "Z", "A", "B", "C"};
    case TagAttributes::axes:
      return numbered("A", 6);
    case TagAttributes::external_axes:
      return numbered("E", 6);
    case TagAttributes::delay:
      return {"D"};
    case TagAttributes::parameters:
      return numbered(name.substr(name.size() - 2), 10);  // DEF_Tech.C1: C11 to C110
  }
  return {};
}

/// The six of Tech.C and Tech.T go by one row.
std::string_view row_name(std::string_view name) {
  const bool is_numbered = name.starts_with("Tech.") && name.back() >= '1' && name.back() <= '6';
  return is_numbered ? name.substr(0, name.size() - 1) : name;
}

}  // namespace

bool is_internal(std::string_view tag) {
  return tag.starts_with(kInternal);
}

std::string_view wire_name(std::string_view tag) {
  return is_internal(tag) ? tag.substr(kInternal.size()) : tag;
}

std::optional<InternalTag> internal_tag(std::string_view tag) {
  if (!is_internal(tag)) return std::nullopt;
  const auto name = wire_name(tag);
  const auto known =
      std::find_if(kInternalTags.begin(), kInternalTags.end(),
                   [&](const InternalRow& one) { return one.name == row_name(name); });
  if (known == kInternalTags.end() ||
      (known->names == TagAttributes::parameters && known->name == name))
    return std::nullopt;
  return InternalTag{known->type, attributes_of(known->names, name), known->only_sent};
}

bool WireElement::has_text() const {
  return std::any_of(fields.begin(), fields.end(),
                     [](const Field& field) { return field.attribute.empty(); });
}

std::vector<WireElement> wire_layout(const std::vector<EthernetConfig::Element>& list) {
  std::vector<WireElement> layout;
  std::unordered_map<std::string, std::size_t> place;  // by name
  std::set<std::pair<std::size_t, std::string>> seen;  // attributes of each element
  const auto add = [&](std::string_view name, WireElement::Field field) {
    const auto [found, is_new] = place.try_emplace(std::string(name), layout.size());
    if (is_new) layout.push_back({std::string(name), {}});
    if (seen.emplace(found->second, field.attribute).second)
      layout[found->second].fields.push_back(std::move(field));
  };
  for (std::size_t tag = 0; tag < list.size(); ++tag) {
    const auto name = wire_name(list[tag].tag);
    std::vector<std::string> attributes;
    if (const auto internal = internal_tag(list[tag].tag)) attributes = internal->attributes;
    const auto dot = name.find('.');
    if (attributes.empty())
      attributes.emplace_back(dot == std::string_view::npos ? "" : name.substr(dot + 1));
    for (std::size_t i = 0; i < attributes.size(); ++i)
      add(name.substr(0, dot), {attributes[i], tag, i});
  }
  return layout;
}

std::string xml_escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else if (c == '"')
      escaped += "&quot;";
    else
      escaped += c;
  }
  return escaped;
}

}  // namespace rsi
