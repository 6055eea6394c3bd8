#include "rsi/telegram/internal_tag.hpp"

namespace rsi {
namespace {

using Type = EthernetConfig::Element::Type;

constexpr std::string_view kInternal = "DEF_";

std::vector<std::string> numbered(std::string_view prefix, int count) {
  std::vector<std::string> names;
  for (int i = 1; i <= count; ++i) names.push_back(std::string(prefix) + std::to_string(i));
  return names;
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
  const auto measured = [](std::vector<std::string> attributes) {
    return InternalTag{Type::DOUBLE, std::move(attributes), true};
  };
  if (name == "RIst" || name == "RSol") return measured({"X", "Y", "Z", "A", "B", "C"});
  if (name == "AIPos" || name == "ASPos" || name == "MACur") return measured(numbered("A", 6));
  if (name == "EIPos" || name == "ESPos" || name == "MECur") return measured(numbered("E", 6));
  if (name == "Delay") return InternalTag{Type::LONG, {"D"}, true};
  if (name == "EStr") return InternalTag{Type::STRING, {}, false};
  if (name.size() == 7 && name.starts_with("Tech.") && (name[5] == 'C' || name[5] == 'T') &&
      name[6] >= '1' && name[6] <= '6')
    return InternalTag{Type::DOUBLE, numbered(name.substr(5), 10), false};
  return std::nullopt;
}

}  // namespace rsi
