#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "identify/models/kinematic_model.hpp"

namespace sweepd {

/// The object `models` of result.json: a model by the name of its form, with `base` (where there is
/// one), `joints` and `tool`; numbers in mm and degrees, in full precision, each with its standard
/// uncertainty beside it. `by_convention` lists those that do not come from the data.
[[nodiscard]] nlohmann::ordered_json models_json(
    const std::vector<identify::KinematicModel>& models);

}  // namespace sweepd
