#include "identify/sweeps/stroke_moments.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "identify/sweeps/sample.hpp"
#include "identify/sweeps/stroke_curve.hpp"
#include "identify/sweeps/stroke_samples.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Longer strokes are cut: twelve nodes hold what a model says over so much.
constexpr double kSection_rad = kPi / 4;

/// Of so many samples. More nodes than this and some get weights near zero, and means far from all
/// samples: equally spaced ones determine polynomials of twice their number's root (Rakhmanov 2007,
/// Annals of Mathematics 165).
std::size_t node_count(double samples) {
  return static_cast<std::size_t>(
      std::clamp(2 * std::sqrt(samples), 2.0, static_cast<double>(Lagrange::kMostNodes)));
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
void add_moments(StrokeMoments& stroke, const StrokeSamples& seen, const Sections& sections) {
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

/// A node with hardly any weight has a mean far from all samples.
bool same_spread(const StrokeMoments& like, const StrokeMoments& stroke) {
  constexpr double kLeastShare = 0.3;
  for (std::size_t k = 0; k < stroke.nodes.size(); ++k)
    if (!(stroke.nodes[k].sums(0, 0) * like.weight >
          kLeastShare * like.nodes[k].sums(0, 0) * stroke.weight))
      return false;
  return true;
}

/// Whether it runs where the other one does, but for the noise, and its locked joints stand there.
/// What is of second order in so little is a hundredth of a micrometre.
bool same_place(const StrokeMoments& like, const StrokeMoments& stroke) {
  constexpr double kSame_mm = 0.1;
  constexpr double kSame_rad = 0.01 * kDegree;
  constexpr double kChance = 5;  // standard deviations
  const double variance = stroke.blocks.variance_mm2.back();
  const Index locked = stroke.content.orientation ? 7 : 4;
  VectorXd wobble = VectorXd::Zero(static_cast<Index>(stroke.content.joints));
  for (std::size_t k = 0; k < stroke.nodes.size(); ++k) {
    const auto& here = stroke.nodes[k].sums;
    const auto& there = like.nodes[k].sums;
    const double chance = kChance * std::sqrt(variance * (1 / here(0, 0) + 1 / there(0, 0)));
    for (const Index across : {1, 2})
      if (std::abs(here(across, 0) / here(0, 0) - there(across, 0) / there(0, 0)) >
          kSame_mm + chance)
        return false;
    wobble += here.col(0).segment(locked, wobble.size());
  }
  return wobble.size() == 0 || wobble.cwiseAbs().maxCoeff() <= kSame_rad * stroke.weight;
}

}  // namespace

std::optional<StrokeMoments> moments_of(const Sweep& sweep, const StrokeContent& content) {
  StrokeSamples seen = samples_in(sweep);
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
  StrokeSamples seen = samples_in(sweep);
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
  if (!same_spread(like, stroke) || !same_place(like, stroke)) return std::nullopt;
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
