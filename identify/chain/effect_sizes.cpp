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

constexpr std::size_t kCount = 8, kFigure = 2, kSag = 5, kTrend = 6;
/// Steps of each effect's size: nothing, then up by a factor.
using SizeSteps = std::array<int, kCount>;

/// Arcs depart from circles by no more than this share of the arm's reach: thirty times what any
/// arm showed. With more, an axis may be anywhere, its arc being any curve, and takes the blame for
/// angles that contradict each other.
constexpr double kMostFigure = 1e-2;
/// Nor do joints give way by more, rad.
constexpr double kMostSag = 1e-2;

/// What is to be sized, and in which units.
struct SizeTask {
  LinearisedChain* chain;
  ChainEffects shape;
  double smallest_mm;
  double reach_mm;
  std::size_t law;  ///< of figures, all of which are of one

  [[nodiscard]] double& in(ChainEffects& effects, std::size_t effect) const {
    const std::array<double*, kCount> sizes{
        &effects.home_rad, &effects.drift_mm, &effects.figures_mm[law], &effects.offset_rad,
        &effects.told_rad, &effects.sag_rad,  &effects.steady_mm,       &effects.creep_rad};
    return *sizes[effect];
  }
  /// Whether the size of this effect is asked for.
  [[nodiscard]] bool is_open(std::size_t effect) const {
    ChainEffects asked = shape;
    return in(asked, effect) > 0 && !(effect == kSag && shape.sag_told);
  }
};

/// The likelihood over the grid of sizes, computed where it is asked for.
class SizeGrid {
 public:
  explicit SizeGrid(const SizeTask& task) : task_(task), none_(task.shape) {
    none_.figures_mm = {};
    for (std::size_t k = 0; k < kCount; ++k) {
      open_[k] = task.is_open(k);
      if (open_[k]) task.in(none_, k) = 0;
    }
    // In units of each effect in which they move the target alike.
    const double turn = task.smallest_mm / task.reach_mm;
    unit_ = {turn, task.smallest_mm, task.smallest_mm, turn, turn, turn, task.smallest_mm, turn};
    last_.fill(last_step(1 / turn));
    last_[kFigure] = last_step(kMostFigure / turn);
    last_[kSag] = last_step(kMostSag / turn);
  }

  static constexpr double kFactor = 4;
  static constexpr double kBeyond = 1e300;  ///< in place of a deviance that cannot be judged
  [[nodiscard]] double size(std::size_t effect, int step) const {
    return step == 0 ? 0 : unit_[effect] * std::pow(kFactor, step - 1);
  }
  [[nodiscard]] int last(std::size_t effect) const { return last_[effect]; }
  [[nodiscard]] bool is_open(std::size_t effect) const { return open_[effect]; }

