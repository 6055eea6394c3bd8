#pragma once

#include <optional>

#include <Eigen/Core>

#include "identify/geometry/circle_fit.hpp"

namespace identify {

/// Points so many times the middle one's distance off a robust circle are outliers.
inline constexpr double kOutlierDistances = 6;

/// The circle that fits most of the points: least median of squares (Rousseeuw, JASA 79, 1984) over
/// circles through three points each, then `fit_circle` of those points that lie close to it. Up to
/// nearly half of the points may be anywhere. Deterministic. Nothing where `fit_circle` has
/// nothing.
[[nodiscard]] std::optional<CircleFit> fit_robust_circle(const Eigen::Matrix3Xd& points_mm);

}  // namespace identify
