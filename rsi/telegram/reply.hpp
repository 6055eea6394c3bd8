#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rsi/telegram/ethernet_config.hpp"

namespace rsi {

/// How a telegram and its reply are built.
enum class Form : std::uint8_t {
  flat,
  wrapped,  ///< all in <Dat TaskType="b">, as from the oldest RSI on KR C2
};
/// Told by the first bytes of a telegram, whatever the rest is. For the reply thread.
[[nodiscard]] Form form_of(std::string_view telegram) noexcept;

/// The answer to a telegram: a zero for every tag of the RECEIVE list in its order (nothing for
/// strings), and the telegram's IPOC. There is no way to put another value in: sweepd never moves
/// the robot.
class Reply {
 public:
  explicit Reply(const EthernetConfig& config);
  /// For a controller whose Ethernet file is not at hand: carries the IPOC alone.
  explicit Reply(std::string_view sentype);

  /// The reply with these digits, which are echoed as they are; empty if there are none or more
  /// than 20. Valid until the next call. Does not allocate.
  [[nodiscard]] std::string_view with_ipoc(std::string_view ipoc_digits,
                                           Form form = Form::flat) noexcept;

 private:
  Reply(std::string_view sentype, const std::vector<EthernetConfig::Element>& receive);

  struct Template {
    std::string buffer;  // what comes before the IPOC, then room for the rest
    std::size_t ipoc_at = 0;
    std::string_view end;
  };
  std::array<Template, 2> templates_;  // by Form
};

/// What a controller makes of the text of a reply.
struct ReplyContent {
  std::string malformed;  ///< why it cannot be read; the rest is then unset
  std::string sen_type;   ///< Type of <Sen>, as it is written
  bool right_type = false;
  std::uint64_t ipoc = 0;
  std::string missing;   ///< the first tag of the RECEIVE list that is not there
  std::string not_zero;  ///< the first tag whose value is not zero, and the value: "AK.A1 = 0.5"
};

/// Reads replies as a controller with this Ethernet file would, names that begin with a digit
/// (<GPIO 01="0"/>) included. For any bytes whatever.
class ReplyCheck {
 public:
  explicit ReplyCheck(const EthernetConfig& config);

  [[nodiscard]] ReplyContent read(std::string_view payload) const;

 private:
  struct Wanted {
    std::string element;
    std::string attribute;
    std::string tag;
    bool is_number;
  };

  std::string sentype_;
  std::vector<Wanted> wanted_;
};

}  // namespace rsi
