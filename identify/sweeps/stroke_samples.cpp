#include "identify/sweeps/stroke_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/median.hpp"
#include "identify/geometry/sines.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/sweeps/even_motion.hpp"
#include "identify/sweeps/stroke_sections.hpp"

namespace identify {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector3d rotation_vector(const Quaterniond& rotation) {
  // Departures are small: the series' next term is below 1e-19 of the first.
  constexpr double kSmall = 1e-3;
  const double squared = rotation.vec().squaredNorm();
  if (squared < kSmall * kSmall)
    return std::copysign(2 + squared * (1.0 / 3 + squared * (3.0 / 20)), rotation.w()) *
           rotation.vec();
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

double median_of_row(SampleRows& rows, Index row) {
  return median_in({rows.row(row).data(), static_cast<std::size_t>(rows.cols())});
}

ArrayXd told_angles(const StrokeMoments& stroke, const StrokeSamples& seen) {
  ArrayXd told(static_cast<Index>(seen.samples.size()));
  for (std::size_t i = 0; i < seen.samples.size(); ++i)
    told(static_cast<Index>(i)) = seen.samples[i]->angles_rad[stroke.content.joint];
  return told;
}

/// Where the angle was told it says what the tool should be.
const ArrayXd& best_told(const StrokeMoments& stroke, const StrokeSamples& seen) {
  return stroke.told ? seen.told : seen.turns;
}

/// Standard deviation of what print leaves of each coordinate.
double rounding_mm(const StrokeMoments& stroke) {
  return kEvenlySpread * stroke.content.printed.position_mm;
}

/// Orders of the stroke's own curve.
Index curve_orders(Index samples, Index places) {
  return std::clamp<Index>(std::min(samples / 8, places / 2), 1, 8);
}

/// Of the weighted errors: see StrokeMoments::Blocks.
std::vector<double> variances_of_blocks(SampleRows sums) {
  const Index count = sums.cols();
  std::vector<double> variances;
  Index blocks = count;
  for (Index block = 1; block * 8 <= count || block == 1; block *= 2) {
    if (block > 1) {
      blocks /= 2;
      for (Index b = 0; b < blocks; ++b) sums.col(b) = sums.col(2 * b) + sums.col(2 * b + 1);
    }
    variances.push_back(sums.leftCols(blocks).square().sum() /
                        static_cast<double>(blocks * block * sums.rows()));
  }
  return variances;
}

}  // namespace

StrokeSamples samples_in(const Sweep& sweep) {
  StrokeSamples seen;
  seen.samples.reserve(sweep.samples->size());
  for (const Sample& sample : *sweep.samples)
    if (sample.has_position && sample.position_mm.allFinite()) seen.samples.push_back(&sample);
  seen.positions_mm.resize(3, static_cast<Index>(seen.samples.size()));
  for (std::size_t i = 0; i < seen.samples.size(); ++i)
    seen.positions_mm.col(static_cast<Index>(i)) = seen.samples[i]->position_mm;
  return seen;
}

void set_across(const StrokeMoments& stroke, StrokeSamples& seen) {
  constexpr double kNear = 10;
  const Index count = seen.positions_mm.cols();
  const Matrix3d directions = stroke.directions(stroke.zero_rad);
  const SampleRows from = seen.positions_mm.colwise() - stroke.circle.center_mm.array();
  const auto coordinate = [&](Index k) {
    return directions(k, 0) * from.row(0) + directions(k, 1) * from.row(1) +
           directions(k, 2) * from.row(2);
  };
  const SampleRows x = coordinate(0), y = coordinate(2);
  seen.errors.setZero(stroke.content.orientation ? 6 : 3, count);
  seen.errors.row(0) = x;
  if (!stroke.linear)
    seen.errors.row(0) = (x.square() + y.square()).sqrt() - stroke.circle.radius_mm;
  seen.errors.row(1) = coordinate(1);
  seen.distances = distances_of(seen.errors.topRows(2), rounding_mm(stroke));
  seen.beside = weights_of(seen.distances, 2, kNear) == 0;
  // From one to the next, so that turns go on beyond half a one.
  seen.turns.resize(count);
  double turn = 0, from_x = 1, from_y = 0;
  for (Index i = 0; i < count; ++i) {
    if (!seen.beside(i)) {
      turn = stroke.linear
                 ? y(i) / stroke.circle.radius_mm
                 : turn + small_angle(from_x * y(i) - from_y * x(i), from_x * x(i) + from_y * y(i));
      from_x = x(i);
      from_y = y(i);
    }
    seen.turns(i) = turn;
  }
}

void set_turns(StrokeMoments& stroke, StrokeSamples& seen) {
  if (stroke.content.joints == 0) return;
  ArrayXd told = told_angles(stroke, seen);
  const double mean_told = told.mean(), mean_about = seen.turns.mean();
  stroke.sense = ((told - mean_told) * (seen.turns - mean_about)).sum() < 0 ? -1 : 1;
  SampleRows apart = (seen.turns - mean_about - stroke.sense * (told - mean_told)).transpose();
  const double middle = median_of_row(apart, 0);
  apart = (apart - middle).abs();
  constexpr double kFollows_rad = 0.1;
  stroke.told = median_of_row(apart, 0) < kFollows_rad;
  if (!stroke.told) {
    stroke.sense = 1;
    return;
  }
  stroke.zero_rad = mean_told;
  const double there = mean_about + middle;
  stroke.shift(there);
  // A hundredth of a radian of noise in x moves what a model says by 1e-4 of its size. The normal
  // of so noisy a circle is uncertain: orientations, which turn about the axis itself, see both.
  constexpr double kSmallCircle = 0.01, kFineCircle = 2e-4;
  const double small = stroke.content.orientation
                           ? std::clamp(stroke.content.printed.angle_rad, kFineCircle, kSmallCircle)
                           : kSmallCircle;
  stroke.about = stroke.linear || stroke.circle.radial_rms_mm < small * stroke.circle.radius_mm;
  seen.turns = stroke.about ? ArrayXd(stroke.zero_rad + stroke.sense * (seen.turns - there)) : told;
  seen.told = std::move(told);
}

void set_turns_by(const StrokeMoments& like, StrokeSamples& seen) {
  seen.turns = like.zero_rad + like.sense * seen.turns;
  if (!like.linear) {
    const double off =
        (seen.turns.minCoeff() + seen.turns.maxCoeff() - like.from_rad - like.to_rad) / 2;
    seen.turns -= off - std::remainder(off, 2 * kPi);
  }
  if (!like.told) return;
  seen.told = told_angles(like, seen);
  if (!like.about) seen.turns = seen.told;
}

void set_range(StrokeMoments& stroke, StrokeSamples& seen) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  stroke.from_rad = seen.beside.select(kInfinite, seen.turns).minCoeff();
  stroke.to_rad = seen.beside.select(-kInfinite, seen.turns).maxCoeff();
  seen.turns = seen.turns.max(stroke.from_rad).min(stroke.to_rad);
}

