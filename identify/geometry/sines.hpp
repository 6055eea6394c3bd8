#pragma once

#include <cmath>

namespace identify {

/// Sine and cosine of angles that go on slowly, one after the other: from one of the last on, a few
/// terms are right to the last bit, and a third of the work of std::sin() and std::cos().
class Sines {
 public:
  double sine = 0;
  double cosine = 1;

  void set(double angle_rad) {
    constexpr double kSmall = 0.02;
    const double by = angle_rad - from_rad_;
    if (!(std::abs(by) < kSmall)) {
      from_rad_ = angle_rad;
      sine = from_sine_ = std::sin(angle_rad);
      cosine = from_cosine_ = std::cos(angle_rad);
      return;
    }
    const double square = by * by;
    const double ahead = by * (1 - square / 6 * (1 - square / 20 * (1 - square / 42)));
    const double back = square / 2 * (1 - square / 12 * (1 - square / 30 * (1 - square / 56)));
    sine = from_sine_ + (from_cosine_ * ahead - from_sine_ * back);
    cosine = from_cosine_ - (from_sine_ * ahead + from_cosine_ * back);
  }

 private:
  double from_rad_ = 0;
  double from_sine_ = 0;
  double from_cosine_ = 1;
};

/// std::atan2(), which is slow: from point to point, angles are mostly so small that a few terms
/// are right to the last bit.
[[nodiscard]] inline double small_angle(double sine, double cosine) {
  constexpr double kSmall = 0.01;
  const double t = sine / cosine;
  if (!(cosine > 0 && std::abs(t) < kSmall)) return std::atan2(sine, cosine);
  const double square = t * t;
  return t * (1 - square * (1.0 / 3 - square * (1.0 / 5 - square / 7)));
}

}  // namespace identify
