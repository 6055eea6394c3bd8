#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "daemon/points/points_file.hpp"
#include "daemon/settings/sweep_plan.hpp"
#include "identify/sweeps/joint_assignment.hpp"
#include "identify/sweeps/sample.hpp"
#include "identify/sweeps/sweep.hpp"

namespace sweepd {

// From measured points to sweeps, by what the file says of joints and times. Points of different
// targets are of different sweeps. Sweeps come in the order in which they begin.

/// The worst of several streams; nothing where none was without angles.
using WorstLimit = std::optional<identify::MotionLimit>;

/// Points chosen by hand: fewer are a circle, but nothing beside it tells that they are one.
inline constexpr std::size_t kFewestPoints = 4;
/// By so much a locked joint may move, as in a stream, where angles are printed in such steps.
[[nodiscard]] double still_angle_rad(double step_rad);

/// Points with times, segmented as a live stream is: every stroke of each target. Without angles
/// all targets are of one body, and `limit` learns what noise hides. Throws CsvError where there is
/// no usable sweep, since times are no seconds, positions no millimetres or angles no radians.
[[nodiscard]] std::vector<identify::Sweep> streamed_sweeps(const PointsFile& file,
                                                           std::size_t joints,
                                                           const identify::Resolution& resolution,
                                                           WorstLimit& limit);

/// Points that name their joint: consecutive ones of the same joint and sweep are a sweep. Throws
/// CsvError where none is usable, since angles are no radians.
[[nodiscard]] std::vector<identify::Sweep> listed_sweeps(const PointsFile& file,
                                                         const identify::Resolution& resolution);

/// A file of one joint (counted from 0): one sweep a target, or with times all strokes. Where
/// angles show that another joint moved, a stroke is that joint's. Throws CsvError if they show
/// this joint in no stroke, but others.
[[nodiscard]] std::vector<identify::Sweep> sweeps_of_joint(const PointsFile& file,
                                                           std::size_t joint, std::size_t joints,
                                                           const identify::Resolution& resolution,
                                                           WorstLimit& limit);

}  // namespace sweepd
