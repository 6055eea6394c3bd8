#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "identify/chain/chain_fit.hpp"
#include "identify/chain/linearised_chain.hpp"

namespace identify {

/// What single strokes are off by more is a mistake, and none of the effects.
inline constexpr double kMostStray_mm = 5;

/// What may have happened once while sweeps ran: something was moved and stayed there, or one
/// stroke is unlike the others, since something gave way while it ran.
struct Incident {
  enum class Kind { move, stray };
  Kind kind = Kind::stray;
  std::size_t unit = 0;    ///< the stray one; or that before which, or during which, was the move
  double part = 0;         ///< of a move: of that unit's time, so much was over
  double mm = 0;           ///< its size, as `moved_mm` or `stray_mm`
  ChainEffects effects{};  ///< it, and what is beside it of the others
  Eigen::MatrixXd covariance{};  ///< of the fit to it
  Chain chain;                   ///< that explains the samples so
  double deviance = 0;
  /// How likely it is beside the fit that was taken, where that is likelier; else one.
  double weight = 0;
  /// Its chain minus the one that was taken, in the first parameters, up to `zero_rad` (mm, rad).
  Eigen::VectorXd change{};
  /// What its covariance of these is more than the taken one's.
  Eigen::MatrixXd wider{};
};

/// Sets how incidents compare with what was taken, of this deviance, and leaves those out that it
/// makes unlikely.
void compare_with(std::vector<Incident>& others, const ChainFit& taken, double deviance);
/// What they would change, as a covariance beside the fit's, of as many parameters.
[[nodiscard]] Eigen::MatrixXd doubt_of(const std::vector<Incident>& others, Eigen::Index count);
/// Those that would change more than the fit's own uncertainties allow for.
[[nodiscard]] std::vector<ChainEstimate::OtherExplanation> explanations(
    std::vector<Incident> others, const ChainFit& fit, const ChainNodes& nodes);

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
  /// The same of moves between the units and in the middle of each; where there are many units, at
  /// some of these moments, and at all beside the likeliest.
  [[nodiscard]] std::vector<Incident> moves(double here);
  /// The likeliest of a move's moment and some within the units before and after it.
  [[nodiscard]] Incident at_its_moment(const Incident& move);

 private:
  /// Steps of what is tried. The least cannot be told from noise.
  struct Sizes {
    double least_mm = 0;
    double most_mm = 0;
    double factor = 1;
    [[nodiscard]] double at_mm(int step) const { return least_mm * std::pow(factor, step); }
  };
  [[nodiscard]] Sizes sizes_of(Incident::Kind kind) const;
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

/// The sweeps that the effects say are strays.
[[nodiscard]] std::vector<ChainEstimate::StraySweep> strays_of(const ChainEffects& effects,
                                                               const ChainNodes& nodes);

/// What a stroke's place is uncertain by, by noise alone.
[[nodiscard]] double smallest_mm(const FittedChain& fitted, const ChainNodes& nodes);

}  // namespace identify
