#pragma once

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
  /// With 64 channels each way a file has some kB.
  static constexpr std::size_t kMostBytes = 1 << 20;

  [[nodiscard]] static EthernetConfig parse(std::string_view xml, std::string name);
  [[nodiscard]] static EthernetConfig load(const std::filesystem::path& file);

  /// The tags of `receive` with which a reply can move the robot or switch something, each once.
  /// Zero is a command like any other: $OV_PRO and outputs go to 0 by it, and so does an absolute
  /// correction. Only an internal string cannot.
  [[nodiscard]] std::vector<Element> commands() const;
};

/// Says file:line:column, the key, what was expected and what was found.
struct EthernetConfigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace rsi