void set_said(const StrokeMoments& stroke, StrokeSamples& seen) {
  if (!stroke.content.orientation) return;
  const ArrayXd& told = best_told(stroke, seen);
  seen.said.reserve(seen.samples.size());
  Sines a, b, c, back;
  for (std::size_t i = 0; i < seen.samples.size(); ++i) {
    // Rz(a) Ry(b) Rx(c), as orientation() has it, by half angles.
    const auto& abc = seen.samples[i]->abc_rad;
    a.set(abc[0] / 2);
    b.set(abc[1] / 2);
    c.set(abc[2] / 2);
    const Quaterniond tool(a.cosine * b.cosine * c.cosine + a.sine * b.sine * c.sine,
                           a.cosine * b.cosine * c.sine - a.sine * b.sine * c.cosine,
                           a.cosine * b.sine * c.cosine + a.sine * b.cosine * c.sine,
                           a.sine * b.cosine * c.cosine - a.cosine * b.sine * c.sine);
    if (!stroke.linear)
      back.set(stroke.sense * (stroke.zero_rad - told(static_cast<Index>(i))) / 2);
    const Vector3d turn = back.sine * stroke.circle.normal;
    seen.said.push_back(Quaterniond(back.cosine, turn.x(), turn.y(), turn.z()) * tool);
  }
}

void set_orientation(StrokeMoments& stroke, const StrokeSamples& seen) {
  if (!stroke.content.orientation) return;
  const Quaterniond start = seen.said[seen.said.size() / 2];
  SampleRows off(3, static_cast<Index>(seen.said.size()));
  for (std::size_t i = 0; i < seen.said.size(); ++i)
    off.col(static_cast<Index>(i)) = rotation_vector(seen.said[i] * start.conjugate());
  const Vector3d middle(median_of_row(off, 0), median_of_row(off, 1), median_of_row(off, 2));
  stroke.orientation =
      Eigen::AngleAxisd(middle.norm(), middle.stableNormalized()) * start.toRotationMatrix();
}

