#include "identify/axis_directions.hpp"

#include <cmath>

namespace identify {
namespace {

double misfit(const std::vector<std::optional<Axis>>& axes, double size,
              const std::vector<DhRow>& specified) {
  double sum = 0;
  const auto dh = extract_dh(axes, size, specified);
  const auto add = [&](const DhNumber& number, double difference) {
    if (number.knowledge == Knowledge::identified) sum += std::abs(difference);
  };
  for (std::size_t j = 0; j < dh.size(); ++j) {
    add(dh[j].b_mm, (dh[j].b_mm.value - specified[j].b_mm) / size);
    add(dh[j].a_mm, (dh[j].a_mm.value - specified[j].a_mm) / size);
    add(dh[j].alpha_rad, wrapped(dh[j].alpha_rad.value - specified[j].alpha_rad));
  }
  return sum;
}

}  // namespace

std::vector<std::optional<Axis>> agreeing_directions(const std::vector<std::optional<Axis>>& axes,
                                                     double size,
                                                     const std::vector<DhRow>& specified) {
  auto best = axes;
  double least = misfit(axes, size, specified);
  for (std::size_t flips = 1; flips < std::size_t{1} << axes.size(); ++flips) {
    auto tried = axes;
    for (std::size_t j = 0; j < axes.size(); ++j)
      if (tried[j] && (flips >> j & 1) != 0) tried[j] = tried[j]->reversed();
    // Noise makes ways that are equal differ a little: the first of them counts.
    constexpr double kEqual = 1e-3;
    if (const double sum = misfit(tried, size, specified); sum < least - kEqual) {
      least = sum;
      best = std::move(tried);
    }
  }
  return best;
}

}  // namespace identify
