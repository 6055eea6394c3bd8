#pragma once

#include <optional>
#include <vector>

#include "identify/chain/chain.hpp"
#include "identify/chain/chain_residual.hpp"
#include "identify/circle/circle_estimate.hpp"
#include "identify/geometry/angle.hpp"

namespace identify {

/// A circle by its axis and one point on it; of a linear joint the line through that point.
struct AxisCircle {
  ChainAxis axis;
  Eigen::Vector3d on_it_mm;

  /// From the axis to a point, across.
  [[nodiscard]] Eigen::Vector3d arm(const Eigen::Vector3d& point) const;
  /// From a point to the circle.
  [[nodiscard]] Eigen::Vector3d to_circle(const Eigen::Vector3d& point) const;
};

/// Sum of squared distances.
[[nodiscard]] double misfit(const std::vector<AxisCircle>& circles, const Eigen::Vector3d& point);

/// The point closest to all circles, by Gauss-Newton from `start`; without one, from all around the
/// first circle, for others may pass near it more than once. A single circle is met anywhere on it.
[[nodiscard]] Eigen::Vector3d meeting_point(const std::vector<AxisCircle>& circles,
                                            const Eigen::Vector3d& start);
[[nodiscard]] Eigen::Vector3d meeting_point(const std::vector<AxisCircle>& circles);

/// An axis for each joint to start from, by a robust circle of the sweeps that the circles used;
/// it points as the circle's does. Nothing where there is no circle, or hardly one: direction
/// uncertain by more than a degree, or without angles no sweep in which the target moves. Of a
/// linear joint, the line.
[[nodiscard]] std::vector<std::optional<ChainAxis>> starting_axes(const CircleEstimate& circles);

/// A sweep that the chain uses.
struct ChainSweep {
  std::size_t joint = 0;
  const Sweep* sweep = nullptr;
};

/// Whether a sweep from elsewhere than home tells of the chain: angles tell where all joints stood,
/// and those of which no axis is `known` stood at home, or nothing tells where they had the target.
[[nodiscard]] bool tells_from_elsewhere(const Sweep& sweep,
                                        std::vector<std::optional<double>> home_rad,
                                        const std::vector<bool>& known);

/// The sweeps of all joints with an axis to start from, joint by joint: those of the circles, and
/// those that tell from elsewhere.
[[nodiscard]] std::vector<ChainSweep> chain_sweeps(
    const CircleEstimate& circles, const std::vector<std::optional<ChainAxis>>& axes);

/// Their samples, one by one, with turns from home where all angles are known.
[[nodiscard]] std::vector<ChainObservation> chain_samples(
    const CircleEstimate& circles, const std::vector<std::optional<ChainAxis>>& axes);

/// The targets at home, near enough to start from: where the circles of each target's sweeps come
/// together. Sets the turns of the sweeping joints by where the samples lie on them.
[[nodiscard]] std::vector<Eigen::Vector3d> starting_targets(
    const Chain& chain, std::vector<ChainObservation>& observations, std::size_t targets,
    bool with_angles);

/// The tool at home: the rotation closest to its mean over all observations, which have one.
[[nodiscard]] Eigen::Matrix3d starting_tool(const Chain& chain,
                                            const std::vector<ChainObservation>& observations);

}  // namespace identify