void set_errors(const StrokeMoments& stroke, StrokeSamples& seen) {
  const Index count = seen.turns.size();
  if (!stroke.about) {
    for (Index i = 0; i < count; ++i)
      seen.errors(2, i) = stroke.departure(Vector3d(seen.positions_mm.col(i)), seen.turns(i)).z();
  } else if (stroke.told) {
    seen.errors.row(2) =
        stroke.circle.radius_mm * stroke.sense * (seen.turns - seen.told).transpose();
  }
  if (!stroke.content.orientation) return;
  const Quaterniond back = Quaterniond(stroke.orientation).conjugate();
  const Matrix3d directions = stroke.directions(stroke.zero_rad);
  Sines ahead;
  for (Index i = 0; i < count; ++i) {
    // From where the told angle says, in the directions at x: see ReferenceMotion::departure().
    const Vector3d off =
        directions * rotation_vector(seen.said[static_cast<std::size_t>(i)] * back);
    if (stroke.told && !stroke.linear) ahead.set(stroke.sense * (seen.told(i) - seen.turns(i)));
    seen.errors(3, i) = ahead.cosine * off(0) - ahead.sine * off(2);
    seen.errors(4, i) = off(1);
    seen.errors(5, i) = ahead.sine * off(0) + ahead.cosine * off(2);
  }
}

void set_weights(StrokeMoments& stroke, StrokeSamples& seen) {
  const Index count = seen.turns.size();
  const Index directions = stroke.told ? 3 : 2;
  const Index places = places_of(seen.turns, stroke.from_rad, stroke.to_rad);
  StrokeCurve curve(seen.turns, stroke.from_rad, stroke.to_rad, curve_orders(count, places));
  // The wobble of locked joints, which their angles tell, is in these errors, and not everywhere
  // along the stroke as large.
  const double wide = stroke.content.joints > 0 ? 2 : 1;
  const auto weigh = [&](const ArrayXd& distances, Index rows) {
    seen.weights = seen.beside.select(0, weights_of(distances, rows, wide));
  };
  // Printed alike all along an even speed, and otherwise on the ramps, told angles are no outliers.
  const double told_mm =
      stroke.told ? stroke.circle.radius_mm * kEvenlySpread * stroke.content.printed.angle_rad : 0;
  weigh(seen.distances, 2);  // the circle is robust; what is told may be off
  SampleRows left;
  constexpr int kMostRounds = 4;
  constexpr double kSettled = 1e-3;
  for (int round = 0; round < kMostRounds; ++round) {
    const ArrayXd before = seen.weights;
    curve.weigh(before);
    left = curve.left(seen.errors.topRows(directions));
    weigh(distances_of(left, rounding_mm(stroke), told_mm), directions);
    if ((seen.weights - before).abs().maxCoeff() < kSettled) break;
  }
  stroke.blocks.curve_orders = static_cast<std::size_t>(curve.orders());
  stroke.blocks.variance_mm2 = variances_of_blocks(left.topRows(kBlockDirections).rowwise() *
                                                   seen.weights.sqrt().transpose());
  if (!stroke.squares) return;  // repeats are rounded alike
  curve.weigh(seen.weights);
  const double across_mm2 = stroke.blocks.variance_mm2.front();
  const double radius_mm = stroke.circle.radius_mm;
  const double across_rad2 = across_mm2 / (radius_mm * radius_mm);
  const bool printed = stroke.about && stroke.content.printed.angle_rad > 0;
  const double noise = printed ? std::sqrt(std::max(across_rad2, unevenness(seen.turns))) : 0;
  stroke.rounding = rounding_of(seen, stroke.content, curve, across_mm2, noise);
  if (told_mm > 0 && stroke.about)
    stroke.rounding.told = told_rounding(seen, left.row(2).transpose() / radius_mm, across_rad2,
                                         noise, stroke.content.printed.angle_rad);
}

void count_weights(StrokeMoments& stroke, const StrokeSamples& seen) {
  stroke.samples = seen.samples.size();
  stroke.weight = seen.weights.sum();
  stroke.outliers = static_cast<std::size_t>((seen.weights < 0.5).count());
}

}  // namespace identify
