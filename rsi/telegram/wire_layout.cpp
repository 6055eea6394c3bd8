#include "rsi/telegram/wire_layout.hpp"

#include <algorithm>
#include <set>
#include <unordered_map>
#include <utility>

#include "rsi/telegram/internal_tag.hpp"

namespace rsi {

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
