#include "identify/chain/uneven_joints.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace identify {
namespace {

constexpr double kFactor = 2;
constexpr std::size_t kSteps = 8;  // up to 256 times
/// So much less deviance there has to be.
constexpr double kShown = 10;

/// One joint's effect is so many times as large as the others'.
struct Uneven {
  double times = 1;
  double gain = 0;  ///< less deviance
};

/// Where an effect's are that is as the other joints', as yet.
struct Even {
  double* times;
  double* gain;
};

/// `times`: the one of `sizes` that is tried.
Uneven judged(LinearisedChain& chain, const ChainEffects& sizes, double& times, double now) {
  const double usual = times;
  std::array<double, kSteps + 1> deviances{};
  double least = now;
  for (std::size_t step = 0; step <= kSteps; ++step) {
    times = usual * std::pow(kFactor, step);
    const double here = step == 0 ? now : chain.deviance(sizes);
    deviances[step] = std::isfinite(here) ? here : std::numeric_limits<double>::max();
    least = std::min(least, deviances[step]);
    if (step == 1 && !(least < now)) break;
  }
  times = usual;
  if (!(least < now - kShown)) return {};
  double weights = 0, squares = 0;
  for (std::size_t step = 0; step <= kSteps; ++step) {
    const double weight = std::exp((least - deviances[step]) / 2);
    weights += weight;
    squares += weight * std::pow(kFactor, 2 * step);
  }
  return {usual * std::sqrt(squares / weights), now - least};
}

}  // namespace

void find_uneven_joints(LinearisedChain& chain, const std::vector<double>& usual_home_times,
                        ChainEffects& sizes) {
  const std::size_t joints = usual_home_times.size();
  sizes.home_times = usual_home_times;
  sizes.figure_times.assign(joints, 1);
  sizes.home_gains.assign(joints, 0);
  sizes.figure_gains.assign(joints, 0);
  std::vector<Even> even;
  for (std::size_t j = 0; j < joints; ++j) {
    if (sizes.home_rad > 0) even.push_back({&sizes.home_times[j], &sizes.home_gains[j]});
    if (sizes.figure_mm() > 0) even.push_back({&sizes.figure_times[j], &sizes.figure_gains[j]});
  }
  // The worst one first: what it takes is not another one's.
  while (!even.empty()) {
    const double now = chain.deviance(sizes);
    Uneven worst;
    auto at = even.end();
    for (auto one = even.begin(); one != even.end(); ++one) {
      const Uneven found = judged(chain, sizes, *one->times, now);
      if (!(found.gain > worst.gain)) continue;
      worst = found;
      at = one;
    }
    if (at == even.end()) return;
    *at->times = worst.times;
    *at->gain = worst.gain;
    even.erase(at);
  }
}

}  // namespace identify
