#pragma once

#include <nlohmann/json.hpp>

#include "daemon/results/result_formats.hpp"
#include "tests/daemon/outcomes.hpp"

namespace sweepd::test {

/// The result of a KR 5 arc of which everything is known.
inline nlohmann::ordered_json whole_result(const char* describes = "arm") {
  auto outcome = complete_outcome();
  outcome.positive = identify::test::kr5_arc().positive;
  auto json = nlohmann::ordered_json::parse(result_json(outcome));
  json["describes"] = describes;
  return json;
}

}  // namespace sweepd::test
