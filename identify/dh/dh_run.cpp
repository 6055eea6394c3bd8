#include "identify/dh/dh_run.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "identify/dh/dh_extraction.hpp"

namespace identify {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

double angle_across(const Vector3d& axis, const Vector3d& from, const Vector3d& to) {
  return std::atan2(axis.dot(from.cross(to)), from.dot(to));
}

/// The DH numbers (b, theta, a, alpha, beta) that take `frame` on the first axis to the next frame
/// on the second; `frame` becomes that.
RowNumbers advance(const Axis& from, const Axis& to, const DhChoice& choice, DhFrame& frame) {
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
  DhFrame next;
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
  RowNumbers numbers;
  numbers << b, angle_across(z, frame.x, next.x), (next.origin - foot()).dot(next.x),
      std::atan2(-n.dot(z.cross(next.x)), n.dot(z)),
      std::asin(std::clamp(n.dot(next.x), -1.0, 1.0));
  next.x = turned_across(next.x, n);
  frame = next;
  return numbers;
}

DhChoice choose(const Axis& first, const Axis& second, double size, const DhRow* specified) {
  DhChoice choice;
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
    DhFrame frame = frame_on(first.line());
    DhChoice with = choice;
    with.sign = sign;
    return advance(first, second, with, frame);
  };
  const RowNumbers plus = numbers(1);
  if (specified != nullptr) {
    const auto misfit = [&](const RowNumbers& row) {
      return std::abs(row(2) - specified->a_mm) / size +
             std::abs(wrapped(row(3) - specified->alpha_rad));
    };
    if (misfit(numbers(-1)) < misfit(plus)) choice.sign = -1;
  } else if (choice.relation == Relation::skew && plus(2) < 0) {
    choice.sign = -1;
  }
  return choice;
}

bool is_finite(const Axis& axis) {
  return axis.direction.allFinite() && axis.point_mm.allFinite() && axis.covariance.allFinite();
}

/// How far axes are moved to differentiate: far less than what makes the common normals turn over.
struct Steps {
  double direction = 1e-6;
  double point_mm = 1e-3;
};

Steps steps_of(const DhRun& run) {
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

/// The normal of axes that are one by specification points to either side: to that of the next
/// theta.
void face_specified(DhRun& run, const std::vector<DhRow>& specified) {
  constexpr double kParallel = 1e-6;
  const auto off = [](const DhRun& of, std::size_t k) {
    return std::abs(wrapped(rows_of(of)[k + 1](1) - of.choices[k].next_theta_rad));
  };
  for (std::size_t k = 0; k + 1 < run.choices.size() && !specified.empty(); ++k) {
    const DhRow& row = specified[run.start + k];
    if (row.a_mm != 0 || std::abs(std::sin(row.alpha_rad)) > kParallel) continue;
    DhRun other = run;
    other.choices[k].sign *= -1;
    if (off(other, k) < off(run, k)) run = std::move(other);
  }
}

}  // namespace

DhFrame frame_on(const Line& axis) {
  DhFrame frame{axis.point_mm(), turned_across(Vector3d::UnitX(), axis.direction)};
  if (frame.x.isZero()) frame.x = turned_across(Vector3d::UnitY(), axis.direction);
  return frame;
}

std::vector<RowNumbers> rows_of(const DhRun& run) {
  std::vector<RowNumbers> rows;
  DhFrame frame = frame_on(run.axes.front().line());
  for (std::size_t i = 0; i + 1 < run.axes.size(); ++i) {
    DhChoice choice = run.choices[i];
    const bool x_is_free = choice.x_is_free && i + 2 < run.axes.size();
    for (int round = 0; x_is_free && round < 3; ++round) {  // each leaves the square of the tilt
      DhFrame next = frame;
      advance(run.axes[i], run.axes[i + 1], choice, next);
      choice.theta_rad += advance(run.axes[i + 1], run.axes[i + 2], run.choices[i + 1], next)(1) -
                          choice.next_theta_rad;
    }
    rows.push_back(advance(run.axes[i], run.axes[i + 1], choice, frame));
  }
  return rows;
}

MatrixXd jacobian_of(const DhRun& run) {
  const Steps steps = steps_of(run);
  const auto columns = static_cast<Eigen::Index>(6 * run.axes.size());
  const auto rows = static_cast<Eigen::Index>(5 * run.choices.size());
  MatrixXd jacobian(rows, columns);
  DhRun moved = run;
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
      RowNumbers change = above[i] - below[i];
      for (const Eigen::Index angle : {1, 3, 4}) change(angle) = wrapped(change(angle));
      jacobian.block<5, 1>(static_cast<Eigen::Index>(5 * i), p) = change / (2 * step);
    }
    moved.axes[k] = run.axes[k];
  }
  return jacobian;
}

std::vector<DhRun> runs_of(const std::vector<std::optional<Axis>>& axes, double size,
                           const std::vector<DhRow>& specified) {
  std::vector<DhRun> runs;
  for (std::size_t i = 0; i < axes.size();) {
    if (!axes[i] || !is_finite(*axes[i])) {
      ++i;
      continue;
    }
    DhRun run{i, {}, {}};
    for (; i < axes.size() && axes[i] && is_finite(*axes[i]); ++i) {
      if (!run.axes.empty()) {
        DhChoice choice = choose(run.axes.back(), *axes[i], size,
                                 specified.empty() ? nullptr : &specified[i - 1]);
        if (choice.relation == Relation::unknown) break;
        if (i < specified.size()) choice.next_theta_rad = specified[i].theta_rad;
        run.choices.push_back(choice);
      }
      run.axes.push_back(*axes[i]);
    }
    face_specified(run, specified);
    runs.push_back(std::move(run));
  }
  return runs;
}

}  // namespace identify
