#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "identify/dh/dh.hpp"
#include "identify/geometry/line.hpp"

namespace identify {

/// What is known of a number. Only an identified one comes from the data.
enum class Knowledge { undetermined, by_convention, identified };

struct DhNumber {
  double value = 0;  ///< mm or rad; meaningless when undetermined
  double sigma = 0;  ///< standard uncertainty; zero unless identified
  Knowledge knowledge = Knowledge::undetermined;

  /// False too of what was identified from axes that came without uncertainties.
  [[nodiscard]] bool has_sigma() const { return knowledge == Knowledge::identified && sigma > 0; }
};

struct DhEstimate {
  DhNumber b_mm;
  DhNumber theta_rad;
  DhNumber a_mm;
  DhNumber alpha_rad;
  DhNumber beta_rad;  ///< zero by convention unless the axes are parallel or coincident
  Relation relation = Relation::unknown;
  bool linear = false;  ///< the joint's variable is b, and theta is constant
};

/// Only axes that are parallel, as far as one can tell, have a beta; for others it is zero.
[[nodiscard]] inline bool has_beta(const DhEstimate& row) {
  return row.relation == Relation::parallel || row.relation == Relation::coincident;
}

/// A number of a row, and its name in tables and files, which have mm and degrees.
struct DhNumberName {
  DhNumber DhEstimate::*number;
  std::string_view name;
  std::string_view symbol;
  bool length;  ///< else an angle

  [[nodiscard]] constexpr std::string_view unit() const { return length ? "mm" : "deg"; }
};
inline constexpr std::array<DhNumberName, 5> kDhNumbers{
    {{&DhEstimate::b_mm, "b", "b", true},
     {&DhEstimate::theta_rad, "theta", "θ", false},
     {&DhEstimate::a_mm, "a", "a", true},
     {&DhEstimate::alpha_rad, "alpha", "α", false},
     {&DhEstimate::beta_rad, "beta", "β", false}}};

/// b, theta, a, alpha, beta of a row.
[[nodiscard]] inline std::array<const DhNumber*, 5> numbers_of(const DhEstimate& row) {
  return {&row.b_mm, &row.theta_rad, &row.a_mm, &row.alpha_rad, &row.beta_rad};
}

/// Where a table starts: Z along the first axis, origin at its point closest to that of the
/// measurement frame, X as close to that frame's X (or, where that is along the axis, its Y) as it
/// can be.
[[nodiscard]] Eigen::Isometry3d first_frame(const Axis& axis);

/// DH table of the axes in the paper's notation, as the robot stood: one row an axis, in order,
/// from the first axis' `first_frame` on.
///
/// Row n needs a frame on the end-effector: it is zero by convention. For parallel axes b is free,
/// as specified or else zero, and beta carries what is not quite parallel: the table reproduces the
/// axes whatever their relation is called. For coincident axes all numbers, and the next theta, are
/// by convention: that they coincide is all that is known. Where an axis is missing or not finite,
/// or the relation of two is unknown, the numbers that need it stay undetermined, and so does a
/// number of which the data say nothing: an angle uncertain by a radian, a length uncertain by the
/// arm's size and a metre. Every number that is not undetermined is finite.
///
/// The place of a linear joint's axis is by convention (see placed_axes.hpp, which gives it), and
/// with it a of its row and b of the next; beside a parallel axis also b and theta of its row: X
/// points as before, turned by the specified theta, and beta carries what is not quite parallel.
///
/// Axes point as they are given. The sign of each common normal is the one that agrees with
/// `specified` (empty or one row an axis): with its a and alpha or, of axes that are one by it,
/// with the next theta; angles are within half a turn of its. Without it a >= 0, and 0 < alpha < pi
/// where a vanishes. Uncertainties are propagated to first order from `covariance`, that of all
/// axes' (direction, point), six rows an axis, missing ones included; without it from the axes'
/// own, as independent.
[[nodiscard]] std::vector<DhEstimate> extract_dh(const std::vector<std::optional<Axis>>& axes,
                                                 double size_mm,
                                                 const std::vector<DhRow>& specified = {},
                                                 const Eigen::MatrixXd& covariance = {});

/// How the numbers of the table of `extract_dh` change with the axes: b, theta, a, alpha, beta (mm,
/// rad) of each row, by each axis' (direction, point); zero where an axis is missing.
[[nodiscard]] Eigen::MatrixXd dh_jacobian(const std::vector<std::optional<Axis>>& axes,
                                          double size_mm, const std::vector<DhRow>& specified = {});

/// The values of a table as rows; undetermined ones as zero.
[[nodiscard]] std::vector<DhRow> values(const std::vector<DhEstimate>& table);

/// The frame behind the last row of a table that begins at this axis. The last row, of which axes
/// tell nothing, is as specified. Nothing where a number is undetermined.
[[nodiscard]] std::optional<Eigen::Isometry3d> last_frame(const Axis& first,
                                                          const std::vector<DhEstimate>& table,
                                                          const std::vector<DhRow>& specified);

/// An angle brought to (-pi, pi].
[[nodiscard]] double wrapped(double angle_rad);

/// A row of the arm as it is specified where the controller says `home_rad`. Theta is from -179.9
/// to 180.1 degrees, so that half a turn is +180 to whichever side home is uncertain.
[[nodiscard]] DhRow specified_row(const Arm& arm, std::size_t joint, double home_rad);

}  // namespace identify
