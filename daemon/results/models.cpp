#include "daemon/results/models.hpp"

#include "daemon/text/units.hpp"
#include "identify/models/kinematic_model.hpp"

namespace sweepd {

std::vector<identify::KinematicModel> models_of(const Outcome& outcome) {
  const auto& found = outcome.identification;
  using identify::Estimator;
  if (!found.chain || (found.estimator != Estimator::chain && found.estimator != Estimator::poses))
    return {};
  const identify::ChainEstimate& estimate = *found.chain;
  return identify::kinematic_models({estimate.chain, outcome.positive, estimate.dh,
                                     estimate.covariance, found.home_rad, true,
                                     estimate.with_orientation});
}

double in_file_units(double value, identify::Quantity quantity) {
  return (quantity == identify::Quantity::angle ? degrees(value) : value) + 0.0;
}

}  // namespace sweepd
