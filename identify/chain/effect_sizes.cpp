#include "identify/chain/effect_sizes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <vector>

namespace identify {
namespace {

using Size = double ChainEffects::*;
constexpr std::size_t kCount = 6;
constexpr std::array<Size, kCount> kSizes{&ChainEffects::home_rad,  &ChainEffects::drift_mm,
                                          &ChainEffects::figure_mm, &ChainEffects::offset_rad,
                                          &ChainEffects::told_rad,  &ChainEffects::sag_rad};
constexpr std::size_t kFigure = 2, kSag = 5;
/// Whether the size of this effect is asked for.
bool is_open(const ChainEffects& shape, std::size_t effect) {
  return shape.*kSizes[effect] > 0 && !(effect == kSag && shape.sag_told);
}
/// Arcs depart from circles by no more than this share of the arm's reach: thirty times what any
/// arm showed. With more, an axis may be anywhere, its arc being any curve, and takes the blame for
/// angles that contradict each other.
constexpr double kMostFigure = 1e-2;
/// Nor do joints give way by more, rad.
constexpr double kMostSag = 1e-2;
/// SizeSteps of each effect's size: nothing, then up by this factor.
using SizeSteps = std::array<int, kCount>;

/// The likelihood over the grid of sizes, computed where it is asked for.
class SizeGrid {
 public:
  SizeGrid(LinearisedChain& chain, const ChainEffects& shape, double smallest_mm, double reach_mm)
      : chain_(chain), shape_(shape) {
    // In units of each effect in which they move the target alike.
    const double turn = smallest_mm / reach_mm;
    unit_ = {turn, smallest_mm, smallest_mm, turn, turn, turn};
    last_.fill(last_step(reach_mm / smallest_mm));
    last_[kFigure] = last_step(kMostFigure * reach_mm / smallest_mm);
    last_[kSag] = last_step(kMostSag * reach_mm / smallest_mm);
  }

  static constexpr double kFactor = 4;
  static int last_step(double largest) {
    const double range = std::log(largest) / std::log(kFactor);
    return 1 + static_cast<int>(std::ceil(std::clamp(range, 1.0, 40.0)));
  }

  [[nodiscard]] double size(std::size_t effect, int step) const {
    return step == 0 ? 0 : unit_[effect] * std::pow(kFactor, step - 1);
  }
  [[nodiscard]] int last(std::size_t effect) const { return last_[effect]; }
  double deviance(const SizeSteps& steps) {
    const auto known = known_.find(steps);
    if (known != known_.end()) return known->second;
    std::vector<int> sags = {0};
    if (is_open(shape_, kSag))
      for (int step = 1; step <= last_[kSag]; ++step) sags.push_back(step);
    std::vector<double> sizes;
    for (const int step : sags)
      sizes.push_back(is_open(shape_, kSag) ? size(kSag, step) : shape_.sag_rad);
    const auto found = chain_.deviances(effects(steps), sizes);
    SizeSteps here = steps;
    for (std::size_t k = 0; k < sags.size(); ++k) {
      here[kSag] = sags[k];
      known_[here] = finite(found[k]);
    }
    return known_.at(steps);
  }
  /// Shifts each effect's sizes so that the least deviance near these steps is at them: where the
  /// data tell a size well, the nearest on a grid that knows nothing of them is wrong by half a
  /// step.
  void centre(const SizeSteps& steps) {
    double least = deviance(steps);
    for (double by = std::sqrt(kFactor); by > kFine; by = std::sqrt(by))
      for (std::size_t k = 0; k < kCount; ++k)
        for (const double times : {by, 1 / by}) {
          if (!is_open(shape_, k) || steps[k] == 0) continue;
          unit_[k] *= times;
          const double here = finite(chain_.deviance(effects(steps)));
          if (here < least)
            least = here;
          else
            unit_[k] /= times;
        }
    known_.clear();
  }
  template <class Visit>
  void visit_next_to(const SizeSteps& steps, const Visit& visit) {
    for (std::size_t k = 0; k < kCount; ++k)
      for (const int by : {-1, 1}) {
        SizeSteps next = steps;
        next[k] += by;
        if (is_open(shape_, k) && next[k] >= 0 && next[k] <= last_[k]) visit(next);
      }
  }
  SizeSteps lowest_from(SizeSteps steps) {
    for (bool better = true; better;) {
      SizeSteps best = steps;
      visit_next_to(steps, [&](const SizeSteps& next) {
        if (deviance(next) < deviance(best)) best = next;
      });
      better = best != steps;
      steps = best;
    }
    return steps;
  }

 private:
  static constexpr double kFine = 1.1;
  [[nodiscard]] ChainEffects effects(const SizeSteps& steps) const {
    ChainEffects effects = shape_;
    for (std::size_t k = 0; k < kCount; ++k)
      if (is_open(shape_, k)) effects.*kSizes[k] = size(k, steps[k]);
    return effects;
  }
  static double finite(double deviance) { return std::isfinite(deviance) ? deviance : 1e300; }

