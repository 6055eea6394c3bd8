#pragma once

#include <optional>
#include <vector>

#include "identify/geometry/angle.hpp"
#include "identify/sweeps/sweep.hpp"

namespace identify {

/// Joints that are locked closer together than this stand at the same home, as well as they came
/// back to it: it changes nothing that gears or loads do.
inline constexpr double kSameHome_rad = 0.5 * kDegree;

/// The angle at which each joint was locked while others swept: the one shared by the sweeps of
/// most other joints (and then of most samples), joint by joint among the sweeps at the same home.
/// Nothing for a joint that was never seen locked, or where no angles are known.
[[nodiscard]] std::vector<std::optional<double>> find_home(const std::vector<Sweep>& sweeps,
                                                           std::size_t joints,
                                                           const Resolution& resolution);

/// How far off home the joint that stood farthest off it was while the sweep ran, 0 where no angles
/// tell.
[[nodiscard]] double off_home_rad(const Sweep& sweep,
                                  const std::vector<std::optional<double>>& home_rad);

/// Whether all joints but the sweeping one stood at home. True where no angles tell otherwise.
[[nodiscard]] bool at_home(const Sweep& sweep, const std::vector<std::optional<double>>& home_rad,
                           const Resolution& resolution);

/// Marks the strokes that only lead from home to a sweep's start, or from its end back home: those
/// that touch home at one end, while the other lies on another sweep of the same joint, from the
/// same stand, that touches home at neither. A stroke touches home by its own joint's angle or,
/// without angles, by the point where the arm rests between the strokes of one joint and those of
/// the next.
void mark_positioning(std::vector<Sweep>& sweeps,
                      const std::vector<std::optional<double>>& home_rad,
                      const Resolution& resolution);

}  // namespace identify
