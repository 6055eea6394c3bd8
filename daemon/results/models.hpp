#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "daemon/results/outcome.hpp"
#include "identify/models/kinematic_model.hpp"

namespace sweepd {

/// The arm of an outcome in every form; empty unless its numbers are the chain's and the table is
/// complete.
[[nodiscard]] std::vector<identify::KinematicModel> models_of(const Outcome& outcome);

/// A number as files have it: mm, degrees, or as it is; never -0.
[[nodiscard]] double in_file_units(double value, identify::Quantity quantity);

/// models.csv: a row a number, in full precision: a reader's forward kinematics is the chain's to
/// 1e-9 m. Joint 0 is the base, the one after the last the tool. `sigma` and the limits of the 95 %
/// interval are empty where the number comes from no data, its uncertainty is not known, or is zero
/// to first order.
[[nodiscard]] std::string models_csv(const std::vector<identify::KinematicModel>& models);

/// The object `models` of result.json: a model by the name of its form, with `base` (where there is
/// one), `joints` and `tool`; numbers in mm and degrees, in full precision, each with its standard
/// uncertainty beside it. `by_convention` lists those that do not come from the data.
[[nodiscard]] nlohmann::ordered_json models_json(
    const std::vector<identify::KinematicModel>& models);

}  // namespace sweepd
