#include "identify/effect_sizes.hpp"

#include <array>
#include <cstdlib>
#include <cmath>
#include <limits>
#include <vector>

namespace identify {
namespace {

using Size = double ChainEffects::*;
constexpr std::size_t kCount = 4;
constexpr std::array<Size, kCount> kSizes{&ChainEffects::home_rad, &ChainEffects::drift_mm,
                                          &ChainEffects::figure_mm, &ChainEffects::offset_rad};
constexpr int kSteps = 16;  // powers of two

}  // namespace

ChainEffects effect_sizes(const LinearisedChain& chain, const ChainEffects& shape,
                          double smallest_mm, double reach_mm) {
  // In units of each effect in which they move the target alike.
  const double turn = smallest_mm / reach_mm;
  const std::array<double, kCount> unit{turn, smallest_mm, smallest_mm, turn};
  using Steps = std::array<int, kCount>;
  const auto size_at = [&](std::size_t effect, int step) {
    return step == 0 ? 0 : unit[effect] * std::exp2(step - 2);
  };
  const auto at = [&](const Steps& steps) {
    ChainEffects effects = shape;
    for (std::size_t k = 0; k < kCount; ++k) effects.*kSizes[k] = size_at(k, steps[k]);
    return effects;
  };
  const auto sought = [&](std::size_t k) { return shape.*kSizes[k] > 0; };
  double least = std::numeric_limits<double>::infinity();
  Steps best{};
  for (std::size_t one = 0; one <= kCount + 1; ++one) {
    // From nothing, from one of them alone, from all.
    Steps here{};
    for (std::size_t k = 0; k < kCount; ++k)
      if (sought(k) && (one == k + 1 || one == kCount + 1)) here[k] = one == k + 1 ? 6 : 4;
    double deviance = chain.deviance(at(here));
    for (bool better = true; better;) {
      better = false;
      for (std::size_t k = 0; k < kCount; ++k)
        for (const int step : {-1, 1})
          while (sought(k)) {
            auto next = here;
            next[k] += step;
            if (next[k] < 0 || next[k] > kSteps) break;
            const double there = chain.deviance(at(next));
            if (!(there < deviance)) break;
            deviance = there;
            here = next;
            better = true;
          }
    }
    if (deviance < least) {
      least = deviance;
      best = here;
    }
  }
  ChainEffects effects = at(best);
  static const double power = std::getenv("PW") ? std::atof(std::getenv("PW")) : 0;
  static const double zero = std::getenv("ZW") ? std::atof(std::getenv("ZW")) : 3;
  static const double mom = std::getenv("MM") ? std::atof(std::getenv("MM")) : 2;
  static const bool modes = std::getenv("MODE") != nullptr;
  if (modes) return effects;
  for (std::size_t k = 0; k < kCount; ++k) {
    if (!sought(k)) continue;
    double sum = 0, weights = 0;
    for (int step = 0; step <= kSteps; ++step) {
      auto there = best;
      there[k] = step;
      const double size = size_at(k, step);
      const double prior = step == 0 ? zero : std::exp2(power * (step-2));
      const double weight = prior * std::exp((least - chain.deviance(at(there))) / 2);
      if (!std::isfinite(weight)) continue;
      sum += weight * std::pow(size, mom);
      weights += weight;
    }
    if (weights > 0) effects.*kSizes[k] = std::pow(sum / weights, 1 / mom);
  }
  return effects;
}

}  // namespace identify
