#pragma once

#include <cstddef>
#include <vector>

#include "identify/chain/chain_fit.hpp"
#include "identify/chain/linearised_chain.hpp"

namespace identify {

/// A way to explain the samples, and how well it does.
struct FittedChain {
  ChainFit fit;
  ChainNoise noise;
};

/// A larger move is a mistake, and none of the effects.
inline constexpr double kMostMove_mm = 0.5;

/// What may have happened once while sweeps ran: something was moved and stayed there, or one
/// stroke is unlike the others, since something gave way while it ran.
struct Incident {
  enum class Kind { move, stray };
  Kind kind = Kind::stray;
  std::size_t unit = 0;  ///< the stray one; or that before which, or during which, was the move
  double part = 0;       ///< of a move: of that unit's time, so much was over
  double mm = 0;         ///< its size, as `moved_mm` or `stray_mm`
  ChainEffects effects;  ///< it, and what is beside it of the others
  Chain chain;           ///< that explains the samples so
  double deviance = 0;
};

/// What the likelihood says of incidents beside less of the other effects: large enough, each of
/// these explains an incident, too.
class IncidentSearch {
 public:
  /// `from`: a fit that knows of no incident. `effects`: the sizes of the others, without one.
  /// `shape`: which of them there may be. It lives no longer than these.
  IncidentSearch(ChainNodes& nodes, const FittedChain& from, ChainEffects effects,
                 ChainEffects shape);

  /// Units that are no strays yet as ones, each of its likeliest size: those that explain about as
  /// much as what has the deviance `here` does, or more; and of them, not much less than the best.
  [[nodiscard]] std::vector<Incident> strays(double here);
  /// The same of moves at the moments between units; where there are many units, at some, and at
  /// all beside the likeliest.
  [[nodiscard]] std::vector<Incident> moves(double here);
  /// The likeliest of a move's moment and some within the units before and after it.
  [[nodiscard]] Incident at_its_moment(const Incident& move);

 private:
  /// Of this size it cannot be told from noise.
  [[nodiscard]] double least_mm(Incident::Kind kind) const {
    return kind == Incident::Kind::move ? smallest_mm_ : 4 * smallest_mm_;
  }
  [[nodiscard]] Incident sized(Incident incident, LinearisedChain& with) const;
  [[nodiscard]] Incident move(std::size_t unit, double part);
  [[nodiscard]] LinearisedChain linearised(const Incident& incident);
  [[nodiscard]] std::vector<Incident> fitted(std::vector<Incident> near, double here);

  ChainNodes& nodes_;
  const FittedChain& from_;
  ChainEffects effects_;
  ChainEffects shape_;
  double smallest_mm_;
};

/// What a stroke's place is uncertain by, by noise alone.
[[nodiscard]] double smallest_mm(const FittedChain& fitted, const ChainNodes& nodes);

}  // namespace identify
