#pragma once

#include <vector>

#include "rsi/link/link_verdict.hpp"

namespace rsi {

/// What is good to know of a link, whatever its verdict is: what was not seen of it, how few
/// telegrams there were, that RSI or the clock began anew. All of Grade::good.
[[nodiscard]] std::vector<Reason> remarks_on(const LinkReport& report);

}  // namespace rsi
