#include "identify/sweeps/stroke_moments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/median.hpp"
#include "identify/sweeps/sample.hpp"
#include "identify/sweeps/stroke_curve.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

Vector3d rotation_vector(const Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

/// Longer strokes are cut: twelve nodes hold what a model says over so much.
constexpr double kSection_rad = kPi / 4;

/// Of so many samples. More nodes than this and some get weights near zero, and means far from all
/// samples: equally spaced ones determine polynomials of twice their number's root (Rakhmanov 2007,
/// Annals of Mathematics 165).
std::size_t node_count(double samples) {
  return static_cast<std::size_t>(
      std::clamp(2 * std::sqrt(samples), 2.0, static_cast<double>(Lagrange::kMostNodes)));
}

/// The samples as they are worked on.
struct Seen {
  std::vector<const Sample*> samples;
  std::vector<double> turns;                        // x
  std::vector<double> told;                         // where it follows the arc
  Eigen::Matrix<double, 6, Eigen::Dynamic> errors;  // e
  std::vector<bool> beside;                         // far from the circle
  VectorXd weights;
};

/// What is nowhere near the circle tells nothing of the turn.
void set_aside(const StrokeMoments& stroke, Seen& seen) {
  constexpr double kNear = 10;
  MatrixXd off(2, static_cast<Index>(seen.samples.size()));
  for (std::size_t i = 0; i < seen.samples.size(); ++i)
    off.col(static_cast<Index>(i)) =
        stroke.departure(seen.samples[i]->position_mm, stroke.zero_rad).head<2>();
  const VectorXd near = weights_of(off, kNear);
  for (const double weight : near) seen.beside.push_back(weight == 0);
}

/// Which way x goes about the circle, where it is zero, and whether what is told follows the arc.
void set_turns(StrokeMoments& stroke, Seen& seen) {
  const std::size_t count = seen.samples.size();
  std::vector<double> about(count);
  // Unwrapped along the motion.
  double last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = stroke.angle_about(seen.samples[i]->position_mm);
    if (!seen.beside[i]) last += stroke.step(last, angle);
    about[i] = last;
  }
  if (stroke.content.joints > 0) {
    const auto told = [&](std::size_t i) {
      return seen.samples[i]->angles_rad[stroke.content.joint];
    };
    double mean_told = 0, mean_about = 0;
    for (std::size_t i = 0; i < count; ++i) {
      mean_told += told(i) / static_cast<double>(count);
      mean_about += about[i] / static_cast<double>(count);
    }
    double together = 0;
    for (std::size_t i = 0; i < count; ++i)
      together += (told(i) - mean_told) * (about[i] - mean_about);
    stroke.sense = together < 0 ? -1 : 1;
    std::vector<double> apart(count);
    for (std::size_t i = 0; i < count; ++i)
      apart[i] = about[i] - mean_about - stroke.sense * (told(i) - mean_told);
    const double middle = median_of(apart);
    for (double& one : apart) one = std::abs(one - middle);
    constexpr double kFollows_rad = 0.1;
    stroke.told = median_of(apart) < kFollows_rad;
    if (stroke.told) {
      stroke.zero_rad = mean_told;
      const double there = mean_about + middle;
      stroke.shift(there);
      // A hundredth of a radian of noise in x moves what a model says by 1e-4 of its size.
      constexpr double kSmallCircle = 0.01;
      stroke.about =
          stroke.linear || stroke.circle.radial_rms_mm < kSmallCircle * stroke.circle.radius_mm;
      for (std::size_t i = 0; i < count; ++i) seen.told.push_back(told(i));
      if (!stroke.about) {
        seen.turns = seen.told;
        return;
      }
      for (double& one : about) one = stroke.zero_rad + stroke.sense * (one - there);
    } else {
      stroke.sense = 1;
    }
  }
  seen.turns = std::move(about);
}

