#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rsi/telegram/ethernet_config.hpp"

namespace rsi {

/// What RSI means by a tag that it fills or reads by itself, without an object: "DEF_RIst".
struct InternalTag {
  EthernetConfig::Element::Type type{};
  std::vector<std::string> attributes;  ///< on the wire; none: the element's text
  bool only_sent = false;               ///< the controller measures it: it cannot be received
};

/// Whether `tag` is named as internal ones are, known or not.
[[nodiscard]] bool is_internal(std::string_view tag);

/// Nothing for a tag that is not internal, or unknown to sweepd.
[[nodiscard]] std::optional<InternalTag> internal_tag(std::string_view tag);

/// What a tag is called on the wire, where the dot parts element and attribute: without DEF_.
[[nodiscard]] std::string_view wire_name(std::string_view tag);

}  // namespace rsi
