#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "identify/sweeps/reference_motion.hpp"
#include "identify/sweeps/stroke_rounding.hpp"
#include "identify/sweeps/sweep.hpp"

namespace identify {

/// What of a stroke's samples the moments take up.
struct StrokeContent {
  std::size_t joint = 0;   ///< the one that turns
  std::size_t joints = 0;  ///< whose angles every sample has; 0: no angles
  bool orientation = false;
  bool linear = false;      ///< it moves along a line
  Resolution printed = {};  ///< steps; 0: at full precision
};

/// The errors that tell how the samples' noise is correlated: radial and axial.
inline constexpr int kBlockDirections = 2;

/// A stroke in so few numbers that no sample is needed again: sums over its samples, at nodes of
/// the turn, from which the weighted sum of any smooth function of the turn follows.
///
/// Along a stroke all that a model says is a smooth function f of the turn x. With the Lagrange
/// polynomials L_k of the nodes x_k, sum_i w_i f(x_i) z_i z_i^T = sum_k f(x_k) S_k with
/// S_k = sum_i w_i L_k(x_i) z_i z_i^T, exactly for f up to the polynomials' degree (Berrut &
/// Trefethen, SIAM Review 46, 2004, eq. 4.2, for the L_k). z is (1, e, v):
///  - e, its departure from the stroke's reference motion: radial, axial, tangential (mm; the last
///    along the arc at the reference radius, from where the told angle says), and where measured
///    the rotation vector (rad) in these three directions;
///  - v, where angles are known, each locked joint's angle minus its mean over the stroke (rad); 0
///    for the joint that turns.
/// w is a robust weight: a sample far from the stroke's own smooth curve has none.
///
/// x is the angle about the reference circle (rad), from the joint's zero where its angle as told
/// follows the arc. Where the circle is too small to see the angle, x is what is told. Lengths in
/// mm in the measurement frame.
struct StrokeMoments : ReferenceMotion {
  struct Node {
    double turn_rad = 0;  ///< x
    Eigen::MatrixXd sums;
  };

  StrokeContent content;
  std::size_t target = 0;
  /// Of so many strokes, one after the other the same way, these are the sums.
  std::size_t strokes = 1;
  /// Whether `sums` are whole; else there is only their first column, the sums of z.
  bool squares = true;
  bool told = false;     ///< the angle as told follows the arc
  bool about = true;     ///< x is the angle about the circle
  bool falling = false;  ///< the stroke's direction
  double begin_s = 0;
  double end_s = 0;
  /// How many successive samples are worth one independent one.
  double correlation = 1;
  std::size_t samples = 0;
  std::size_t outliers = 0;  ///< of them: given less than half their weight
  double weight = 0;         ///< sum of all w

  std::array<double, kMostJoints> locked_rad{};  ///< mean angle as told; of the turning one nothing
  std::array<bool, kMostJoints> dithers{};       ///< whether the angle told changed at all

  StrokeRounding rounding;
  double from_rad = 0;   ///< least x
  double to_rad = 0;     ///< greatest x
  double begin_rad = 0;  ///< x of the first sample
  double end_rad = 0;    ///< x of the last sample
  std::vector<Node> nodes;
  /// From minus one at the least x to one at the greatest.
  [[nodiscard]] double place_of(double turn_rad) const {
    return to_rad > from_rad
               ? std::clamp((2 * turn_rad - from_rad - to_rad) / (to_rad - from_rad), -1.0, 1.0)
               : 0;
  }
  /// When it was there, had it turned evenly from its first sample to its last one.
  [[nodiscard]] double time_s(double turn_rad) const {
    if (begin_rad == end_rad) return (begin_s + end_s) / 2;
    return begin_s + (turn_rad - begin_rad) / (end_rad - begin_rad) * (end_s - begin_s);
  }

  /// Of the errors left by the stroke's own curve, radial and axial: the mean square of sums over
  /// 2^b successive samples, divided by 2^b. White noise gives the same for all b.
  struct Blocks {
    std::vector<double> variance_mm2;
    std::size_t curve_orders = 0;  ///< how many orders were taken out of each direction
  };
  Blocks blocks;
};

/// Two passes over the samples. Nothing where they lie on no circle (or line).
[[nodiscard]] std::optional<StrokeMoments> moments_of(const Sweep& sweep,
                                                      const StrokeContent& content);

/// The first moments of a stroke that goes the same way as the one that `like` is of: departures
/// from that one's reference motion, locked angles minus that one's, at that one's nodes. Nothing
/// where its samples are spread in another way along the arc, or where the arm or the device has
/// moved since: what is not linear in that would be lost in a sum.
[[nodiscard]] std::optional<StrokeMoments> moments_like(const StrokeMoments& like,
                                                        const Sweep& sweep);

/// Adds the sums of another stroke that are first moments by the same `like`.
void add(StrokeMoments& sum, const StrokeMoments& one);

}  // namespace identify
