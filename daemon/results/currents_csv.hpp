#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "daemon/results/outcome.hpp"

namespace sweepd {

/// currents.csv: a line for each joint and whole degree at which it was seen moving alone.
[[nodiscard]] std::string currents_csv(const Outcome& outcome);

/// "currents" of result.json: friction of each joint that has any.
[[nodiscard]] nlohmann::ordered_json currents_json(const Outcome& outcome);

}  // namespace sweepd
