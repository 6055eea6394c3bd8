#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "rsi/telegram/ethernet_config.hpp"

namespace rsi {

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
