#pragma once

#include <vector>

#include "identify/identification.hpp"

namespace identify {

/// What the chain's fit as a whole says of how was measured: codes and texts as of `add_advice`.
/// The result has a chain.
[[nodiscard]] std::vector<Warning> advice_on_chain(const Identification& found);

/// Joints that went along while another one was swept: by more than any arm that is sound does, or
/// by less.
[[nodiscard]] std::vector<Warning> joints_along(const Identification& found, bool beyond);

}  // namespace identify
