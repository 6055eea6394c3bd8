#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "identify/dh/axis_senses.hpp"
#include "identify/dh/dh.hpp"
#include "identify/dh/dh_comparison.hpp"
#include "identify/dh/dh_extraction.hpp"
#include "identify/geometry/bounding_box.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/line.hpp"
#include "identify/geometry/line_fit.hpp"
#include "identify/geometry/warning.hpp"
#include "identify/sweeps/sweep.hpp"

namespace identify {

struct JointResult {
  std::vector<Sweep> sweeps;  ///< all of this joint, in the order of time
  /// One a sweep: at the common home or, where none was there, close to it; and no positioning.
  std::vector<bool> used;
  std::optional<CircleFit> circle;  ///< of the used sweeps of one target
  std::size_t circle_target = 0;
  /// Where no sweep was at the common home: how far off it the joint farthest off it stood in the
  /// nearest one, used or not. Nothing: at home.
  std::optional<double> off_home_rad;
  /// By the description or the strokes, the joint moves along a line: what is in rad of it (home,
  /// ranges, its angles' errors) is mm * kDegree.
  bool linear = false;
  std::optional<LineFit> line;          ///< in place of the circle
  SenseBy sense_by = SenseBy::nothing;  ///< what tells which way is positive
  bool against_plan = false;            ///< it turned the other way, as the specified table tells
  /// Along positive rotation (of a linear joint, the way that its mm rise), by the best estimator.
  std::optional<Axis> axis;
  std::optional<BoundingBox> box;  ///< of the samples that were used, but strays
};

/// What each joint's circle or line tells by itself, and who of the strokes is used.
struct CircleEstimate {
  /// One a joint, where known: the angles at which the axes below were locked.
  std::vector<std::optional<double>> home_rad;
  std::vector<JointResult> joints;
  std::vector<DhRow> specified;             ///< at home_rad; empty without a specified table
  std::vector<DhEstimate> circle_dh;        ///< the paper's table; one row a joint
  std::optional<BoundingBox> bounding_box;  ///< of the samples that were used, but strays
  bool any_sweep = false;                   ///< of a joint of the arm
  bool no_positions = false;                ///< some joint's strokes are told by angles alone
  std::string doubt;  ///< why a table with all its numbers is not complete; empty: nothing
  /// Numbers of `circle_dh` that are others if joints of which nothing tells it turn the other way.
  std::vector<OtherNumber> by_sense;
  /// What contradicts itself or what a built robot can be; the heaviest first.
  std::vector<Warning> doubts;
  std::vector<Warning> warnings;
};

/// Of the joint's used sweeps.
[[nodiscard]] std::set<std::size_t> used_targets(const JointResult& joint);
/// Those of the circle's target.
[[nodiscard]] std::vector<Sweep> used_sweeps(const JointResult& joint);

/// Positions of the joint's used sweeps of one target, or of all, in the order of time.
[[nodiscard]] Eigen::Matrix3Xd used_points(const JointResult& joint,
                                           std::optional<std::size_t> target = std::nullopt);

/// The joints' axes by their circles, and of linear joints by their lines, where the direction is
/// certain enough. The noise of a joint's fit counts as no smaller than its neighbours': a target
/// near an axis leaves small residuals and a wrong normal. Samples whose errors are correlated
/// count for as few as they are worth (correlation_of()). Joints that stood off home count with
/// what that may turn the axis by and, as far away as the robot is large, shift it.
void set_circle_axes(CircleEstimate& found, const Resolution& resolution);

/// An upper estimate of the robot's size, for where it matters, by the points.
[[nodiscard]] double size_by_circles_mm(const CircleEstimate& found);

/// The smallest boxes around the points of each joint that has an axis, and of all; without points
/// that are farther off their circle or line than noise takes them.
void measure_boxes(CircleEstimate& found);

}  // namespace identify