  LinearisedChain& chain_;
  const ChainEffects& shape_;
  std::array<double, kCount> unit_{};
  std::array<int, kCount> last_{};
  std::map<SizeSteps, double> known_;
};

/// Whether the data limit the size of this effect: far beyond all that was seen, each number that
/// tells of it takes log(size^2) from the likelihood. With two or fewer the mean size has no limit:
/// a campaign of one stroke says nothing of other strokes.
bool is_limited(LinearisedChain& chain, const ChainEffects& shape, double smallest_mm,
                double reach_mm, std::size_t effect) {
  if (!is_open(shape, effect)) return true;
  SizeGrid grid(chain, shape, smallest_mm, reach_mm);
  SizeSteps before{}, most{};
  before[effect] = grid.last(effect) - 1;
  most[effect] = grid.last(effect);
  constexpr double kNumbers = 2.5;
  return grid.deviance(most) - grid.deviance(before) > 2 * kNumbers * std::log(SizeGrid::kFactor);
}

/// What the likelihood says of all combinations of sizes.
struct WeighedSizes {
  double least = 0;                           ///< deviance
  double evidence = 0;                        ///< sum of the weights, that of the least is one
  std::array<double, kCount> mean_squares{};  ///< of each effect
};

WeighedSizes weighed(LinearisedChain& chain, const ChainEffects& shape, double smallest_mm,
                     double reach_mm) {
  ChainEffects limited = shape;
  for (std::size_t k = 0; k < kCount; ++k)
    if (!is_limited(chain, shape, smallest_mm, reach_mm, k)) limited.*kSizes[k] = 0;
  SizeGrid grid(chain, limited, smallest_mm, reach_mm);
  // From nothing, and from each effect alone.
  std::vector<SizeSteps> open;
  for (std::size_t one = 0; one <= kCount; ++one) {
    if (one < kCount && !is_open(limited, one)) continue;
    SizeSteps start{};
    if (one < kCount) start[one] = std::min(4, grid.last(one));
    open.push_back(grid.lowest_from(start));
  }
  const auto lower = [&](const SizeSteps& a, const SizeSteps& b) {
    return grid.deviance(a) < grid.deviance(b);
  };
  grid.centre(*std::min_element(open.begin(), open.end(), lower));
  WeighedSizes found;
  found.least = grid.deviance(*std::min_element(open.begin(), open.end(), lower));
  // All around that is not out of the question.
  constexpr double kOut = 10;
  // Beforehand, no effect counts as much as so many sizes of it. Less, and white noise alone would
  // widen every interval; more, and what hardly shows would be passed over.
  constexpr double kNone = 50;
  std::set<SizeSteps> seen;
  while (!open.empty()) {
    const SizeSteps here = open.back();
    open.pop_back();
    if (!seen.insert(here).second) continue;
    double weight = std::exp((found.least - grid.deviance(here)) / 2);
    for (std::size_t k = 0; k < kCount; ++k)
      if (here[k] == 0 && is_open(limited, k)) weight *= kNone;
    found.evidence += weight;
    for (std::size_t k = 0; k < kCount; ++k)
      found.mean_squares[k] += weight * grid.size(k, here[k]) * grid.size(k, here[k]);
    grid.visit_next_to(here, [&](const SizeSteps& next) {
      if (grid.deviance(next) < found.least + kOut) open.push_back(next);
    });
  }
  for (double& squares : found.mean_squares) squares /= found.evidence;
  return found;
}

/// How figures may fall with the order, and how likely that is beforehand. The steeper, the more
/// there may be of what circles take up without a trace.
struct Fall {
  double power, chance;
};
constexpr std::array<Fall, 2> kFalls{{{2, 0.6}, {3, 0.4}}};

}  // namespace

ChainEffects effect_sizes(LinearisedChain& chain, const ChainEffects& shape, double smallest_mm,
                          double reach_mm) {
  std::vector<WeighedSizes> found;
  double least = std::numeric_limits<double>::infinity();
  for (const Fall& fall : kFalls) {
    ChainEffects falling = shape;
    falling.figure_power = fall.power;
    found.push_back(weighed(chain, falling, smallest_mm, reach_mm));
    least = std::min(least, found.back().least);
    if (!is_open(shape, kFigure)) break;
  }
  // The mixture's variances of the first order, and of one that is seen.
  constexpr double kSeen = 4;
  double sum = 0, figure_seen = 0;
  std::array<double, kCount> squares{};
  for (std::size_t f = 0; f < found.size(); ++f) {
    const double weight =
        kFalls[f].chance * found[f].evidence * std::exp((least - found[f].least) / 2);
    sum += weight;
    for (std::size_t k = 0; k < kCount; ++k) squares[k] += weight * found[f].mean_squares[k];
    figure_seen += weight * found[f].mean_squares[kFigure] * std::pow(kSeen, -2 * kFalls[f].power);
  }
  ChainEffects effects = shape;
  for (std::size_t k = 0; k < kCount; ++k)
    if (is_open(shape, k)) effects.*kSizes[k] = std::sqrt(squares[k] / sum);
  if (figure_seen > 0)
    effects.figure_power = std::log(squares[kFigure] / figure_seen) / (2 * std::log(kSeen));
  return effects;
}

}  // namespace identify
