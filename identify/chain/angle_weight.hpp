#pragma once

#include <vector>

namespace identify {

/// How much an angle counts that was taken at some speed (rad/s): one by its variance (rad^2).
struct AngleWeight {
  double still = 1;      ///< variance of errors that speed does not matter to, rad^2
  double per_speed = 0;  ///< and of those of time: jitter squared, s^2
  double alone = 1;      ///< the share of errors that tell something new
  [[nodiscard]] double at(double speed) const {
    return alone / (still + per_speed * speed * speed);
  }
};

/// Squared errors as a line over the squared speeds, by least squares that are weighed by it.
/// `mean`: of the squared errors.
[[nodiscard]] AngleWeight weight_by_speed(const std::vector<double>& squares,
                                          const std::vector<double>& squared_speeds, double mean);

}  // namespace identify
