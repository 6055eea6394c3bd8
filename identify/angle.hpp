#pragma once

#include <numbers>

namespace identify {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180;
inline constexpr double kArcsec = kDegree / 3600;

}  // namespace identify
