#include "identify/chain/chain_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "identify/chain/chain_nodes.hpp"
#include "identify/geometry/angle.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Position, orientation, locked angles, and the angle of each joint.
constexpr int kMostComponents = 3 + static_cast<int>(kMostJoints);
using Components = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostComponents, 1>;
using Products =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostComponents, kMostComponents>;
enum : Index { kPosition, kOrientation, kLocked, kSwept };

/// What the stroke's own smooth curve leaves of the nodes' residuals.
template <int Size>
std::vector<typename NodeScatter<Size>::Vector> without_curve(
    const StrokeMoments& stroke, const std::vector<NodeScatter<Size>>& scatter) {
  const auto orders = static_cast<Index>(stroke.blocks.curve_orders);
  const auto count = static_cast<Index>(scatter.size());
  Eigen::MatrixXd basis(orders, count);
  Eigen::MatrixXd errors(count, Size);
  Eigen::VectorXd samples(count);
  std::vector<Eigen::Matrix<double, Size, Size>> turned;
  for (Index n = 0; n < count; ++n) {
    const auto at = static_cast<std::size_t>(n);
    const double turn = stroke.nodes[at].turn_rad;
    const double width = stroke.to_rad - stroke.from_rad;
    const double x = width > 0 ? (2 * turn - stroke.from_rad - stroke.to_rad) / width : 0;
    double before = 1, value = x;
    for (Index m = 0; m < orders; ++m) {
      basis(m, n) = m == 0 ? 1 : value;
      if (m > 0) before = std::exchange(value, 2 * x * value - before);
    }
    turned.push_back(turned_to<Size>(stroke.directions(turn)));
    errors.row(n) = (turned.back() * scatter[at].residual.error).transpose();
    samples(n) = scatter[at].samples;
  }
  const Eigen::MatrixXd weighted = basis * samples.asDiagonal();
  Eigen::MatrixXd normal = weighted * basis.transpose();
  normal.diagonal() *= 1 + 1e-12;
  const Eigen::MatrixXd found = normal.ldlt().solve(weighted * errors);
  errors -= basis.transpose() * found;
  std::vector<typename NodeScatter<Size>::Vector> left;
  for (Index n = 0; n < count; ++n)
    left.push_back(turned[static_cast<std::size_t>(n)].transpose() * errors.row(n).transpose());
  return left;
}

/// Variances beside that of the position have to pass their floor by so many standard deviations:
/// else they would only weigh samples by chance.
constexpr double kChance = 3;

/// M v = u with v not below `floor`: what wants to fall below stays there.
Components bounded_solution(Products m, Components u, const Components& floor) {
  const Index count = u.size();
  std::vector<bool> held(static_cast<std::size_t>(count), false);
  Components v = floor;
  for (Index round = 0; round <= count; ++round) {
    std::vector<Index> open;
    for (Index c = 0; c < count; ++c)
      if (!held[static_cast<std::size_t>(c)] && m(c, c) > 0) open.push_back(c);
    const auto size = static_cast<Index>(open.size());
    if (size == 0) break;
    Products scaled(size, size);
    Components right(size);
    for (Index r = 0; r < size; ++r) {
      const Index at = open[static_cast<std::size_t>(r)];
      const double scale = std::sqrt(m(at, at));
      right(r) = u(at);
      for (Index c = 0; c < count; ++c)
        if (held[static_cast<std::size_t>(c)]) right(r) -= m(at, c) * floor(c);
      right(r) /= scale;
      for (Index c = 0; c < size; ++c) {
        const Index other = open[static_cast<std::size_t>(c)];
        scaled(r, c) = m(at, other) / (scale * std::sqrt(m(other, other)));
      }
      scaled(r, r) += 1e-9;  // components that cannot be told apart share
    }
    const Eigen::LDLT<Products> solver(scaled);
    const Components found = solver.solve(right);
    const Products inverse = solver.solve(Products::Identity(size, size));
    Index worst = -1;
    double least = 0;
    for (Index r = 0; r < size; ++r) {
      const Index at = open[static_cast<std::size_t>(r)];
      v(at) = found(r) / std::sqrt(m(at, at));
      // Estimates of variances scatter by 2 M^-1.
      const double above = (v(at) - floor(at)) * std::sqrt(m(at, at) / (2 * inverse(r, r)));
      const double margin = above - (at == kPosition ? 0 : kChance);
      if (margin < least) {
        least = margin;
        worst = at;
      }
    }
    if (worst < 0) break;
    held[static_cast<std::size_t>(worst)] = true;
    v(worst) = floor(worst);
  }
  return v.cwiseMax(floor);
}

