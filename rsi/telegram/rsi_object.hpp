#pragma once

#include <string_view>

namespace rsi {

/// What an object of an RSI context does beside passing signals on; what is worse comes later.
enum class RsiEffect {
  none,
  tells_program,  ///< writes a variable that the robot's program may act on
  unknown,        ///< not an object that sweepd knows
  sets_output,
  sets_speed,  ///< of the robot's program
  moves,
};

/// By an object's ObjType, in any case, and its ObjTypeID, which controllers go by: the worse of
/// what the two say. Objects as of RSI 3 to 5 (otherworld-dev/rsi-pi, docs/rsi-objects.md).
[[nodiscard]] RsiEffect rsi_effect(std::string_view type, std::string_view type_id);

/// The object that speaks to sweepd.
[[nodiscard]] bool is_ethernet(std::string_view type, std::string_view type_id);

/// In words that follow an object's name: "can move the robot".
[[nodiscard]] std::string_view text(RsiEffect effect) noexcept;

}  // namespace rsi
