#pragma once

#include <Eigen/Core>

#include "identify/poses/pose_fit.hpp"

namespace identify {

/// Covariance of the model's fixed parameters where the poses drifted (PoseDrift): the fit is of an
/// arm between the halves of the poses, and either half's is off it by half of what parts them.
[[nodiscard]] Eigen::MatrixXd drift_spread(const PoseFit& fit);

}  // namespace identify
