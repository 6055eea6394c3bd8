#pragma once

#include <string>

namespace sweepd {

struct Change;

/// Schema sweepd.compare/1, as docs/compare.schema.json has it.
[[nodiscard]] std::string change_json(const Change& change);

}  // namespace sweepd
