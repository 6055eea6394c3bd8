#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "rsi/telegram/ethernet_config.hpp"
#include "rsi/telegram/rsi_object.hpp"

namespace rsi {

/// The controller's RSI context, as far as it concerns the link: its Ethernet object, and what is
/// linked to it. Both forms are read: `.rsi.xml` of RSI 3 and `.rsix` of RSI 4 and later. KR C2 has
/// none: there the program makes the objects. Shapes of the files:
/// ros-industrial/kuka_experimental, kuka_rsi_hw_interface/krl.
struct RsiContext {
  enum class Form { xml, rsix };

  /// Another object that takes what the Ethernet object received, as it is.
  struct Receiver {
    std::string type;      ///< as in the file: "AXISCORR", "AxisCorr"
    std::string id;        ///< of this object
    int channel = 0;       ///< from 1: INDX of the tag in RECEIVE
    std::string position;  ///< "file:line:column: "
  };

  /// An object that can do something, whatever feeds it.
  struct Actor {
    std::string type;
    std::string id;
    RsiEffect effect{};  ///< none of them has RsiEffect::none
    std::string path;    ///< by which signals reach it: "ETHERNET1 -> LIMIT1 -> POSCORR1"
  };

  std::string name;  ///< of the file, as it was given
  Form form = Form::xml;
  std::string config_file;       ///< the Ethernet file that the controller will look for
  std::optional<int> precision;  ///< decimals of what is sent; KUKA's default is 1
  std::optional<int> timeout;    ///< unanswered cycles before RSI stops; KUKA's default is 10
  std::vector<int> fed;          ///< channels from 1 that other objects feed: INDX of tags in SEND
  std::vector<Receiver> receivers;
  std::vector<Actor> actors;
  std::vector<std::string> warnings;  ///< "file:line:column: text"

  /// `name` is for messages. Throws RsiContextError.
  [[nodiscard]] static RsiContext parse(std::string_view xml, std::string name);
  [[nodiscard]] static RsiContext load(const std::filesystem::path& file);

  /// What does not fit between this context and the Ethernet file that sweepd was given: its name,
  /// channels that nothing feeds, channels that are taken but not received.
  [[nodiscard]] std::vector<std::string> compare(const EthernetConfig& config) const;
};

/// Says file:line:column, what was expected and what was found.
struct RsiContextError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace rsi
