#include "identify/sweeps/stroke_moments.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "identify/sweeps/sample.hpp"
#include "identify/sweeps/stroke_curve.hpp"
#include "identify/sweeps/stroke_samples.hpp"
#include "identify/sweeps/stroke_sections.hpp"

namespace identify {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// z, one column a sample.
SampleRows whole(const StrokeMoments& stroke, const StrokeSamples& seen) {
  const Index with_errors = seen.errors.rows();
  const auto joints = static_cast<Index>(stroke.content.joints);
  SampleRows z(1 + with_errors + joints, seen.turns.size());
  z.row(0).setOnes();
  z.middleRows(1, with_errors) = seen.errors;
  for (Index i = 0; i < z.cols(); ++i) {
    const auto& told = seen.samples[static_cast<std::size_t>(i)]->angles_rad;
    for (Index k = 0; k < joints; ++k)
      z(1 + with_errors + k, i) =
          told[static_cast<std::size_t>(k)] - stroke.locked_rad[static_cast<std::size_t>(k)];
  }
  if (joints > 0) z.row(1 + with_errors + static_cast<Index>(stroke.content.joint)).setZero();
  return z;
}

/// Sets the nodes' sums, of all products or of z alone: with Chebyshev polynomials in place of the
/// nodes' own, which are sums of these, block by block.
void add_moments(StrokeMoments& stroke, const StrokeSamples& seen, const StrokeSections& sections) {
  constexpr Index kBlock = 64;
  const SampleRows z = whole(stroke, seen);
  const Index size = z.rows();
  SampleRows products(stroke.squares ? size * (size + 1) / 2 : size, kBlock);
  std::vector<MatrixXd> sums;
  Index orders = 0;
  for (const StrokeSections::Section& section : sections.sections()) {
    sums.push_back(MatrixXd::Zero(products.rows(), section.places.size()));
    orders = std::max(orders, section.places.size());
  }
  SampleRows polynomials(orders, kBlock);
  for (Index begin = 0, count = 0; begin < z.cols(); begin += count) {
    const std::size_t section = sections.at(seen.turns(begin));
    count = 1;
    while (count < kBlock && begin + count < z.cols() &&
           sections.at(seen.turns(begin + count)) == section)
      ++count;
    auto here = polynomials.topLeftCorner(sums[section].cols(), count);
    if (here.rows() == 0) continue;
    here.row(0) = seen.weights.segment(begin, count);
    set_chebyshev(here, sections.places(section, seen.turns.segment(begin, count)));
    const auto block = z.middleCols(begin, count);
    if (!stroke.squares) products.leftCols(count) = block;
    for (Index r = 0, product = 0; stroke.squares && r < size; ++r)
      for (Index c = 0; c <= r; ++c)
        products.row(product++).head(count) = block.row(r) * block.row(c);
    sums[section].noalias() += products.leftCols(count).matrix() * here.matrix().transpose();
  }
  stroke.nodes.clear();
  for (std::size_t s = 0; s < sums.size(); ++s) {
    const StrokeSections::Section& section = sections.sections()[s];
    const MatrixXd at_nodes = sums[s] * section.lagrange;
    for (Index k = 0; k < section.places.size(); ++k) {
      MatrixXd whole = at_nodes.col(k);
      if (stroke.squares) {
        whole.resize(size, size);
        for (Index r = 0, product = 0; r < size; ++r)
          for (Index c = 0; c <= r; ++c) whole(r, c) = whole(c, r) = at_nodes(product++, k);
      }
      stroke.nodes.push_back({sections.turn(s, section.places(k)), std::move(whole)});
    }
  }
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
  constexpr double kSamePlace_rad = 0.01 * kDegree;
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
  return wobble.size() == 0 || wobble.cwiseAbs().maxCoeff() <= kSamePlace_rad * stroke.weight;
}

}  // namespace

std::optional<StrokeMoments> moments_of(const Sweep& sweep, const StrokeContent& content) {
  StrokeSamples seen = samples_in(sweep);
  const std::size_t count = seen.samples.size();
  StrokeMoments stroke;
  stroke.content = content;
  stroke.linear = content.linear;
  const Vector3d middle =
      count == 0 ? Vector3d(Vector3d::Zero()) : seen.samples[count / 2]->position_mm;
  if (!set_reference(stroke, seen.positions_mm.matrix(), middle)) return std::nullopt;
  stroke.target = sweep.target;
  stroke.falling = sweep.direction < 0;
  stroke.begin_s = sweep.first().time_s;
  stroke.end_s = sweep.last().time_s;
  const auto& first = seen.samples.front()->angles_rad;
  for (const Sample* sample : seen.samples)
    for (std::size_t k = 0; k < content.joints; ++k) {
      stroke.locked_rad[k] += sample->angles_rad[k] - first[k];
      stroke.dithers[k] = stroke.dithers[k] || sample->angles_rad[k] != first[k];
    }
  for (std::size_t k = 0; k < content.joints; ++k)
    stroke.locked_rad[k] = first[k] + stroke.locked_rad[k] / static_cast<double>(count);
  set_across(stroke, seen);
  set_turns(stroke, seen);
  set_range(stroke, seen);
  stroke.begin_rad = seen.turns(0);
  stroke.end_rad = seen.turns(seen.turns.size() - 1);
  set_said(stroke, seen);
  set_orientation(stroke, seen);
  set_errors(stroke, seen);
  set_weights(stroke, seen);
  count_weights(stroke, seen);
  const StrokeSections even(stroke, seen.turns.size());
  add_moments(stroke, seen, even);
  if (even.suit(stroke)) return stroke;
  Index nodes = StrokeSections::kMostNodes;
  do add_moments(stroke, seen, StrokeSections(stroke, seen.turns, seen.weights, nodes));
  while (!StrokeSections::positive(stroke) && (nodes /= 2) > 0);
  return stroke;
}

std::optional<StrokeMoments> moments_like(const StrokeMoments& like, const Sweep& sweep) {
  StrokeSamples seen = samples_in(sweep);
  if (seen.samples.size() < like.nodes.size()) return std::nullopt;
  StrokeMoments stroke = like;
  stroke.squares = false;
  stroke.strokes = 1;
  set_across(stroke, seen);
  set_turns_by(like, seen);
  set_range(stroke, seen);
  set_said(stroke, seen);
  set_errors(stroke, seen);
  set_weights(stroke, seen);
  // Polynomials grow fast beyond the section that they are made for.
  const double beyond = 0.002 * (like.to_rad - like.from_rad);
  seen.weights = (seen.turns < like.from_rad - beyond || seen.turns > like.to_rad + beyond)
                     .select(0, seen.weights);
  stroke.from_rad = like.from_rad;
  stroke.to_rad = like.to_rad;
  count_weights(stroke, seen);
  add_moments(stroke, seen, StrokeSections::of(like));
  for (std::size_t k = 0; k < like.nodes.size(); ++k)
    stroke.nodes[k].turn_rad = like.nodes[k].turn_rad;  // to the last bit
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
