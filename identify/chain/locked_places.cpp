#include "identify/chain/locked_places.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include <Eigen/Core>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/sweeps/stroke_rounding.hpp"

namespace identify {

using Eigen::Index;

namespace {

/// By how much a joint's angle scatters within a stroke in which it is locked: a variance.
double wobble_of(const StrokeMoments& stroke, std::size_t joint) {
  if (!stroke.squares) return 0;
  const auto at = static_cast<Index>((stroke.content.orientation ? 7 : 4) + joint);
  double squares = 0;
  for (const StrokeMoments::Node& node : stroke.nodes) squares += node.sums(at, at);
  return squares / stroke.weight;
}

}  // namespace

std::vector<double> unseen_zeros(const ChainNodes& nodes, double angle_step_rad) {
  const double step = angle_step_rad;
  if (!(step > 0)) return std::vector<double>(nodes.known.size(), kLeastAngle_rad);
  std::vector<double> zeros;
  for (std::size_t j = 0; j < nodes.known.size(); ++j) {
    double sum = 0, samples = 0;
    for (const StrokeMoments& stroke : nodes.strokes) {
      if (stroke.content.joint == j || !stroke.squares) continue;
      const double off =
          unseen_zero(stroke.locked_rad[j] / step, wobble_of(stroke, j) / (step * step));
      sum += stroke.weight * off * off;
      samples += stroke.weight;
    }
    const double least = kEvenlySpread / std::sqrt(std::max(1.0, samples));
    const double off = samples > 0 ? std::sqrt(sum / samples) : kEvenlySpread;
    zeros.push_back(std::max(kLeastAngle_rad, step * std::max(off, least)));
  }
  return zeros;
}

std::vector<double> untold_places(const ChainNodes& nodes, const std::vector<double>& unseen,
                                  double angle_step_rad) {
  if (nodes.all_known()) return {};
  constexpr double kBeyondWobble = 4;  // of the variance that it leaves of a stroke's mean
  const std::size_t joints = nodes.known.size();
  double squares = 0, count = 0;  // of all joints, about where each stood at a home
  std::vector<double> told(joints, 0.0);
  for (std::size_t k = 0; k < joints; ++k) {
    std::map<std::size_t, std::vector<double>> at_home;
    double by_wobble = 0, units = 0;
    for (std::size_t u = 0; u < nodes.units.size(); ++u) {
      const StrokeMoments& stroke = nodes.strokes[nodes.units[u].front()];
      if (stroke.content.joint == k || stroke.content.joints <= k) continue;
      at_home[nodes.home_of[nodes.group[u]]].push_back(stroke.locked_rad[k]);
      by_wobble += wobble_of(stroke, k) / stroke.weight;
      ++units;
    }
    double own = 0, own_count = 0;
    for (const auto& [home, angles] : at_home) {
      const Eigen::Map<const Eigen::ArrayXd> all(angles.data(), static_cast<Index>(angles.size()));
      own += (all - all.mean()).square().sum();
      own_count += static_cast<double>(angles.size() - 1);
    }
    count += own_count;
    if (!(own * units > kBeyondWobble * own_count * by_wobble)) continue;
    told[k] = std::sqrt(own / own_count);
    squares += own;
  }
  if (!(squares > kLeastAngle_rad * kLeastAngle_rad * count)) return {};
  std::vector<double> places;
  for (std::size_t k = 0; k < joints; ++k) {
    // Of two normal numbers of standard deviation s the difference is 2 s / sqrt(pi) on average: so
    // often, in steps, they are printed one step apart.
    const double scatter = std::max(squares / count, told[k] * told[k]);
    const double hidden =
        angle_step_rad > 0 ? std::min(unseen[k], std::sqrt(kPi) * scatter / angle_step_rad) : 0;
    places.push_back(nodes.known[k] ? hidden : std::hypot(hidden, told[k]));
  }
  return places;
}

}  // namespace identify