void set_errors(StrokeMoments& stroke, Seen& seen) {
  const auto count = static_cast<Index>(seen.samples.size());
  if (stroke.content.orientation) {
    // The reference orientation: the mean of what each sample says, from the middle one.
    const auto said = [&](std::size_t i) {
      const double turn = stroke.told ? seen.told[i] : seen.turns[i];
      return Matrix3d(stroke.turned(stroke.zero_rad - turn) * orientation(*seen.samples[i]));
    };
    const Matrix3d start = said(seen.samples.size() / 2);
    std::vector<Vector3d> off(seen.samples.size());
    for (std::size_t i = 0; i < off.size(); ++i)
      off[i] = rotation_vector(said(i) * start.transpose());
    const Vector3d middle = median(off);
    stroke.orientation = Eigen::AngleAxisd(middle.norm(), middle.stableNormalized()) * start;
  }
  seen.errors.setZero(6, count);
  for (Index i = 0; i < count; ++i) {
    const Sample& sample = *seen.samples[static_cast<std::size_t>(i)];
    const double turn = seen.turns[static_cast<std::size_t>(i)];
    seen.errors.col(i).head<3>() = stroke.departure(sample.position_mm, turn);
    if (stroke.about)
      seen.errors(2, i) = stroke.told ? stroke.circle.radius_mm * stroke.sense *
                                            (turn - seen.told[static_cast<std::size_t>(i)])
                                      : 0;
    if (stroke.content.orientation)
      seen.errors.col(i).tail<3>() = stroke.departure(
          orientation(sample), turn, stroke.told ? seen.told[static_cast<std::size_t>(i)] : turn);
  }
}

/// Orders of the stroke's own curve.
Index curve_orders(Index samples) {
  return std::clamp<Index>(samples / 8, 1, 8);
}

void set_weights(StrokeMoments& stroke, Seen& seen) {
  const auto count = static_cast<Index>(seen.samples.size());
  const Index directions = stroke.told ? 3 : 2;
  const MatrixXd errors = seen.errors.topRows(directions);
  const StrokeCurve curve(seen.turns, stroke.from_rad, stroke.to_rad, curve_orders(count));
  // The wobble of locked joints, which their angles tell, is in these errors, and not everywhere
  // along the stroke as large.
  const double wide = stroke.content.joints > 0 ? 2 : 1;
  const auto weigh = [&](const MatrixXd& left) {
    seen.weights = weights_of(left, wide);
    for (Index i = 0; i < count; ++i)
      if (seen.beside[static_cast<std::size_t>(i)]) seen.weights(i) = 0;
  };
  weigh(errors.topRows(2));  // the circle is robust; what is told may be off
  MatrixXd left;
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    left = curve.left(errors, seen.weights);
    weigh(left);
  }
  stroke.blocks.curve_orders = static_cast<std::size_t>(curve_orders(count));
  const MatrixXd weighed = left.topRows(kBlockDirections) * seen.weights.cwiseSqrt().asDiagonal();
  for (Index block = 1; block * 8 <= count || block == 1; block *= 2) {
    double sum = 0;
    const Index blocks = count / block;
    for (Index b = 0; b < blocks; ++b)
      sum += weighed.middleCols(b * block, block).rowwise().sum().squaredNorm();
    stroke.blocks.variance_mm2.push_back(sum /
                                         static_cast<double>(blocks * block * kBlockDirections));
  }
}

