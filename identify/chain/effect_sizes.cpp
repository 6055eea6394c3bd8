#include "identify/chain/effect_sizes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <vector>

namespace identify {
namespace {

using Size = double ChainEffects::*;
constexpr std::size_t kCount = 5;
constexpr std::array<Size, kCount> kSizes{&ChainEffects::home_rad, &ChainEffects::drift_mm,
                                          &ChainEffects::figure_mm, &ChainEffects::offset_rad,
                                          &ChainEffects::told_rad};
/// SizeSteps of each effect's size: nothing, then up by this factor.
using SizeSteps = std::array<int, kCount>;

/// The likelihood over the grid of sizes, computed where it is asked for.
class SizeGrid {
 public:
  SizeGrid(const LinearisedChain& chain, const ChainEffects& shape, double smallest_mm,
           double reach_mm)
      : chain_(chain), shape_(shape) {
    // In units of each effect in which they move the target alike.
    const double turn = smallest_mm / reach_mm;
    unit_ = {turn, smallest_mm, smallest_mm, turn, turn};
    const double range = std::log(reach_mm / smallest_mm) / std::log(kFactor);
    last_ = 1 + static_cast<int>(std::ceil(std::clamp(range, 1.0, 40.0)));
  }

  static constexpr double kFactor = 4;

  [[nodiscard]] double size(std::size_t effect, int step) const {
    return step == 0 ? 0 : unit_[effect] * std::pow(kFactor, step - 1);
  }
  [[nodiscard]] int last() const { return last_; }
  double deviance(const SizeSteps& steps) {
    const auto [found, fresh] = known_.try_emplace(steps, 0.0);
    if (fresh) {
      ChainEffects effects = shape_;
      for (std::size_t k = 0; k < kCount; ++k) effects.*kSizes[k] = size(k, steps[k]);
      const double deviance = chain_.deviance(effects);
      found->second = std::isfinite(deviance) ? deviance : 1e300;
    }
    return found->second;
  }
  template <class Visit>
  void visit_next_to(const SizeSteps& steps, const Visit& visit) {
    for (std::size_t k = 0; k < kCount; ++k)
      for (const int by : {-1, 1}) {
        SizeSteps next = steps;
        next[k] += by;
        if (shape_.*kSizes[k] > 0 && next[k] >= 0 && next[k] <= last_) visit(next);
      }
  }
  SizeSteps lowest_from(SizeSteps steps) {
    for (bool better = true; better;) {
      better = false;
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
  const LinearisedChain& chain_;
  const ChainEffects& shape_;
  std::array<double, kCount> unit_;
  int last_;
  std::map<SizeSteps, double> known_;
};

/// Whether the data limit the size of this effect: far beyond all that was seen, each number that
/// tells of it takes log(size^2) from the likelihood. With two or fewer the mean size has no limit:
/// a campaign of one stroke says nothing of other strokes.
bool is_limited(const LinearisedChain& chain, const ChainEffects& shape, double smallest_mm,
                double reach_mm, std::size_t effect) {
  if (!(shape.*kSizes[effect] > 0)) return true;
  SizeGrid grid(chain, shape, smallest_mm, reach_mm);
  SizeSteps before{}, most{};
  before[effect] = grid.last() - 1;
  most[effect] = grid.last();
  constexpr double kNumbers = 2.5;
  return grid.deviance(most) - grid.deviance(before) > 2 * kNumbers * std::log(SizeGrid::kFactor);
}

}  // namespace

ChainEffects effect_sizes(const LinearisedChain& chain, const ChainEffects& shape,
                          double smallest_mm, double reach_mm) {
  ChainEffects limited = shape;
  for (std::size_t k = 0; k < kCount; ++k)
    if (!is_limited(chain, shape, smallest_mm, reach_mm, k)) limited.*kSizes[k] = 0;
  SizeGrid grid(chain, limited, smallest_mm, reach_mm);
  double least = std::numeric_limits<double>::infinity();
  // From nothing, and from each effect alone.
  std::vector<SizeSteps> open;
  for (std::size_t one = 0; one <= kCount; ++one) {
    if (one < kCount && !(limited.*kSizes[one] > 0)) continue;
    SizeSteps start{};
    if (one < kCount) start[one] = std::min(4, grid.last());
    open.push_back(grid.lowest_from(start));
    least = std::min(least, grid.deviance(open.back()));
  }
  // All around that is not out of the question.
  constexpr double kOut = 10;
  // Beforehand an effect is as likely none as it has any of so many sizes. Less, and white noise
  // alone would widen every interval; more, and what hardly shows would be passed over.
  constexpr double kNone = 30;
  std::set<SizeSteps> seen;
  double sum = 0;
  std::array<double, kCount> squares{};
  while (!open.empty()) {
    const SizeSteps here = open.back();
    open.pop_back();
    if (!seen.insert(here).second) continue;
    double weight = std::exp((least - grid.deviance(here)) / 2);
    for (std::size_t k = 0; k < kCount; ++k)
      if (here[k] == 0 && limited.*kSizes[k] > 0) weight *= kNone;
    sum += weight;
    for (std::size_t k = 0; k < kCount; ++k)
      squares[k] += weight * grid.size(k, here[k]) * grid.size(k, here[k]);
    grid.visit_next_to(here, [&](const SizeSteps& next) {
      if (grid.deviance(next) < least + kOut) open.push_back(next);
    });
  }
  ChainEffects effects = limited;
  for (std::size_t k = 0; k < kCount; ++k) effects.*kSizes[k] = std::sqrt(squares[k] / sum);
  return effects;
}

}  // namespace identify
