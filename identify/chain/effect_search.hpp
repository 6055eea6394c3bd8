#pragma once

#include <optional>
#include <vector>

#include "identify/chain/chain_fit.hpp"

namespace identify {

/// A way to explain the samples, and how well it does.
struct FittedChain {
  ChainFit fit;
  ChainNoise noise;
};

/// Finds what is left beyond the samples' noise, and the fits that know of it.
class EffectSearch {
 public:
  /// `effects` are those that fits allow for: what is found becomes part of them. `sag_rad`: as
  /// Campaign's. The search lives no longer than these.
  EffectSearch(ChainNodes& nodes, ChainEffects& effects, const std::vector<double>& sag_rad)
      : nodes_(nodes), effects_(effects), sag_rad_(sag_rad) {}

  /// All effects, in the shape that is likeliest.
  void find_all(FittedChain& best);
  /// The sizes of the effects that the shape has.
  void size(FittedChain& best, const ChainEffects& shape);

 private:
  /// Whether the data tell of any of these effects.
  bool shows_any(const FittedChain& fitted, const ChainEffects& effects);
  /// Whether the data tell that a device that wanders does so in slow waves, or warms up.
  bool may_sway(const FittedChain& best, const ChainEffects& shape);
  /// How large a move is likeliest, where one at some moment makes the deviance less by so much,
  /// beside less of these effects or none: the nodes know the moment, then.
  std::optional<double> likeliest_move_mm(const FittedChain& fitted, const ChainEffects& effects,
                                          ChainEffects shape, double by);
  /// Looks for strokes that are unlike the others, since something moved while they ran: beside
  /// them the others may have less of all effects.
  void find_strays(FittedChain& best, const FittedChain& first, ChainEffects& shape);
  /// What one stroke may have for itself, and by how much less the deviance is then.
  struct Stray {
    std::size_t unit = 0;
    double mm = 0;
    double gain = 0;
  };
  /// A few, the likeliest first.
  std::vector<Stray> likeliest_strays(const FittedChain& best, const FittedChain& first,
                                      const ChainEffects& shape);
  /// One a unit.
  std::vector<Stray> gains_of_strays(const FittedChain& fitted, const ChainEffects& shape);
  /// What a stroke's place is uncertain by, by noise alone.
  [[nodiscard]] double smallest_mm(const FittedChain& fitted) const;
  [[nodiscard]] double deviance_of(const FittedChain& fitted);
  /// What another shape's effects come to, sized from a fit.
  struct Tried {
    FittedChain fitted;
    ChainEffects effects;
    std::vector<ChainObservation> observations;
    double deviance = 0;  ///< infinite where a move is too large to be one
  };
  [[nodiscard]] Tried tried(FittedChain from, const ChainEffects& shape);
  /// It takes the place of what there was.
  void take(FittedChain& best, Tried other);
  /// The same where the deviance is less by so much. Whether it is.
  bool take_if_likelier(FittedChain& best, FittedChain from, const ChainEffects& shape, double by);
  void size_twice(FittedChain& best, ChainEffects shape);

  ChainNodes& nodes_;
  ChainEffects& effects_;
  const std::vector<double>& sag_rad_;
};

/// How far the targets are from the axes at most; from those that are known.
[[nodiscard]] double reach_mm(const Chain& chain, const std::vector<bool>& known);

}  // namespace identify