  double deviance(const SizeSteps& steps) {
    const auto known = known_.find(steps);
    if (known != known_.end()) return known->second;
    SizeSteps others = steps;
    others[kSag] = others[kTrend] = 0;
    const ChainEffects here = effects(steps);
    auto left = left_.find(others);
    if (left == left_.end()) left = left_.emplace(others, task_.chain->left_by(here)).first;
    return known_[steps] = finite(task_.chain->deviance(left->second, here));
  }
  /// Shifts each effect's sizes so that the least deviance near these steps is at them: where the
  /// data tell a size well, the nearest on a grid that knows nothing of them is wrong by half a
  /// step.
  void centre(const SizeSteps& steps) {
    double least = deviance(steps);
    double by = kFactor;
    while ((by = std::sqrt(by)) > kFine)
      for (std::size_t k = 0; k < kCount; ++k)
        for (const double times : {by, 1 / by}) {
          if (!open_[k] || steps[k] == 0) continue;
          unit_[k] *= times;
          const double here = finite(task_.chain->deviance(effects(steps)));
          if (here < least)
            least = here;
          else
            unit_[k] /= times;
        }
    known_.clear();
    left_.clear();
  }
  /// By how much the mean square of this effect is larger than the grid has it, which is too coarse
  /// for one that the data tell well: along its sizes alone, around these steps.
  double widening(const SizeSteps& steps, std::size_t effect) {
    constexpr int kParts = 6;  // of a step of the grid
    if (!open_[effect] || steps[effect] == 0) return 1;
    ChainEffects here = effects(steps);
    double& size = task_.in(here, effect);
    const double centre = size;
    const double least = deviance(steps);
    double fine = 0, fine_squares = 0, coarse = 0, coarse_squares = 0;
    for (int part = -2 * kParts; part <= 2 * kParts; ++part) {
      const double times = std::pow(kFactor, static_cast<double>(part) / kParts);
      size = times * centre;
      if (size > this->size(effect, last_[effect])) break;
      const double weight = std::exp((least - finite(task_.chain->deviance(here))) / 2);
      fine += weight;
      fine_squares += weight * times * times;
      if (part % kParts != 0) continue;
      coarse += weight;
      coarse_squares += weight * times * times;
    }
    return std::max(1.0, fine_squares / fine / (coarse_squares / coarse));
  }
  template <class Visit>
  void visit_next_to(const SizeSteps& steps, const Visit& visit) {
    for (std::size_t k = 0; k < kCount; ++k)
      for (const int by : {-1, 1}) {
        SizeSteps next = steps;
        next[k] += by;
        if (open_[k] && next[k] >= 0 && next[k] <= last_[k]) visit(next);
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
  static int last_step(double largest) {
    const double range = std::log(largest) / std::log(kFactor);
    return 1 + static_cast<int>(std::ceil(std::clamp(range, 1.0, 40.0)));
  }
  [[nodiscard]] ChainEffects effects(const SizeSteps& steps) const {
    ChainEffects effects = none_;
    for (std::size_t k = 0; k < kCount; ++k)
      if (open_[k]) task_.in(effects, k) = size(k, steps[k]);
    return effects;
  }
  static double finite(double deviance) { return std::isfinite(deviance) ? deviance : kBeyond; }

  SizeTask task_;
  ChainEffects none_;  ///< of those that are open
  std::array<bool, kCount> open_{};
  std::array<double, kCount> unit_{};
  std::array<int, kCount> last_{};
  std::map<SizeSteps, double> known_;
  std::map<SizeSteps, LinearisedChain::Left> left_;
};

/// Whether the data limit the size of this effect: far beyond all that was seen, at the largest
/// that can be judged, each number that tells of it takes log(size^2) from the likelihood. With two
/// or fewer the mean size has no limit: a campaign of one stroke says nothing of other strokes.
bool is_limited(const SizeTask& task, std::size_t effect, const SizeSteps& beside = {}) {
  if (!task.is_open(effect)) return true;
  SizeGrid grid(task);
  SizeSteps most = beside;
  most[effect] = grid.last(effect);
  while (most[effect] > 1 && !(grid.deviance(most) < SizeGrid::kBeyond)) --most[effect];
  SizeSteps before = most;
  --before[effect];
  constexpr double kNumbers = 2.5;
  return grid.deviance(most) - grid.deviance(before) > 2 * kNumbers * std::log(SizeGrid::kFactor);
}

/// The likeliest sizes where there is no such effect.
SizeSteps likeliest_without(SizeTask task, std::size_t effect) {
  task.in(task.shape, effect) = 0;
  return SizeGrid(task).lowest_from({});
}

/// So much above the least, a deviance is out of the question.
constexpr double kOut = 10;

/// Whether the data tell that there is this effect: the deviance falls by so much.
bool is_shown(const SizeTask& task, std::size_t effect, double by) {
  if (!task.is_open(effect)) return false;
  SizeGrid grid(task);
  const double none = grid.deviance({});
  for (SizeSteps steps{}; ++steps[effect] <= grid.last(effect);)
    if (grid.deviance(steps) < none - by) return true;
  return false;
}

/// What the likelihood says of all combinations of sizes.
struct WeighedSizes {
  double evidence = 0;                        ///< sum of the weights, that of the least is one
  std::array<double, kCount> mean_squares{};  ///< of each effect
};

/// Finds the likelihood's maximum, and then what is likely around it.
class SizeSearch {
 public:
  explicit SizeSearch(const SizeTask& task) : grid_(task) {
    // From nothing, and from each effect alone.
    for (std::size_t one = 0; one <= kCount; ++one) {
      if (one < kCount && !grid_.is_open(one)) continue;
      SizeSteps start{};
      if (one < kCount) start[one] = std::min(4, grid_.last(one));
      open_.push_back(grid_.lowest_from(start));
    }
    std::sort(open_.begin(), open_.end(), [&](const SizeSteps& a, const SizeSteps& b) {
      return grid_.deviance(a) > grid_.deviance(b);
    });
    grid_.centre(open_.back());
    least_ = grid_.deviance(open_.back());
    for (std::size_t k = 0; k < kCount; ++k) widening_[k] = grid_.widening(open_.back(), k);
  }
  [[nodiscard]] double least() const { return least_; }

  WeighedSizes weighed() {
    // All around that is not out of the question.
    std::set<SizeSteps> seen;
    while (!open_.empty()) {
      const SizeSteps here = open_.back();
      open_.pop_back();
      if (grid_.deviance(here) > least_ + kOut || !seen.insert(here).second) continue;
      least_ = std::min(least_, grid_.deviance(here));
      grid_.visit_next_to(here, [&](const SizeSteps& next) { open_.push_back(next); });
    }
    // Beforehand, no effect counts as much as so many sizes of it. Less, and white noise alone
    // would widen every interval; more, and what hardly shows would be passed over.
    constexpr double kNone = 50;
    WeighedSizes found;
    for (const SizeSteps& here : seen) {
      double weight = std::exp((least_ - grid_.deviance(here)) / 2);
      for (std::size_t k = 0; k < kCount; ++k)
        if (here[k] == 0 && grid_.is_open(k)) weight *= kNone;
      found.evidence += weight;
      for (std::size_t k = 0; k < kCount; ++k)
        found.mean_squares[k] += weight * grid_.size(k, here[k]) * grid_.size(k, here[k]);
    }
    for (std::size_t k = 0; k < kCount; ++k) found.mean_squares[k] *= widening_[k] / found.evidence;
    return found;
  }

 private:
  SizeGrid grid_;
  std::vector<SizeSteps> open_;  ///< the lowest is the last
  double least_ = 0;
  std::array<double, kCount> widening_{};
};

/// How likely each law of figures is beforehand. The steeper it falls, the more there may be of
/// what circles take up without a trace: waves have to be seen.
constexpr std::array<double, kFigureLaws.size()> kChances{0.6, 0.38, 0.02};

}  // namespace

ChainEffects effect_sizes(LinearisedChain& chain, const ChainEffects& shape, double smallest_mm,
                          double reach_mm) {
  const SizeTask asked{&chain, shape, smallest_mm, reach_mm, 0};
  SizeTask limited = asked;
  for (std::size_t k = 0; k < kCount; ++k)
    // Beside noise alone what gives way takes a device's drift for its own.
    if (k != kFigure && !is_limited(asked, k) && !is_limited(asked, k, likeliest_without(asked, k)))
      asked.in(limited.shape, k) = 0;
  // What cannot be seen beside noise alone cannot be seen beside more.
  constexpr double kSeen = 4;
  if (!is_shown(asked, kTrend, kSeen)) asked.in(limited.shape, kTrend) = 0;
  struct ByLaw {
    SizeTask task;
    SizeSearch search;
    double chance;
  };
  std::vector<ByLaw> laws;
  double most = -std::numeric_limits<double>::infinity();  // logarithm of what is likeliest
  const auto likely = [](const ByLaw& law) {
    return std::log(law.chance) - law.search.least() / 2;
  };
  for (std::size_t law = 0; law < kFigureLaws.size(); ++law) {
    if (law > 0 && !asked.is_open(kFigure)) break;
    SizeTask task = limited;
    task.law = law;
    // Arms limit figures where the data do not. Only where these show none, none is assumed.
    if (!is_limited(task, kFigure) && !is_shown(task, kFigure, kOut))
      task.in(task.shape, kFigure) = 0;
    laws.push_back({task, SizeSearch(task), kChances[law]});
    most = std::max(most, likely(laws.back()));
  }
  // What would not be heard is not asked.
  constexpr double kHeard = 0.04;
  std::erase_if(laws, [&](const ByLaw& law) { return likely(law) < most + std::log(kHeard); });
  std::vector<WeighedSizes> found;
  for (ByLaw& law : laws) {
    found.push_back(law.search.weighed());
    most = std::max(most, likely(law));
  }
  double sum = 0;
  for (std::size_t l = 0; l < laws.size(); ++l) {
    found[l].evidence *= std::exp(likely(laws[l]) - most);
    sum += found[l].evidence;
  }
  ChainEffects effects = shape;
  effects.figures_mm = {};
  for (std::size_t k = 0; k < kCount; ++k) {
    if (!asked.is_open(k)) continue;
    double squares = 0;
    for (std::size_t l = 0; l < laws.size(); ++l) {
      const double share = found[l].evidence / sum * found[l].mean_squares[k];
      squares += share;
      if (k == kFigure) laws[l].task.in(effects, k) = std::sqrt(share);
    }
    if (k != kFigure) asked.in(effects, k) = std::sqrt(squares);
  }
  return effects;
}

}  // namespace identify
