#pragma once

#include <vector>

#include "identify/chain/incident_search.hpp"

namespace identify {

/// Finds what is left beyond the samples' noise, and the fits that know of it.
class EffectSearch {
 public:
  /// `effects` are those that fits allow for: what is found becomes part of them. `sag_rad`: as
  /// Campaign's. The search lives no longer than these.
  EffectSearch(ChainNodes& nodes, ChainEffects& effects, const std::vector<double>& sag_rad)
      : nodes_(nodes), effects_(effects), sag_rad_(sag_rad) {}

  /// All effects, in the shape that is likeliest. Returns what explains the samples about as well.
  [[nodiscard]] std::vector<Incident> find_all(FittedChain& best);
  /// The sizes of the effects that the shape has.
  void size(FittedChain& best, const ChainEffects& shape);

 private:
  /// Whether the data tell of any of these effects.
  bool shows_any(const FittedChain& fitted, const ChainEffects& effects);
  /// Whether the data tell that a device that wanders does so in slow waves, or warms up.
  bool may_sway(const FittedChain& best, const ChainEffects& shape);
  /// Through what joints stand off home by the same, the likelihood tells. What is the same there
  /// and back may have been taken for the arc's figure.
  void find_lasting(FittedChain& best, const FittedChain& first, ChainEffects& shape);
  /// Where the data tell of locked joints that go on while another one sweeps, allows for that.
  void find_creep(FittedChain& best, const FittedChain& first, ChainEffects& shape);
  /// Whether the data tell of any of that.
  bool may_creep(const FittedChain& best, const ChainEffects& shape);
  /// Where the data tell of one more joint that goes on while another one sweeps, and of that
  /// rather than of the others, allows for it. Whether they do.
  bool find_along(FittedChain& best, const FittedChain& first, ChainEffects& shape,
                  const std::vector<Incident>& others);
  /// Takes strokes that are unlike the others for such, as long as nothing that was moved explains
  /// more. Returns all that explains about as much as what there is then.
  std::vector<Incident> find_strays(FittedChain& best, const FittedChain& first,
                                    ChainEffects& shape);
  /// Where a search for incidents begins.
  struct IncidentsFrom {
    FittedChain first;
    ChainEffects effects;
    ChainEffects shape;
  };
  /// Takes the move where it explains more.
  void find_move(FittedChain& best, IncidentsFrom from, const Incident& move);
  [[nodiscard]] double deviance_of(const FittedChain& fitted) {
    return deviance_of(fitted, effects_);
  }
  [[nodiscard]] double deviance_of(const FittedChain& fitted, const ChainEffects& effects);
  /// A fit whose effects are those of another shape, of their likeliest sizes.
  struct Tried {
    FittedChain fitted;
    ChainEffects effects;
    std::vector<ChainObservation> observations;
    double deviance = 0;  ///< infinite where a move is too large to be one
  };
  [[nodiscard]] Tried tried(FittedChain from, const ChainEffects& shape);
  /// Makes `other` the best fit and its effects the search's.
  void take(FittedChain& best, Tried other);
  /// The same where the deviance is less by so much. Whether it is.
  bool take_if_likelier(FittedChain& best, FittedChain from, const ChainEffects& shape, double by);
  void size_twice(FittedChain& best, ChainEffects shape);

  ChainNodes& nodes_;
  ChainEffects& effects_;
  const std::vector<double>& sag_rad_;
  /// By so much less the deviance has to be of what happened once.
  double happened_ = 0;
};

}  // namespace identify