template <int Size>
ChainNoise estimate(const Chain& chain, const ChainNodes& nodes, const ChainNoise& noise,
                    const ChainNoise& lowest) {
  using Square = typename ChainResidual<Size>::Square;
  const auto count = kSwept + static_cast<Index>(chain.axes.size());
  Products m = Products::Zero(count, count);
  Components u = Components::Zero(count);
  visit_nodes<Size>(
      chain, nodes, noise, [&](std::size_t s, const std::vector<NodeScatter<Size>>& scatter) {
        const StrokeMoments& stroke = nodes.strokes[s];
        const auto left = without_curve<Size>(stroke, scatter);
        // The curve has taken up part of the scatter: as many samples as it has orders.
        const auto orders = static_cast<double>(stroke.blocks.curve_orders);
        const double part_left = std::max(1.0, stroke.weight - orders) / stroke.weight;
        const std::size_t joint = stroke.content.joint;
        const bool angle_used = std::isfinite(noise.swept_rad[joint]);
        for (std::size_t n = 0; n < scatter.size(); ++n) {
          const NodeScatter<Size>& at = scatter[n];
          const Square squares = at.within + at.samples * left[n] * left[n].transpose();
          // W B of each component that these samples speak of.
          const Square& weight = at.residual.weight;
          std::array<std::pair<Index, Square>, 4> parts;
          for (auto& part : parts) part.second.setZero();
          std::size_t used = 0;
          const auto part = [&](Index component) -> Square& {
            parts[used].first = component;
            return parts[used++].second;
          };
          part(kPosition).template leftCols<3>() = weight.template leftCols<3>();
          if constexpr (Size == 6)
            part(kOrientation).template rightCols<3>() = weight.template rightCols<3>();
          part(kLocked).noalias() = weight * at.by_locked;
          if (angle_used)
            part(kSwept + static_cast<Index>(joint)).noalias() =
                (weight * at.residual.by_swept) * at.residual.by_swept.transpose();
          const Square weighted = weight * squares;
          for (std::size_t a = 0; a < used; ++a) {
            // sum r^T W B W r = tr(W B W sum r r^T).
            u(parts[a].first) +=
                parts[a].second.cwiseProduct(weighted.transpose()).sum() / part_left;
            for (std::size_t b = 0; b <= a; ++b) {
              const double product =
                  at.samples * parts[a].second.cwiseProduct(parts[b].second.transpose()).sum();
              m(parts[a].first, parts[b].first) += product;
              if (a != b) m(parts[b].first, parts[a].first) += product;
            }
          }
        }
      });

  Components floor = Components::Zero(count);
  const auto square = [](double value) { return value * value; };
  floor(kPosition) = square(lowest.position_mm);
  floor(kOrientation) = square(lowest.orientation_rad);
  floor(kLocked) = square(lowest.locked_rad);
  for (std::size_t j = 0; j < chain.axes.size(); ++j)
    floor(kSwept + static_cast<Index>(j)) = square(lowest.swept_rad[j]);
  const Components variances = bounded_solution(m, u, floor);
  ChainNoise found = noise;
  found.position_mm = std::sqrt(variances(kPosition));
  found.orientation_rad = std::sqrt(variances(kOrientation));
  found.locked_rad = std::sqrt(variances(kLocked));
  for (std::size_t j = 0; j < chain.axes.size(); ++j)
    if (std::isfinite(noise.swept_rad[j]))
      found.swept_rad[j] = std::sqrt(variances(kSwept + static_cast<Index>(j)));
  return found;
}

template <int Size>
double root_mean_square(const Chain& chain, const ChainNodes& nodes, const ChainNoise& noise) {
  double sum = 0;
  double freedom = -static_cast<double>(
      ChainParameters{chain.axes.size(), chain.targets_mm.size()}.count(Size == 6));
  visit_nodes<Size>(
      chain, nodes, noise, [&](std::size_t s, const std::vector<NodeScatter<Size>>& scatter) {
        for (const NodeScatter<Size>& at : scatter)
          sum +=
              at.residual.weight.cwiseProduct(at.within).sum() + at.samples * at.residual.squared();
        const bool angle_used = std::isfinite(noise.swept_rad[nodes.strokes[s].content.joint]);
        freedom += nodes.strokes[s].weight * (angle_used ? Size : Size - 1);
      });
  return std::sqrt(std::max(0.0, sum) / std::max(1.0, freedom));
}

}  // namespace

ChainNoise estimate_noise(const Chain& chain, const ChainNodes& nodes, const ChainNoise& noise,
                          const ChainNoise& floor, bool with_orientation) {
  return with_orientation ? estimate<6>(chain, nodes, noise, floor)
                          : estimate<3>(chain, nodes, noise, floor);
}

double misfit(const Chain& chain, const ChainNodes& nodes, const ChainNoise& noise,
              bool with_orientation) {
  return with_orientation ? root_mean_square<6>(chain, nodes, noise)
                          : root_mean_square<3>(chain, nodes, noise);
}

}  // namespace identify
