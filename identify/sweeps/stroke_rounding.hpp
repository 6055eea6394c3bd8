#pragma once

#include <optional>

#include <Eigen/Core>

namespace identify {

struct StrokeContent;
struct StrokeSamples;
class StrokeCurve;

/// What tells how the printed coordinates of a stroke's target were rounded: X, Y, Z (mm) and A, B,
/// C (rad).
///
/// Each number is off by up to half a step of its last decimal: as a variance, step^2 / 12. Of a
/// coordinate that passes many steps unevenly, this is noise that no two samples share, and
/// averages out. What does not scatter lies along the stroke, where no number of samples takes it
/// away: all of it where the coordinate stays within a step, most of it where it goes on by nearly
/// a whole number of steps from sample to sample, as A, B and C may; X, Y and Z go along an arc.
struct StrokeRounding {
  using Coordinates = Eigen::Array<double, 6, 1>;
  Coordinates extent = Coordinates::Zero();  ///< greatest minus least
  /// Variance about smooth curves: of X, Y and Z that across the arc.
  Coordinates scatter = Coordinates::Zero();
  double samples = 0;
  /// How far the places within a step agree at which numbers were rounded, from 0, evenly spread,
  /// to 1, all the same, as where a number goes on by whole steps from sample to sample.
  Coordinates agreement = Coordinates::Zero();
  /// Of the sweeping joint's angle as told: variance about where it was seen, rad^2. Nothing where
  /// the positions do not tell the turn.
  struct Told {
    double scatter = 0;
    double agreement = 0;
  };
  std::optional<Told> told;

  /// Variances of what rounding shifts the coordinates by over the whole stroke, and of how much
  /// more from its middle to its ends.
  struct Shifts {
    Coordinates level = Coordinates::Zero();
    Coordinates growth = Coordinates::Zero();
  };
  [[nodiscard]] Shifts shifts(double step_mm, double step_rad) const;
  /// The same of the sweeping joint's angle, over the whole stroke.
  [[nodiscard]] double told_shift(double step_rad) const;
};

/// Standard deviation of the noise of the turns as the positions tell them: what is uneven from
/// sample to sample, and no less than the positions scatter across the arc, as an angle.
[[nodiscard]] double turn_noise(const StrokeSamples& seen, double across_rad);

/// `curve`: of the turn, which the positions tell with this noise. A, B, C are zero where the
/// orientation was not measured.
[[nodiscard]] StrokeRounding rounding_of(const StrokeSamples& seen, const StrokeContent& content,
                                         const StrokeCurve& curve, double turn_sigma_rad);

/// `along_rad`: what the stroke's curve leaves of the told angle's errors.
[[nodiscard]] StrokeRounding::Told told_rounding(const StrokeSamples& seen,
                                                 const Eigen::ArrayXd& along_rad,
                                                 double turn_sigma_rad, double step_rad);

/// Standard deviation of what is spread evenly over one step, in steps: 1 / sqrt(12).
inline constexpr double kEvenlySpread = 0.2887;

/// How far a joint that stands still may be from the mean of its printed angles. All in steps:
/// that mean, the variance about it, and what is returned, a standard deviation.
[[nodiscard]] double unseen_zero(double mean, double variance);

}  // namespace identify
