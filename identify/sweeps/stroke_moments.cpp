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
    off.col(static_cast<Index>(i)) = stroke.across(seen.samples[i]->position_mm);
  const VectorXd near = weights_of(off, kNear);
  for (const double weight : near) seen.beside.push_back(weight == 0);
}

/// The angles about the circle, unwrapped along the motion.
std::vector<double> angles_about(const StrokeMoments& stroke, const Seen& seen) {
  std::vector<double> about(seen.samples.size());
  double last = 0;
  for (std::size_t i = 0; i < about.size(); ++i) {
    const double angle = stroke.angle_about(seen.samples[i]->position_mm);
    if (!seen.beside[i]) last += stroke.step(last, angle);
    about[i] = last;
  }
  return about;
}

/// Which way x goes about the circle, where it is zero, and whether what is told follows the arc.
void set_turns(StrokeMoments& stroke, Seen& seen) {
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

/// The reference orientation: the mean of what each sample says, from the middle one.
void set_orientation(StrokeMoments& stroke, const Seen& seen) {
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

void set_errors(const StrokeMoments& stroke, Seen& seen) {
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
  constexpr int kMostRounds = 4;
  constexpr double kSettled = 1e-3;
  for (int round = 0; round < kMostRounds; ++round) {
    const VectorXd before = seen.weights;
    left = curve.left(errors, before);
    weigh(left);
    if ((seen.weights - before).cwiseAbs().maxCoeff() < kSettled) break;
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

/// The sections of the turn, each with its nodes.
class Sections {
 public:
  Sections(double from, double to, std::size_t sections, std::size_t nodes)
      : from_(from), range_(to - from), nodes_(nodes) {
    const auto at = [&](std::size_t k) {
      return from + range_ * static_cast<double>(k) / static_cast<double>(sections);
    };
    for (std::size_t s = 0; s < sections; ++s) lagrange_.emplace_back(at(s), at(s + 1), nodes);
  }
  [[nodiscard]] std::vector<double> turns() const {
    std::vector<double> turns;
    for (const Lagrange& section : lagrange_)
      for (std::size_t k = 0; k < nodes_; ++k) turns.push_back(section.node(k));
    return turns;
  }
  /// Calls `see` with the place of each node of this turn's section and its polynomial's value.
  template <class See>
  void visit(double turn, const See& see) const {
    const double place =
        range_ > 0 ? (turn - from_) / range_ * static_cast<double>(lagrange_.size()) : 0;
    const auto section =
        std::min(lagrange_.size() - 1, static_cast<std::size_t>(std::max(0.0, place)));
    Lagrange::Values values;
    lagrange_[section].at(turn, values);
    for (std::size_t k = 0; k < nodes_; ++k) see(section * nodes_ + k, values[k]);
  }

 private:
  double from_, range_;
  std::size_t nodes_;
  std::vector<Lagrange> lagrange_;
};

Sections sections_of(const StrokeMoments& stroke, std::size_t samples) {
  const double range = stroke.to_rad - stroke.from_rad;
  // Along a line all that a model says is linear in the turn.
  const auto sections = static_cast<std::size_t>(
      stroke.linear ? 1.0 : std::max(1.0, std::ceil(range / kSection_rad)));
  return {stroke.from_rad, stroke.to_rad, sections,
          node_count(static_cast<double>(samples) / static_cast<double>(sections))};
}

/// Sets the nodes' sums, of all products or of z alone.
void add_moments(StrokeMoments& stroke, const Seen& seen, const Sections& sections) {
  const Index with_errors = stroke.content.orientation ? 6 : 3;
  const auto wobbles = static_cast<Index>(stroke.content.joints);
  const Index size = 1 + with_errors + wobbles;
  stroke.nodes.clear();
  for (const double turn : sections.turns())
    stroke.nodes.push_back({turn, MatrixXd::Zero(size, stroke.squares ? size : 1)});
  VectorXd z(size);
  z(0) = 1;
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
    sections.visit(seen.turns[i], [&](std::size_t k, double value) {
      auto& sums = stroke.nodes[k].sums;
      if (stroke.squares)
        sums.selfadjointView<Eigen::Lower>().rankUpdate(z, weight * value);
      else
        sums.col(0).noalias() += (weight * value) * z;
    });
  }
  if (!stroke.squares) return;
  for (StrokeMoments::Node& node : stroke.nodes)
    node.sums.triangularView<Eigen::StrictlyUpper>() = node.sums.transpose();
}

/// What the samples say before any reference is known.
Seen seen_in(const Sweep& sweep) {
  Seen seen;
  for (const Sample& sample : *sweep.samples)
    if (sample.has_position && sample.position_mm.allFinite()) seen.samples.push_back(&sample);
  return seen;
}

/// The least and greatest turn; all others lie between them.
void set_range(StrokeMoments& stroke, Seen& seen) {
  stroke.from_rad = std::numeric_limits<double>::infinity();
  stroke.to_rad = -stroke.from_rad;
  for (std::size_t i = 0; i < seen.turns.size(); ++i) {
    if (seen.beside[i]) continue;
    stroke.from_rad = std::min(stroke.from_rad, seen.turns[i]);
    stroke.to_rad = std::max(stroke.to_rad, seen.turns[i]);
  }
  for (double& turn : seen.turns) turn = std::clamp(turn, stroke.from_rad, stroke.to_rad);
}

void count_weights(StrokeMoments& stroke, const Seen& seen) {
  stroke.samples = seen.samples.size();
  stroke.weight = seen.weights.sum();
  stroke.outliers = static_cast<std::size_t>((seen.weights.array() < 0.5).count());
}

/// x and what is told by a reference that is given.
void set_turns_by(const StrokeMoments& like, Seen& seen) {
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

}  // namespace

std::optional<StrokeMoments> moments_of(const Sweep& sweep, const StrokeContent& content) {
  Seen seen = seen_in(sweep);
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
  stroke.extent_mm = points.rowwise().maxCoeff() - points.rowwise().minCoeff();
  for (std::size_t k = 0; k < content.joints; ++k) {
    const double first = seen.samples.front()->angles_rad[k];
    double sum = 0;
    for (const Sample* sample : seen.samples) {
      sum += sample->angles_rad[k] - first;
      stroke.dithers[k] = stroke.dithers[k] || sample->angles_rad[k] != first;
    }
    stroke.locked_rad[k] = first + sum / static_cast<double>(seen.samples.size());
  }
  set_aside(stroke, seen);
  set_turns(stroke, seen);
  set_range(stroke, seen);
  set_orientation(stroke, seen);
  set_errors(stroke, seen);
  set_weights(stroke, seen);
  count_weights(stroke, seen);
  add_moments(stroke, seen, sections_of(stroke, seen.samples.size()));
  return stroke;
}

std::optional<StrokeMoments> moments_like(const StrokeMoments& like, const Sweep& sweep) {
  Seen seen = seen_in(sweep);
  if (seen.samples.size() < like.nodes.size()) return std::nullopt;
  StrokeMoments stroke = like;
  stroke.squares = false;
  stroke.strokes = 1;
  set_aside(stroke, seen);
  set_turns_by(like, seen);
  set_range(stroke, seen);
  set_errors(stroke, seen);
  set_weights(stroke, seen);
  // Polynomials grow fast beyond the section that they are made for.
  const double beyond = 0.002 * (like.to_rad - like.from_rad);
  for (std::size_t i = 0; i < seen.turns.size(); ++i)
    if (seen.turns[i] < like.from_rad - beyond || seen.turns[i] > like.to_rad + beyond)
      seen.weights(static_cast<Index>(i)) = 0;
  stroke.from_rad = like.from_rad;
  stroke.to_rad = like.to_rad;
  count_weights(stroke, seen);
  add_moments(stroke, seen, sections_of(like, like.samples));
  // A node with hardly any weight has a mean far from all samples.
  constexpr double kLeastShare = 0.3;
  for (std::size_t k = 0; k < stroke.nodes.size(); ++k)
    if (!(stroke.nodes[k].sums(0, 0) * like.weight >
          kLeastShare * like.nodes[k].sums(0, 0) * stroke.weight))
      return std::nullopt;
  return stroke;
}

void add(StrokeMoments& sum, const StrokeMoments& one) {
  for (std::size_t k = 0; k < sum.nodes.size(); ++k) sum.nodes[k].sums += one.nodes[k].sums;
  sum.strokes += one.strokes;
  sum.samples += one.samples;
  sum.outliers += one.outliers;
  sum.weight += one.weight;
}

}  // namespace identify
