#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rsi/telegram/telegram_shape.hpp"

namespace rsi {

/// One value of a telegram: an attribute (<AIPos A1="0.0"/> is AIPos, A1, 0.0) or, with an empty
/// attribute name, the text of an element (<DiL>0</DiL> is DiL, "", 0). Views.
struct Signal {
  std::string_view element;
  std::string_view attribute;
  std::string_view text;
};

/// Why a datagram is no usable telegram.
enum class Defect {
  none,
  empty,           ///< no byte but blanks and NULs
  not_a_telegram,  ///< its first element is no <Rob>: binary, foreign, or a reply
  truncated,       ///< it ends before </Rob>
  no_ipoc,         ///< whole, but without a usable IPOC
};
inline constexpr std::size_t kDefects = 5;
[[nodiscard]] std::string_view text(Defect defect) noexcept;

/// Reads one telegram of the controller, in every variant that is known: any order of elements and
/// attributes, flat, wrapped in <Dat> or pretty-printed, Type in any case, dotted tags folded into
/// one element, and names that begin with a digit (<GPIO 01="1"/>), which no XML parser accepts.
///
/// Reuse one object: it keeps its memory and stops allocating after the first telegrams. Signals
/// are views into the datagram last parsed, and their names into this object. A telegram that is
/// like the one before but for its values is compared with it, and costs less than another one. Not
/// thread-safe. Never throws for what a datagram holds.
class Telegram {
 public:
  /// Takes the place of what was parsed before. With a defect, `signals` holds what could be read.
  Defect parse(std::string_view datagram);

  /// In the order of the telegram; the root's attributes and the IPOC are not among them.
  [[nodiscard]] const std::vector<Signal>& signals() const noexcept { return signals_; }
  /// By the rule of find_ipoc(), whatever defect there is; 0 if there is none.
  [[nodiscard]] std::uint64_t ipoc() const noexcept { return ipoc_.value_or(0); }

  /// The same number as before if signals() has the same names in the same order as then.
  [[nodiscard]] std::uint64_t names() const noexcept { return names_; }
  /// Index into signals(), the first that has these names.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view element,
                                                std::string_view attribute) const noexcept;

 private:
  Defect scan(std::string_view datagram);

  TelegramShape shape_;
  std::vector<Signal> signals_;
  std::optional<std::uint64_t> ipoc_;
  std::uint64_t names_ = 0;
  std::uint64_t shape_names_ = 0;
};

/// A signal of one controller's telegrams, and where it was found. Not thread-safe.
class SignalPlace {
 public:
  explicit SignalPlace(std::string element, std::string attribute = {})
      : element_(std::move(element)), attribute_(std::move(attribute)) {}

  /// Null if the telegram has none. Names are looked at only where their order has changed.
  [[nodiscard]] const Signal* in(const Telegram& telegram) noexcept {
    if (names_ != telegram.names()) look(telegram);
    return at_ ? &telegram.signals()[*at_] : nullptr;
  }

 private:
  void look(const Telegram& telegram) noexcept;

  std::string element_;
  std::string attribute_;
  std::uint64_t names_ = 0;
  std::optional<std::size_t> at_;
};

}  // namespace rsi
