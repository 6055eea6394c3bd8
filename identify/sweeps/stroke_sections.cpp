#include "identify/sweeps/stroke_sections.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "identify/geometry/angle.hpp"

namespace identify {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSection_rad = kPi / 4;

/// Of so many samples. More nodes than this and some get weights near zero, and means far from all
/// samples: equally spaced ones determine polynomials of twice their number's root (Rakhmanov 2007,
/// Annals of Mathematics 165).
Index node_count(double samples) {
  return static_cast<Index>(
      std::clamp(2 * std::sqrt(samples), 2.0, static_cast<double>(StrokeSections::kMostNodes)));
}

StrokeSections::Section section_of(ArrayXd places) {
  const Index nodes = places.size();
  SampleRows chebyshev = SampleRows::Ones(nodes, nodes);
  set_chebyshev(chebyshev, places);
  MatrixXd lagrange = chebyshev.matrix().transpose().partialPivLu().inverse();
  return {std::move(places), std::move(lagrange)};
}

/// Of weights at places: eigenvalues of the Jacobi matrix of their orthogonal polynomials. These
/// come one from the other, and are made orthogonal to all before twice: by Stieltjes' three terms
/// alone they would not stay so (Gautschi 2004, Orthogonal Polynomials, sec. 2.2.3.2). Not more
/// than there are places that lie apart.
ArrayXd gauss_nodes(const ArrayXd& places, const ArrayXd& weights, Index most) {
  constexpr double kApart = 0.02;
  MatrixXd polynomials(places.size(), most);  // times the weights' roots, of length one
  VectorXd next = weights.sqrt().matrix();
  Index nodes = 0;
  while (nodes < most) {
    for (int twice = 0; twice < 2; ++twice)
      next -= polynomials.leftCols(nodes) * (polynomials.leftCols(nodes).transpose() * next);
    const double length = next.norm();
    if (nodes > 0 && !(length > kApart)) break;
    polynomials.col(nodes) = next / length;
    next = places.matrix().cwiseProduct(polynomials.col(nodes));
    ++nodes;
  }
  const auto all = polynomials.leftCols(nodes);
  const MatrixXd jacobi = all.transpose() * places.matrix().asDiagonal() * all;
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(jacobi, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace

Index places_of(const ArrayXd& turns, double from, double to) {
  constexpr std::size_t kParts = 64;
  std::array<bool, kParts> seen{};
  for (const double turn : turns) {
    const double place = to > from ? (turn - from) / (to - from) : 0;
    seen[static_cast<std::size_t>(std::lround(std::clamp(place, 0.0, 1.0) * (kParts - 1)))] = true;
  }
  return std::count(seen.begin(), seen.end(), true);
}

StrokeSections::StrokeSections(const StrokeMoments& stroke) : from_(stroke.from_rad) {
  const double range = stroke.to_rad - stroke.from_rad;
  // Along a line all that a model says is linear in the turn.
  // A section may be a little longer, so that noise does not decide whether a sweep of 90 degrees
  // has two or three.
  constexpr double kSlack = 0.05;
  std::size_t count = 1;
  if (!stroke.linear)
    count = static_cast<std::size_t>(std::max(1.0, std::ceil(range / kSection_rad - kSlack)));
  sections_.resize(count);
  length_ = range / static_cast<double>(count);
}

StrokeSections::StrokeSections(const StrokeMoments& stroke, Index samples)
    : StrokeSections(stroke) {
  const Index nodes =
      node_count(static_cast<double>(samples) / static_cast<double>(sections_.size()));
  ArrayXd places(nodes);
  for (Index k = 0; k < nodes; ++k)
    places(k) = std::cos(static_cast<double>(2 * k + 1) * kPi / static_cast<double>(2 * nodes));
  std::fill(sections_.begin(), sections_.end(), section_of(std::move(places)));
}

StrokeSections::StrokeSections(const StrokeMoments& stroke, const ArrayXd& turns,
                               const ArrayXd& weights, Index most)
    : StrokeSections(stroke) {
  // In parts of a section what the samples weigh, and where they are on average.
  constexpr Index kParts = 200;
  struct Weighed {
    ArrayXd weights = ArrayXd::Zero(kParts), sums = ArrayXd::Zero(kParts);
    double samples = 0;
  };
  std::vector<Weighed> weighed(sections_.size());
  for (Index i = 0; i < turns.size(); ++i) {
    if (!(weights(i) > 0)) continue;
    const std::size_t s = at(turns(i));
    const double place = std::clamp(place_in(s, turns(i)), -1.0, 1.0);
    const auto part = static_cast<Index>(std::lround((place + 1) / 2 * (kParts - 1)));
    weighed[s].weights(part) += weights(i);
    weighed[s].sums(part) += weights(i) * place;
    ++weighed[s].samples;
  }
  for (std::size_t s = 0; s < sections_.size(); ++s) {
    const auto& [of_parts, sums, samples] = weighed[s];
    if (samples == 0) continue;
    const ArrayXd middles = (of_parts > 0).select(sums / of_parts.max(1e-300), 0);
    const Index filled = (of_parts > 0).count();
    sections_[s] =
        section_of(gauss_nodes(middles, of_parts, std::min({filled, node_count(samples), most})));
  }
}

StrokeSections StrokeSections::of(const StrokeMoments& stroke) {
  StrokeSections made(stroke);
  std::vector<std::vector<double>> places(made.sections_.size());
  for (const StrokeMoments::Node& node : stroke.nodes) {
    const std::size_t section = made.at(node.turn_rad);
    places[section].push_back(made.place_in(section, node.turn_rad));
  }
  for (std::size_t s = 0; s < places.size(); ++s)
    if (!places[s].empty())
      made.sections_[s] = section_of(
          Eigen::Map<const ArrayXd>(places[s].data(), static_cast<Index>(places[s].size())));
  return made;
}

std::size_t StrokeSections::at(double turn_rad) const {
  const double place = length_ > 0 ? (turn_rad - from_) / length_ : 0;
  return static_cast<std::size_t>(
      std::clamp(std::floor(place), 0.0, static_cast<double>(sections_.size() - 1)));
}

double StrokeSections::place_in(std::size_t section, double turn_rad) const {
  return length_ > 0 ? (turn_rad - turn(section, 0)) * (2 / length_) : 0;
}

ArrayXd StrokeSections::places(std::size_t section, const Eigen::Ref<const ArrayXd>& turns) const {
  if (!(length_ > 0)) return ArrayXd::Zero(turns.size());
  return (turns - turn(section, 0)) * (2 / length_);
}

bool StrokeSections::positive(const StrokeMoments& stroke) {
  return std::all_of(stroke.nodes.begin(), stroke.nodes.end(),
                     [](const StrokeMoments::Node& node) { return node.sums(0, 0) > 0; });
}

bool StrokeSections::suit(const StrokeMoments& stroke) const {
  constexpr double kLeastShare = 0.3;  // of what it were of evenly spread samples
  std::size_t node = 0;
  for (const Section& section : sections_) {
    // The mean of T_m over the section: 1 / (1 - m^2) for even m, else 0.
    VectorXd means = VectorXd::Zero(section.lagrange.rows());
    for (Index m = 0; m < means.size(); m += 2) means(m) = 1 / (1 - static_cast<double>(m * m));
    const VectorXd shares =
        section.lagrange.transpose() * means / static_cast<double>(sections_.size());
    for (Index k = 0; k < shares.size(); ++k)
      if (!(stroke.nodes[node++].sums(0, 0) > kLeastShare * shares(k) * stroke.weight))
        return false;
  }
  return true;
}

}  // namespace identify
