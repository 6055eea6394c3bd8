#pragma once

#include <array>
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
/// away: all of it where the coordinate stays within a step, some where it passes few, as that
/// along a joint's axis, most of it where it goes on by nearly a whole number of steps from sample
/// to sample, as A, B and C may.
struct StrokeRounding {
  using Coordinates = Eigen::Array<double, 6, 1>;
  /// Of a stroke's level, its growth from the middle to its ends and its bend: the Legendre
  /// polynomials of its turn, from minus one at the least to one at the greatest.
  static constexpr std::size_t kOrders = 3;

  Coordinates extent = Coordinates::Zero();  ///< greatest minus least
  /// Whether the places within a step were looked at: of A, B, C, and X, Y, Z that pass few steps.
  Eigen::Array<bool, 6, 1> followed = Eigen::Array<bool, 6, 1>::Constant(false);
  /// Variance about smooth curves; of X, Y, Z that pass many steps that across the arc.
  Coordinates scatter = Coordinates::Zero();
  double samples = 0;
  /// Of those followed: variance from sample to sample about an even motion, wobble and all.
  Coordinates uneven = Coordinates::Zero();
  /// What the places at which numbers were rounded leave of it in each order, had they not
  /// scattered: variances in that of all rounding. Level: from 0, evenly spread, to 1, all the
  /// same, as where a number goes on by whole steps from sample to sample.
  std::array<Coordinates, kOrders> agreement = {Coordinates::Zero(), Coordinates::Zero(),
                                                Coordinates::Zero()};
  /// Of the sweeping joint's angle as told: variances about where it was seen, and from sample to
  /// sample, rad^2. Nothing where the positions do not tell the turn.
  struct Told {
    double scatter = 0;
    double uneven = 0;
    std::array<double, kOrders> agreement{};
  };
  std::optional<Told> told;

  /// Variances of what rounding shifts the coordinates by, one for each order.
  [[nodiscard]] std::array<Coordinates, kOrders> shifts(double step_mm, double step_rad) const;
  /// The same of the sweeping joint's angle.
  [[nodiscard]] std::array<double, kOrders> told_shifts(double step_rad) const;
};

/// `curve`: of the turn, which the positions tell with noise of this standard deviation;
/// `across_mm2`: variance of what it leaves across the arc. A, B, C are zero where the orientation
/// was not measured.
[[nodiscard]] StrokeRounding rounding_of(const StrokeSamples& seen, const StrokeContent& content,
                                         const StrokeCurve& curve, double across_mm2,
                                         double turn_sigma_rad);

/// `along_rad`: what the stroke's curve leaves of the told angle's errors; `across_rad2`: variance
/// of what it leaves across, as an angle.
[[nodiscard]] StrokeRounding::Told told_rounding(const StrokeSamples& seen,
                                                 const Eigen::ArrayXd& along_rad,
                                                 double across_rad2, double turn_sigma_rad,
                                                 double step_rad);

/// What the angles told along a stroke are all off by, as they are printed in these steps: a
/// standard deviation. `seen_rad`: at the same times, as positions tell them, with this noise.
[[nodiscard]] double told_level_rad(const Eigen::ArrayXd& times_s, const Eigen::ArrayXd& told_rad,
                                    const Eigen::ArrayXd& seen_rad, double seen_sigma_rad,
                                    double step_rad);

/// How far a joint that stands still may be from the mean of its printed angles. All in steps:
/// that mean, the variance about it, and what is returned, a standard deviation.
[[nodiscard]] double unseen_zero(double mean, double variance);

}  // namespace identify
