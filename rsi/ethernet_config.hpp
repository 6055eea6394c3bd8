#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace rsi {

/// The controller's Ethernet file: what it sends, what it must receive, and where to. The file lies
/// on the controller, so what is odd but understood is a warning, not an error.
struct EthernetConfig {
  enum class Protocol { UDP, TCP };

  /// One tag of the SEND or RECEIVE list.
  struct Element {
    enum class Type { BOOL, STRING, LONG, DOUBLE };

    std::string tag;  ///< verbatim: "DEF_RIst", "Digout.o1", "DiL"
    Type type = Type::DOUBLE;
    int index = 0;  ///< channel of the ETHERNET object, 1 to 64; 0 is INTERNAL
    bool holdon = false;
    int line = 0;
  };

  std::string name;       ///< of the file, as it was given
  std::string ip_number;  ///< where the controller sends to; may be a placeholder
  std::uint16_t port = 0;
  std::string sentype;     ///< what Type of a reply must be; may be empty if `only_send`
  bool only_send = false;  ///< the controller expects no reply
  Protocol protocol = Protocol::UDP;
  bool length_first = false;  ///< PROTCOLLENGTH: the byte length comes before the XML
  std::vector<Element> send;
  std::vector<Element> receive;
  std::vector<std::string> warnings;  ///< "file:line:column: text", in the order of the file

  /// `name` is for messages. Throws EthernetConfigError.
  [[nodiscard]] static EthernetConfig parse(std::string_view xml, std::string name);
  [[nodiscard]] static EthernetConfig load(const std::filesystem::path& file);
};

/// Says file:line:column, the key, what was expected and what was found.
struct EthernetConfigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

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