void add_moments(StrokeMoments& stroke, const Seen& seen) {
  const Index with_errors = stroke.content.orientation ? 6 : 3;
  const auto wobbles = static_cast<Index>(stroke.content.joints);
  const Index size = 1 + with_errors + wobbles;
  const double range = stroke.to_rad - stroke.from_rad;
  // Along a line all that a model says is linear in the turn.
  const auto sections = static_cast<std::size_t>(
      stroke.linear ? 1.0 : std::max(1.0, std::ceil(range / kSection_rad)));
  const std::size_t nodes =
      node_count(static_cast<double>(seen.samples.size()) / static_cast<double>(sections));
  std::vector<Lagrange> lagrange;
  for (std::size_t s = 0; s < sections; ++s) {
    const auto at = [&](std::size_t k) {
      return stroke.from_rad + range * static_cast<double>(k) / static_cast<double>(sections);
    };
    lagrange.emplace_back(at(s), at(s + 1), nodes);
    for (std::size_t k = 0; k < nodes; ++k)
      stroke.nodes.push_back({lagrange.back().node(k), MatrixXd::Zero(size, size)});
  }
  VectorXd z(size);
  z(0) = 1;
  Lagrange::Values values;
  for (std::size_t i = 0; i < seen.samples.size(); ++i) {
    const double weight = seen.weights(static_cast<Index>(i));
    if (weight == 0) continue;
    z.segment(1, with_errors) = seen.errors.col(static_cast<Index>(i)).head(with_errors);
    for (Index k = 0; k < wobbles; ++k) {
      const auto joint = static_cast<std::size_t>(k);
      z(1 + with_errors + k) = joint == stroke.content.joint
                                   ? 0
                                   : seen.samples[i]->angles_rad[joint] - stroke.locked_rad[joint];
    }
    const double place = range > 0 ? (seen.turns[i] - stroke.from_rad) / range : 0;
    const auto section =
        std::min(sections - 1,
                 static_cast<std::size_t>(std::max(0.0, place * static_cast<double>(sections))));
    lagrange[section].at(seen.turns[i], values);
    for (std::size_t k = 0; k < nodes; ++k)
      stroke.nodes[section * nodes + k].sums.selfadjointView<Eigen::Lower>().rankUpdate(
          z, weight * values[k]);
  }
  for (StrokeMoments::Node& node : stroke.nodes)
    node.sums.triangularView<Eigen::StrictlyUpper>() = node.sums.transpose();
}

}  // namespace

std::optional<StrokeMoments> moments_of(const Sweep& sweep, const StrokeContent& content) {
  Seen seen;
  for (const Sample& sample : *sweep.samples)
    if (sample.has_position && sample.position_mm.allFinite()) seen.samples.push_back(&sample);
  Eigen::Matrix3Xd points(3, static_cast<Index>(seen.samples.size()));
  for (std::size_t i = 0; i < seen.samples.size(); ++i)
    points.col(static_cast<Index>(i)) = seen.samples[i]->position_mm;
  StrokeMoments stroke;
  stroke.content = content;
  stroke.linear = content.linear;
  const Vector3d middle = seen.samples.empty() ? Vector3d(Vector3d::Zero())
                                               : seen.samples[seen.samples.size() / 2]->position_mm;
  if (!set_reference(stroke, points, middle)) return std::nullopt;
  stroke.target = sweep.target;
  stroke.falling = sweep.direction < 0;
  stroke.begin_s = sweep.first().time_s;
  stroke.end_s = sweep.last().time_s;
  stroke.samples = seen.samples.size();
  stroke.extent_mm = points.rowwise().maxCoeff() - points.rowwise().minCoeff();
  for (std::size_t k = 0; k < content.joints; ++k) {
    const double first = seen.samples.front()->angles_rad[k];
    double sum = 0;
    for (const Sample* sample : seen.samples) {
      sum += sample->angles_rad[k] - first;
      stroke.dithers[k] = stroke.dithers[k] || sample->angles_rad[k] != first;
    }
    stroke.locked_rad[k] = first + sum / static_cast<double>(stroke.samples);
  }
  set_aside(stroke, seen);
  set_turns(stroke, seen);
  stroke.from_rad = std::numeric_limits<double>::infinity();
  stroke.to_rad = -stroke.from_rad;
  for (std::size_t i = 0; i < seen.turns.size(); ++i) {
    if (seen.beside[i]) continue;
    stroke.from_rad = std::min(stroke.from_rad, seen.turns[i]);
    stroke.to_rad = std::max(stroke.to_rad, seen.turns[i]);
  }
  for (double& turn : seen.turns) turn = std::clamp(turn, stroke.from_rad, stroke.to_rad);
  set_errors(stroke, seen);
  set_weights(stroke, seen);
  stroke.weight = seen.weights.sum();
  stroke.outliers = static_cast<std::size_t>((seen.weights.array() < 0.5).count());
  add_moments(stroke, seen);
  return stroke;
}

}  // namespace identify
