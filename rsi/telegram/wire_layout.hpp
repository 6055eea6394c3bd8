#pragma once

#include <cstddef>
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

/// An XML element of a telegram or reply, folded from one or more tags of a list.
struct WireElement {
  struct Field {
    std::string attribute;      ///< empty: the text of the element
    std::size_t tag = 0;        ///< index into the list
    std::size_t component = 0;  ///< of an internal tag: 0 for X or A1, 1 for Y or A2, ...
  };

  std::string name;
  std::vector<Field> fields;

  [[nodiscard]] bool has_text() const;
};

/// The elements that a list becomes on the wire. An internal tag expands (DEF_RIst to <RIst> with X
/// Y Z A B C), dotted tags of one element fold into its first occurrence, other tags are element
/// text. A tag that stands in the list twice counts once.
[[nodiscard]] std::vector<WireElement> wire_layout(
    const std::vector<EthernetConfig::Element>& list);

/// `text` as it may stand between quotation marks or tags.
[[nodiscard]] std::string xml_escaped(std::string_view text);

}  // namespace rsi
