#include "identify/chain_effects.hpp"

namespace identify {

using Eigen::Index;
using Eigen::VectorXd;

EffectVariances variances_of(const ChainEffects& effects, const ChainNodes& nodes) {
  EffectVariances variances;
  const auto turns = static_cast<Index>(nodes.known.size());
  VectorXd own(turns + 3);
  own.head(turns).setConstant(effects.home_rad * effects.home_rad);
  own.tail<3>().setConstant(effects.drift_mm * effects.drift_mm);
  variances.own.assign(nodes.strokes.size(), own);
  // Of n steps of the last decimal that a coordinate passed, what rounding takes away averages out
  // but for one n-th.
  if (effects.print_mm > 0)
    for (std::size_t s = 0; s < nodes.strokes.size(); ++s) {
      const auto steps = (nodes.strokes[s].extent_mm / effects.print_mm).array();
      variances.own[s].tail<3>().array() +=
          effects.print_mm * effects.print_mm / 12 / (1 + steps.square());
    }
  VectorXd shared(2 * kFigureOrders);
  for (Index order = 0; order < kFigureOrders; ++order) {
    const auto falls = static_cast<double>((order + 1) * (order + 1));
    const double sigma = effects.figure_mm / falls;
    shared(order) = shared(kFigureOrders + order) = sigma * sigma;
  }
  variances.shared.assign(nodes.home_of.size(), shared);
  variances.home.assign(nodes.homes.size(),
                        VectorXd::Constant(turns, effects.offset_rad * effects.offset_rad));
  variances.home.front().setZero();
  return variances;
}

}  // namespace identify
