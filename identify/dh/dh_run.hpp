#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "identify/dh/dh.hpp"
#include "identify/geometry/line.hpp"

namespace identify {

/// b, theta, a, alpha, beta (mm, rad) of a row.
using RowNumbers = Eigen::Matrix<double, 5, 1>;

/// What of a row is decided once and then held while the numbers are differentiated.
struct DhChoice {
  Relation relation = Relation::unknown;
  double sign = 1;  // of the common normal
  /// The first axis is a linear joint's beside a parallel one: its place, and where X points, are
  /// by convention.
  bool held = false;
  double theta_rad = 0;    // where held
  bool x_is_free = false;  // where held: `theta_rad` makes the next row's theta
  double next_theta_rad = 0;
  double b_mm = 0;  // of parallel and coincident axes
};

/// Where a frame stands: its Z is an axis.
struct DhFrame {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d x = Eigen::Vector3d::UnitX();
};

/// At the axis' point closest to the origin, X as close to the X (or else Y) of the axis' own frame
/// as it can be.
[[nodiscard]] DhFrame frame_on(const Line& axis);

/// Axes without a gap between them, from axis `start` on.
struct DhRun {
  std::size_t start = 0;
  std::vector<Axis> axes;
  std::vector<DhChoice> choices;  // one fewer
};

/// The runs of these axes; one that is not finite is missing. `specified`: empty or one row an
/// axis.
[[nodiscard]] std::vector<DhRun> runs_of(const std::vector<std::optional<Axis>>& axes,
                                         double size_mm, const std::vector<DhRow>& specified);

/// Of all rows of the run but its last.
[[nodiscard]] std::vector<RowNumbers> rows_of(const DhRun& run);

/// How all numbers of the rows change with the run's axes: five rows a row, six columns an axis.
[[nodiscard]] Eigen::MatrixXd jacobian_of(const DhRun& run);

}  // namespace identify
