#include "identify/dh/dh_extraction.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "identify/dh/dh.hpp"
#include "identify/geometry/angle.hpp"

namespace identify {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Vector5d = Eigen::Matrix<double, 5, 1>;

constexpr double kNoAngle_rad = 1;     // first order says nothing of such an angle,
constexpr double kNoLength_mm = 1000;  // nor of such a length where the arm is no larger

double angle_across(const Vector3d& axis, const Vector3d& from, const Vector3d& to) {
  return std::atan2(axis.dot(from.cross(to)), from.dot(to));
}

/// What is decided once and then held while the numbers are differentiated.
struct Choice {
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
struct Frame {
  Vector3d origin = Vector3d::Zero();
  Vector3d x = Vector3d::UnitX();
};

Frame frame_on(const Line& axis) {
  Frame frame{axis.point_mm(), turned_across(Vector3d::UnitX(), axis.direction)};
  if (frame.x.isZero()) frame.x = turned_across(Vector3d::UnitY(), axis.direction);
  return frame;
}

/// The DH numbers (b, theta, a, alpha, beta) that take `frame` on the first axis to the next frame
/// on the second; `frame` becomes that.
Vector5d advance(const Axis& from, const Axis& to, const Choice& choice, Frame& frame) {
  const Line first = from.line();
  const Line second = to.line();
  const Vector3d z = first.direction;
  const Vector3d start = second.point_mm();
  // Where the second axis passes a plane through a point.
  const auto passes = [&](const Vector3d& normal, const Vector3d& through) -> Vector3d {
    return start + second.direction * (normal.dot(through - start) / normal.dot(second.direction));
  };
  double b = choice.b_mm;
  const auto foot = [&]() -> Vector3d { return frame.origin + b * z; };
  Frame next;
  if (choice.held) {
    b = z.dot(from.point_mm - frame.origin);
    next.origin = passes(z, foot());
    next.x = Eigen::AngleAxisd(choice.theta_rad, z) * frame.x;
  } else if (choice.relation == Relation::skew || choice.relation == Relation::intersecting) {
    // The plane of the first axis and the common normal: so the row leads to the second axis even
    // where rounding moves the feet along both.
    next.x = choice.sign * turned_across(z.cross(second.direction), z);
    next.origin = passes(z.cross(next.x), frame.origin);
    b = z.dot(next.origin - frame.origin);
  } else {
    next.origin = passes(z, foot());  // the plane across the first axis
    const Vector3d offset = next.origin - foot();
    next.x = offset.norm() > kExact ? Vector3d(choice.sign * turned_across(offset, z)) : frame.x;
  }
  // The second direction is Rx(alpha) Ry(beta) Z, seen from X, Y = Z x X, Z.
  const Vector3d& n = second.direction;
  Vector5d numbers;
  numbers << b, angle_across(z, frame.x, next.x), (next.origin - foot()).dot(next.x),
      std::atan2(-n.dot(z.cross(next.x)), n.dot(z)),
      std::asin(std::clamp(n.dot(next.x), -1.0, 1.0));
  next.x = turned_across(next.x, n);
  frame = next;
  return numbers;
}

Choice choose(const Axis& first, const Axis& second, double size, const DhRow* specified) {
  Choice choice;
  choice.relation = relation_between(first, second, size);
  if (choice.relation == Relation::unknown) return choice;
  choice.held = first.linear &&
                (choice.relation == Relation::parallel || choice.relation == Relation::coincident);
  if (choice.held) {
    choice.x_is_free = first.x_is_free;
    if (specified != nullptr) choice.theta_rad = specified->theta_rad;
    return choice;
  }
  if (specified != nullptr && choice.relation != Relation::skew &&
      choice.relation != Relation::intersecting)
    choice.b_mm = specified->b_mm;
  const auto numbers = [&](double sign) {
    Frame frame = frame_on(first.line());
    Choice with = choice;
    with.sign = sign;
    return advance(first, second, with, frame);
  };
  const Vector5d plus = numbers(1);
  if (specified != nullptr) {
    const auto misfit = [&](const Vector5d& row) {
      return std::abs(row(2) - specified->a_mm) / size +
             std::abs(wrapped(row(3) - specified->alpha_rad));
    };
    if (misfit(numbers(-1)) < misfit(plus)) choice.sign = -1;
  } else if (choice.relation == Relation::skew && plus(2) < 0) {
    choice.sign = -1;
  }
  return choice;
}

/// Axes without a gap between them, from axis `start` on.
struct Run {
  std::size_t start = 0;
  std::vector<Axis> axes;
  std::vector<Choice> choices;  // one fewer
};

bool is_finite(const Axis& axis) {
  return axis.direction.allFinite() && axis.point_mm.allFinite() && axis.covariance.allFinite();
}

/// b, theta, a, alpha, beta of all rows of the run but its last.
std::vector<Vector5d> rows_of(const Run& run) {
  std::vector<Vector5d> rows;
  Frame frame = frame_on(run.axes.front().line());
  for (std::size_t i = 0; i + 1 < run.axes.size(); ++i) {
    Choice choice = run.choices[i];
    const bool x_is_free = choice.x_is_free && i + 2 < run.axes.size();
    for (int round = 0; x_is_free && round < 3; ++round) {  // each leaves the square of the tilt
      Frame next = frame;
      advance(run.axes[i], run.axes[i + 1], choice, next);
      choice.theta_rad += advance(run.axes[i + 1], run.axes[i + 2], run.choices[i + 1], next)(1) -
                          choice.next_theta_rad;
    }
    rows.push_back(advance(run.axes[i], run.axes[i + 1], choice, frame));
  }
  return rows;
}

/// How far axes are moved to differentiate: far less than what makes the common normals turn over.
struct Steps {
  double direction = 1e-6;
  double point_mm = 1e-3;
};

Steps steps_of(const Run& run) {
  constexpr double kSmall = 0.01;
  Steps steps;
  for (std::size_t i = 0; i < run.choices.size(); ++i) {
    const Line first = run.axes[i].line();
    const LinePair pair = relate(first, run.axes[i + 1].line());
    const Relation relation = run.choices[i].relation;
    if (relation == Relation::skew || relation == Relation::intersecting)
      steps.direction = std::min(steps.direction, kSmall * pair.sine);
    else if (relation == Relation::parallel)
      steps.point_mm = std::min(
          steps.point_mm,
          kSmall * first.direction.cross(run.axes[i + 1].point_mm - run.axes[i].point_mm).norm());
  }
  return steps;
}

/// Of all numbers of the run's rows by its axes: five rows a row, six columns an axis.
MatrixXd jacobian_of(const Run& run) {
  const Steps steps = steps_of(run);
  const auto columns = static_cast<Eigen::Index>(6 * run.axes.size());
  const auto rows = static_cast<Eigen::Index>(5 * run.choices.size());
  MatrixXd jacobian(rows, columns);
  Run moved = run;
  for (Eigen::Index p = 0; p < columns; ++p) {
    const auto k = static_cast<std::size_t>(p / 6);
    const double step = p % 6 < 3 ? steps.direction : steps.point_mm;
    const auto rows_at = [&](double by) {
      moved.axes[k] = run.axes[k];
      (p % 6 < 3 ? moved.axes[k].direction(p % 6) : moved.axes[k].point_mm(p % 6 - 3)) += by;
      return rows_of(moved);
    };
    const auto above = rows_at(step);
    const auto below = rows_at(-step);
    for (std::size_t i = 0; i < above.size(); ++i) {
      Vector5d change = above[i] - below[i];
      for (const Eigen::Index angle : {1, 3, 4}) change(angle) = wrapped(change(angle));
      jacobian.block<5, 1>(static_cast<Eigen::Index>(5 * i), p) = change / (2 * step);
    }
    moved.axes[k] = run.axes[k];
  }
  return jacobian;
}

/// `covariance` is that of the run's axes, six rows an axis.
std::vector<Vector5d> variances_of(const Run& run, const MatrixXd& covariance) {
  if (covariance.isZero(0)) return std::vector<Vector5d>(run.choices.size(), Vector5d::Zero());
  const MatrixXd jacobian = jacobian_of(run);
  const MatrixXd spread = jacobian.lazyProduct(covariance);
  std::vector<Vector5d> variances(run.choices.size());
  for (std::size_t i = 0; i < variances.size(); ++i)
    for (Eigen::Index k = 0; k < 5; ++k) {
      const auto row = static_cast<Eigen::Index>(5 * i) + k;
      const double variance = spread.row(row).dot(jacobian.row(row));
      variances[i](k) = variance < 0 ? 0 : variance;  // not a number remains that
    }
  return variances;
}

std::vector<Run> runs_of(const std::vector<std::optional<Axis>>& axes, double size,
                         const std::vector<DhRow>& specified) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < axes.size();) {
    if (!axes[i] || !is_finite(*axes[i])) {
      ++i;
      continue;
    }
    Run run{i, {}, {}};
    for (; i < axes.size() && axes[i] && is_finite(*axes[i]); ++i) {
      if (!run.axes.empty()) {
        Choice choice = choose(run.axes.back(), *axes[i], size,
                               specified.empty() ? nullptr : &specified[i - 1]);
        if (choice.relation == Relation::unknown) break;
        if (i < specified.size()) choice.next_theta_rad = specified[i].theta_rad;
        run.choices.push_back(choice);
      }
      run.axes.push_back(*axes[i]);
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

DhNumber conventional() {
  return {0, 0, Knowledge::by_convention};
}

/// Undetermined where the data say nothing of it.
DhNumber told(double value, double variance, double no_information) {
  const double sigma = std::sqrt(variance);
  if (!std::isfinite(value) || !(sigma < no_information)) return {};
  return {value, sigma, Knowledge::identified};
}

void fill(const Run& run, const MatrixXd& covariance, double size, std::vector<DhEstimate>& table) {
  const double no_length = std::max(size, kNoLength_mm);
  const auto rows = rows_of(run);
  const auto variances = variances_of(run, covariance);
  // Without the axis before, neither X nor origin of the first frame is known.
  bool origin_known = run.start == 0, x_known = origin_known, x_meaningful = true;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    DhEstimate& row = table[run.start + i];
    const Choice& choice = run.choices[i];
    const auto number = [&](Eigen::Index k) {
      return told(rows[i](k), variances[i](k), k == 0 || k == 2 ? no_length : kNoAngle_rad);
    };
    const auto convention = [&](Eigen::Index k) {
      return DhNumber{rows[i](k), 0, Knowledge::by_convention};
    };
    const bool coincident = choice.relation == Relation::coincident && !choice.held;
    row.relation = choice.relation;
    const bool parallel = has_beta(row);
    // Where axes coincide their common normal points anywhere. An X that is held is as known as the
    // one before.
    const auto about_x = [&](Eigen::Index k) {
      return coincident ? convention(k) : choice.held && !x_known ? DhNumber{} : number(k);
    };
    row.a_mm = coincident || run.axes[i].linear ? convention(2) : number(2);
    row.alpha_rad = about_x(3);
    row.beta_rad = parallel ? about_x(4) : conventional();
    const bool x_was_meaningful = x_meaningful && !(i > 0 && run.choices[i - 1].x_is_free);
    x_meaningful = !coincident;
    if (x_known)
      row.theta_rad = x_was_meaningful && x_meaningful && !choice.held ? number(1) : convention(1);
    x_known = x_known || !choice.held;
    const bool placed = parallel || (i > 0 && run.axes[i - 1].linear);
    if (origin_known || parallel) row.b_mm = placed ? convention(0) : number(0);
    origin_known = origin_known || !parallel;
  }
}

}  // namespace

double wrapped(double angle) {
  const double turned = std::remainder(angle, 2 * kPi);
  return turned <= -kPi ? turned + 2 * kPi : turned;
}

Eigen::Isometry3d first_frame(const Axis& axis) {
  const Frame frame = frame_on(axis.line());
  const Vector3d z = axis.line().direction;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << frame.x, z.cross(frame.x), z;
  pose.translation() = frame.origin;
  return pose;
}

std::vector<DhEstimate> extract_dh(const std::vector<std::optional<Axis>>& axes, double size,
                                   const std::vector<DhRow>& specified,
                                   const MatrixXd& covariance) {
  std::vector<DhEstimate> table(axes.size());
  for (const Run& run : runs_of(axes, size, specified)) {
    const auto from = static_cast<Eigen::Index>(6 * run.start);
    const auto count = static_cast<Eigen::Index>(6 * run.axes.size());
    MatrixXd own = MatrixXd::Zero(count, count);
    if (covariance.size() > 0)
      own = covariance.block(from, from, count, count);
    else
      for (Eigen::Index k = 0; k < count; k += 6)
        own.block<6, 6>(k, k) = run.axes[static_cast<std::size_t>(k / 6)].covariance;
    fill(run, own, size, table);
  }
  for (std::size_t i = 0; i < axes.size(); ++i) table[i].linear = axes[i] && axes[i]->linear;
  if (!table.empty())
    table.back() = {conventional(), conventional(), conventional(),     conventional(),
                    conventional(), Relation::last, table.back().linear};
  return table;
}

MatrixXd dh_jacobian(const std::vector<std::optional<Axis>>& axes, double size,
                     const std::vector<DhRow>& specified) {
  const auto count = static_cast<Eigen::Index>(axes.size());
  MatrixXd whole = MatrixXd::Zero(5 * count, 6 * count);
  for (const Run& run : runs_of(axes, size, specified)) {
    const MatrixXd part = jacobian_of(run);
    const auto start = static_cast<Eigen::Index>(run.start);
    whole.block(5 * start, 6 * start, part.rows(), part.cols()) = part;
  }
  return whole;
}

std::vector<DhRow> values(const std::vector<DhEstimate>& table) {
  std::vector<DhRow> rows;
  rows.reserve(table.size());
  for (const DhEstimate& row : table)
    rows.push_back({row.b_mm.value, row.theta_rad.value, row.a_mm.value, row.alpha_rad.value,
                    row.beta_rad.value});
  return rows;
}

}  // namespace identify
