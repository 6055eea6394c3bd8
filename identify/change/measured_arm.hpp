#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "identify/dh/dh_extraction.hpp"

namespace identify {

/// What a result tells of an arm. All numbers of the table but the last row's are known.
struct MeasuredArm {
  std::vector<DhEstimate> dh;
  /// Of all numbers: five rows a row (b, theta, a, alpha, beta; mm, rad), zero for what is not
  /// identified.
  Eigen::MatrixXd covariance;
  std::vector<int> positive;  ///< +1 where Z of the table is along positive rotation, -1 against it
  std::vector<std::optional<double>> home_rad;  ///< as Identification has them
  /// By how much each joint's gear is off, rad per rad that it turned from home, root mean square;
  /// nothing where no angles tell.
  std::vector<std::optional<double>> gear;
  /// False where the first axes are parallel, and nothing but the description tells where along
  /// them the base is.
  bool height_known = true;
  std::vector<DhRow> specified;  ///< the description's table; empty where there was none
};

}  // namespace identify
