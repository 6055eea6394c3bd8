#include "daemon/described.hpp"

#include <algorithm>

namespace sweepd {

Described described(const Outcome& outcome) {
  using identify::AngleTrust;
  const auto& found = outcome.identification;
  if (found.estimator == identify::Estimator::axes) return Described::arm;
  if (!outcome.points) return Described::controller_model;
  const bool from_angles =
      found.chain && std::any_of(found.chain->angles.begin(), found.chain->angles.end(),
                                 [](const identify::AngleEvidence& joint) {
                                   return joint.trust == AngleTrust::trusted;
                                 });
  return from_angles ? Described::controller_model : Described::arm;
}

std::string_view text(Described described) noexcept {
  return described == Described::arm ? "arm" : "controller_model";
}

std::string_view explanation(Described described) noexcept {
  return described == Described::arm
             ? "the arm as a device measured it: for calibration, and to compare with its model. "
               "Elastic deformation is not in the uncertainties: sweeps from a second home, or "
               "with "
               "another load, would show it."
             : "the controller's model: its positions are computed from its angles. It tells "
               "machine "
               "data, TOOL and BASE, and whether an elastic model is active. It does not tell how "
               "the arm itself is: for that, measure it with a device.";
}

}  // namespace sweepd
