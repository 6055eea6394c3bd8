#include "daemon/results/described.hpp"

#include <algorithm>

namespace sweepd {

Described described(const Outcome& outcome) {
  using identify::AngleTrust;
  const auto& found = outcome.identification;
  if (found.estimator == identify::Estimator::axes) return Described::arm;
  if (outcome.joined) return Described::arm;
  if (!outcome.points) return Described::controller_model;
  if (found.poses) return found.poses->computed ? Described::controller_model : Described::arm;
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

std::string explanation(const Outcome& outcome) {
  if (described(outcome) == Described::controller_model)
    return "the controller's model: its positions are computed from its angles. It tells machine "
           "data, TOOL and BASE, and whether an elastic model is active. It does not tell how the "
           "arm itself is: for that, measure it with a device.";
  if (outcome.identification.poses)
    return "the arm as a device measured it: for calibration, and to compare with its model. "
           "Where joints are seen to give way to weight, the table of what joints do says so. What "
           "the poses do not show of it is not in the uncertainties.";
  const auto& chain = outcome.identification.chain;
  const std::string_view elastic =
      !chain || !(chain->effects.sag_rad > 0)
          ? "Elastic deformation is not in the uncertainties: sag_arcsec in the robot description "
            "puts it there, and so do static poses and sweeps from a second home."
      : chain->effects.sag_told
          ? "Elastic deformation is in the uncertainties as far as the robot description states it "
            "(sag_arcsec)."
          : "Elastic deformation is in the uncertainties as far as sweeps from several homes show "
            "it.";
  return "the arm as a device measured it: for calibration, and to compare with its model. " +
         std::string(elastic);
}

}  // namespace sweepd
