#include "identify/chain/chain_effects.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace identify {

using Eigen::Index;
using Eigen::VectorXd;

EffectColumns::EffectColumns(const ChainEffects& shape, const ChainNodes& nodes)
    : targets(nodes.targets) {
  const auto turns = static_cast<Index>(nodes.known.size());
  if (shape.home_rad > 0 || shape.drift_mm > 0 || shape.print_mm > 0) own = turns + 6;
  if (shape.figure_mm > 0) figure = 2 * kFigureOrders;
  if (shape.told_rad > 0) told = kFigureOrders;
  if (shape.offset_rad > 0) home = turns;
}

EffectVariances variances_of(const ChainEffects& effects, const ChainNodes& nodes,
                             const EffectColumns& columns) {
  EffectVariances variances;
  const auto turns = static_cast<Index>(nodes.known.size());
  double begin_s = std::numeric_limits<double>::infinity(), end_s = -begin_s;
  for (const StrokeMoments& stroke : nodes.strokes) {
    begin_s = std::min(begin_s, stroke.begin_s);
    end_s = std::max(end_s, stroke.end_s);
  }
  for (const auto& unit : nodes.units) {
    const StrokeMoments& stroke = nodes.strokes[unit.front()];
    VectorXd own(columns.own);
    if (columns.own > 0) {
      own.head(turns).setConstant(effects.home_rad * effects.home_rad);
      own.tail<6>().setConstant(effects.drift_mm * effects.drift_mm);
      // A random walk's variance over a time D is D/6 a unit of time, that of its slope over a
      // stroke of length T 3/10 T (of half the change from end to end).
      const double share = std::min(1.0, 6 * (stroke.end_s - stroke.begin_s) / (end_s - begin_s));
      own.tail<3>() *= share > 0 ? 0.3 * share : 0.3;
    }
    // Of n steps of the last decimal that a coordinate passed, what rounding takes away averages
    // out but for one n-th.
    if (effects.print_mm > 0) {
      const auto steps = (stroke.extent_mm / effects.print_mm).array();
      own.segment<3>(turns).array() +=
          effects.print_mm * effects.print_mm / 12 / (1 + steps.square());
    }
    variances.own.push_back(std::move(own));
  }
  VectorXd shared(columns.shared());
  if (columns.figure > 0)
    for (Index at = 0; at < columns.figure * static_cast<Index>(columns.targets); ++at) {
      const auto order = static_cast<double>(at % kFigureOrders + 1);
      const double sigma = effects.figure_mm / (order * order);
      shared(at) = sigma * sigma;
    }
  shared.tail(columns.told).setConstant(effects.told_rad * effects.told_rad);
  variances.shared.assign(nodes.home_of.size(), shared);
  variances.home.assign(nodes.homes.size(),
                        VectorXd::Constant(columns.home, effects.offset_rad * effects.offset_rad));
  variances.home.front().setZero();
  return variances;
}

}  // namespace identify
