#include "identify/sweeps/stroke_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/median.hpp"
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
/// The angles about the circle, unwrapped along the motion.
std::vector<double> angles_about(const StrokeMoments& stroke, const StrokeSamples& seen) {
  std::vector<double> about(seen.samples.size());
  double last = 0;
  for (std::size_t i = 0; i < about.size(); ++i) {
    const double angle = stroke.angle_about(seen.samples[i]->position_mm);
    if (!seen.beside[i]) last += stroke.step(last, angle);
    about[i] = last;
  }
  return about;
}
/// Orders of the stroke's own curve.
Index curve_orders(Index samples) {
  return std::clamp<Index>(samples / 8, 1, 8);
}
}  // namespace

StrokeSamples samples_in(const Sweep& sweep) {
  StrokeSamples seen;
  for (const Sample& sample : *sweep.samples)
    if (sample.has_position && sample.position_mm.allFinite()) seen.samples.push_back(&sample);
  return seen;
}
void set_aside(const StrokeMoments& stroke, StrokeSamples& seen) {
  constexpr double kNear = 10;
  MatrixXd off(2, static_cast<Index>(seen.samples.size()));
  for (std::size_t i = 0; i < seen.samples.size(); ++i)
    off.col(static_cast<Index>(i)) = stroke.across(seen.samples[i]->position_mm);
  const VectorXd near = weights_of(off, kNear);
  for (const double weight : near) seen.beside.push_back(weight == 0);
}
void set_turns(StrokeMoments& stroke, StrokeSamples& seen) {
  const std::size_t count = seen.samples.size();
  std::vector<double> about = angles_about(stroke, seen);
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
void set_turns_by(const StrokeMoments& like, StrokeSamples& seen) {
  seen.turns = angles_about(like, seen);
  for (double& turn : seen.turns) turn = like.zero_rad + like.sense * turn;
  if (!like.linear) {
    const auto [least, greatest] = std::minmax_element(seen.turns.begin(), seen.turns.end());
    const double off = (*least + *greatest - like.from_rad - like.to_rad) / 2;
    const double whole = off - std::remainder(off, 2 * kPi);
    for (double& turn : seen.turns) turn -= whole;
  }
  if (!like.told) return;
  for (const Sample* sample : seen.samples)
    seen.told.push_back(sample->angles_rad[like.content.joint]);
  if (!like.about) seen.turns = seen.told;
}
void set_range(StrokeMoments& stroke, StrokeSamples& seen) {
  stroke.from_rad = std::numeric_limits<double>::infinity();
  stroke.to_rad = -stroke.from_rad;
  for (std::size_t i = 0; i < seen.turns.size(); ++i) {
    if (seen.beside[i]) continue;
    stroke.from_rad = std::min(stroke.from_rad, seen.turns[i]);
    stroke.to_rad = std::max(stroke.to_rad, seen.turns[i]);
  }
  for (double& turn : seen.turns) turn = std::clamp(turn, stroke.from_rad, stroke.to_rad);
}
void set_orientation(StrokeMoments& stroke, const StrokeSamples& seen) {
  if (!stroke.content.orientation) return;
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
void set_errors(const StrokeMoments& stroke, StrokeSamples& seen) {
  const auto count = static_cast<Index>(seen.samples.size());
  seen.errors.setZero(6, count);
  for (Index i = 0; i < count; ++i) {
    const Sample& sample = *seen.samples[static_cast<std::size_t>(i)];
    const double turn = seen.turns[static_cast<std::size_t>(i)];
    seen.errors.col(i).head<2>() = stroke.across(sample.position_mm);
    if (!stroke.about)
      seen.errors(2, i) = stroke.departure(sample.position_mm, turn).z();
    else if (stroke.told)
      seen.errors(2, i) =
          stroke.circle.radius_mm * stroke.sense * (turn - seen.told[static_cast<std::size_t>(i)]);
    if (stroke.content.orientation)
      seen.errors.col(i).tail<3>() = stroke.departure(
          orientation(sample), turn, stroke.told ? seen.told[static_cast<std::size_t>(i)] : turn);
  }
}
void set_weights(StrokeMoments& stroke, StrokeSamples& seen) {
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
  constexpr int kMostRounds = 4;
  constexpr double kSettled = 1e-3;
  for (int round = 0; round < kMostRounds; ++round) {
    const VectorXd before = seen.weights;
    left = curve.left(errors, before);
    weigh(left);
    if ((seen.weights - before).cwiseAbs().maxCoeff() < kSettled) break;
  }
  stroke.blocks.variance_mm2.clear();
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
  stroke.rounding = rounding_of(seen, stroke.content.orientation, curve);
  stroke.rounding.scatter.head<3>() = stroke.blocks.variance_mm2.front();
}
void count_weights(StrokeMoments& stroke, const StrokeSamples& seen) {
  stroke.samples = seen.samples.size();
  stroke.weight = seen.weights.sum();
  stroke.outliers = static_cast<std::size_t>((seen.weights.array() < 0.5).count());
}
}  // namespace identify
