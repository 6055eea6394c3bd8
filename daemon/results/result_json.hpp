#pragma once

#include <string>

#include "daemon/results/outcome.hpp"

namespace sweepd {

/// The text of result.json, schema sweepd.result/1. The same outcome gives the same bytes.
///
/// A number that the data do not determine is null; one that is set by convention stands in
/// "by_convention" of its row and has a difference of null: it was not identified. One that came
/// out infinite or as no number is null too, and "not_finite" holds its place as a JSON pointer.
[[nodiscard]] std::string result_json(const Outcome& outcome);

}  // namespace sweepd
