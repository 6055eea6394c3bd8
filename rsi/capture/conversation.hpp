#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rsi/datagram.hpp"

namespace rsi {

enum class Direction { from_controller, to_controller, other };

/// One controller that talks to one sweepd (or RSIMonitor, or any other RSI server). The port that
/// the controller sends from is no part of it: that changes when RSI restarts. Whether a datagram
/// belongs to it is a matter of the addresses alone, so malformed ones do too.
struct Conversation {
  std::uint32_t controller = 0;  ///< address, in host byte order
  Endpoint sweepd;

  [[nodiscard]] Direction direction(const Datagram& datagram) const noexcept;

  friend bool operator==(const Conversation&, const Conversation&) = default;
  friend auto operator<=>(const Conversation&, const Conversation&) = default;
};

/// "192.168.1.20 with 192.168.1.10:49152".
[[nodiscard]] std::string text(const Conversation& conversation);

/// Whether a payload looks like something that a controller sends: `<Rob` near its beginning, or
/// nothing but a short IPOC, as the oldest RSI begins. Good enough to tell RSI from other traffic;
/// takes any bytes.
[[nodiscard]] bool looks_like_telegram(std::string_view payload) noexcept;

/// So many telegrams of one conversation are RSI, and no chance.
inline constexpr int kSurelyRsi = 3;

/// What the user says about the conversation that is wanted; what is not set may be anything.
struct ConversationFilter {
  std::optional<std::uint16_t> port = {};        ///< of sweepd
  std::optional<std::uint32_t> controller = {};  ///< its address

  [[nodiscard]] bool admits(const Conversation& conversation) const noexcept;
};

struct ConversationSearch {
  struct Found {
    Conversation conversation;
    std::uint64_t telegrams = 0;  ///< up to where the search ended
    bool admitted = true;         ///< by the filter
  };

  std::optional<Conversation> chosen;  ///< the busiest of the admitted; of equals, the first seen
  std::vector<Found> found;            ///< all, in the order of their first telegrams
  std::string note;  ///< a sentence, if there was none or a choice was made: what, what to do
};

/// Looks for RSI in captures that belong together, given in their order. Ends as soon as
/// `telegram_limit` telegrams of one admitted conversation were seen, so that large captures are
/// not read twice; `found` may then lack what begins later. Throws CaptureError like CaptureReader.
[[nodiscard]] ConversationSearch find_conversation(std::span<const std::filesystem::path> captures,
                                                   const ConversationFilter& filter = {},
                                                   std::uint64_t telegram_limit = 20'000);

}  // namespace rsi
