#pragma once

#include <string>

namespace sweepd {

struct Change;

/// What `sweepd compare` says to a person; the first sentence is the verdict.
[[nodiscard]] std::string change_text(const Change& change);

}  // namespace sweepd
