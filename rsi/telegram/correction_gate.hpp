#pragma once

#include <string_view>

namespace rsi {

/// Whether a reply moves nothing: an element <Sen> in which every value, attribute or text, is
/// empty, zeros alone ("0", "00"), or "0.0", but for Sen's own Type and the digits of the IPOC. All
/// of it may stand in one <Dat TaskType="b">. Anything that cannot be read with certainty moves
/// something.
///
/// The last thing that a reply passes on its way out. It knows nothing of how replies are made, so
/// that a mistake there, or a damaged byte, cannot move a robot. Does not allocate.
[[nodiscard]] bool moves_nothing(std::string_view reply) noexcept;

}  // namespace rsi
