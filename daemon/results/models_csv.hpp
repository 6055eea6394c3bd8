#pragma once

#include <string>
#include <vector>

#include "identify/models/kinematic_model.hpp"

namespace sweepd {

/// models.csv: a row a number, in full precision: a reader's forward kinematics is the chain's to
/// 1e-9 m. Joint 0 is the base, the one after the last the tool. `sigma` and the limits of the 95 %
/// interval are empty where the number comes from no data, its uncertainty is not known, or is zero
/// to first order.
[[nodiscard]] std::string models_csv(const std::vector<identify::KinematicModel>& models);

}  // namespace sweepd
