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
  /// Variance from sample to sample about an even motion, wobble and all: of A, B and C.
  Coordinates uneven = Coordinates::Zero();
  /// How far the places within a step agree at which numbers were rounded, from 0, evenly spread,
  /// to 1, all the same, as where a number goes on by whole steps from sample to sample.
  Coordinates agreement = Coordinates::Zero();
  /// Of the sweeping joint's angle as told: variances about where it was seen, and from sample to
  /// sample, rad^2. Nothing where the positions do not tell the turn.
  struct Told {
    double scatter = 0;
    double uneven = 0;
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

/// Variance of what numbers scatter by from one to the next about an even motion.
[[nodiscard]] double unevenness(const Eigen::ArrayXd& numbers);

/// `curve`: of the turn, which the positions tell with noise of this standard deviation. A, B, C
/// are zero where the orientation was not measured.
[[nodiscard]] StrokeRounding rounding_of(const StrokeSamples& seen, const StrokeContent& content,
                                         const StrokeCurve& curve, double turn_sigma_rad);

/// `along_rad`: what the stroke's curve leaves of the told angle's errors; `across_rad2`: variance
/// of what it leaves across, as an angle.
[[nodiscard]] StrokeRounding::Told told_rounding(const StrokeSamples& seen,
                                                 const Eigen::ArrayXd& along_rad,
                                                 double across_rad2, double turn_sigma_rad,
                                                 double step_rad);

/// Standard deviation of what is spread evenly over one step, in steps: 1 / sqrt(12).
inline constexpr double kEvenlySpread = 0.2887;

/// How far a joint that stands still may be from the mean of its printed angles. All in steps:
/// that mean, the variance about it, and what is returned, a standard deviation.
[[nodiscard]] double unseen_zero(double mean, double variance);

}  // namespace identify
