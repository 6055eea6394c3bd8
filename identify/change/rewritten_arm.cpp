#include "identify/change/rewritten_arm.hpp"

#include <cmath>
#include <utility>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/line.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr auto kRowNumbers = static_cast<Index>(kDhNumbers.size());
/// Along axes that are so close to parallel, b of two rows hardly tells anything by itself.
constexpr double kNearlyParallel_rad = 1 * kDegree;

bool is_angle(Index place) {
  return place % kRowNumbers == 1 || place % kRowNumbers > 2;
}

VectorXd in_one_column(const std::vector<DhRow>& rows) {
  VectorXd numbers(kRowNumbers * static_cast<Index>(rows.size()));
  Index at = 0;
  for (const DhRow& row : rows)
    for (const double value : {row.b_mm, row.theta_rad, row.a_mm, row.alpha_rad, row.beta_rad})
      numbers(at++) = value;
  return numbers;
}

DhRow row_of(const VectorXd& numbers, std::size_t row) {
  const Index at = kRowNumbers * static_cast<Index>(row);
  return {numbers(at), numbers(at + 1), numbers(at + 2), numbers(at + 3), numbers(at + 4)};
}

/// One row of a table beside another's: which of the two senses of the common normal is closer.
double apart(const DhRow& row, const DhRow& other) {
  const double size = std::abs(other.a_mm) + std::abs(row.a_mm) + 1;
  return std::abs(row.a_mm - other.a_mm) / size +
         std::abs(wrapped(row.alpha_rad - other.alpha_rad));
}

/// How much farther the joint of the second arm has gone at its home, where it is linear.
double farther_mm(const MeasuredArm& first, const MeasuredArm& second, std::size_t joint) {
  const auto &from = first.home_rad[joint], &to = second.home_rad[joint];
  return first.dh[joint].linear && from && to ? kLinear_mm * (*to - *from) : 0;
}

bool nearly_parallel(const DhEstimate& row) {
  return row.relation == Relation::parallel || row.relation == Relation::coincident ||
         std::abs(std::sin(row.alpha_rad.value)) < kNearlyParallel_rad;
}

}  // namespace

std::vector<SharedStep> shared_steps(const MeasuredArm& first, const MeasuredArm& second) {
  std::vector<SharedStep> steps;
  for (std::size_t i = 0; i < first.dh.size(); ++i) {
    const SharedStep a{first.dh[i].relation, first.positive[i] * first.dh[i].b_mm.value};
    const SharedStep b{second.dh[i].relation, second.positive[i] * second.dh[i].b_mm.value};
    SharedStep step;
    if (a.relation == Relation::coincident || b.relation == Relation::coincident)
      step.relation = Relation::coincident;
    else if (nearly_parallel(first.dh[i]) || nearly_parallel(second.dh[i]))
      step.relation = Relation::parallel;
    // Convention puts a linear joint's axis onto the next.
    if (first.dh[i].linear && step.parallel()) step.relation = Relation::coincident;
    if (a.parallel() || b.parallel())
      step.b_mm = a.parallel() ? a.b_mm : b.b_mm - farther_mm(first, second, i);
    steps.push_back(step);
  }
  return steps;
}

std::vector<SharedStep> at_home_of(const MeasuredArm& second, const MeasuredArm& first,
                                   std::vector<SharedStep> steps) {
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (steps[i].parallel()) steps[i].b_mm += farther_mm(first, second, i);
  return steps;
}

RewrittenArm::RewrittenArm(const MeasuredArm& arm, std::vector<SharedStep> steps,
                           const std::vector<DhRow>& like)
    : arm_(arm), steps_(std::move(steps)), table_(in_one_column(values(arm.dh))) {
  rows_ = written(table_, like, normals_);
}

VectorXd RewrittenArm::numbers() const {
  return in_one_column(rows_);
}

Isometry3d RewrittenArm::last_frame() const {
  Isometry3d old = Isometry3d::Identity();
  for (std::size_t i = 0; i + 1 < arm_.dh.size(); ++i) old = old * transform(row_of(table_, i));
  Isometry3d last = first_frame().pose();
  for (std::size_t i = 0; i + 1 < rows_.size(); ++i) last = last * transform(rows_[i]);
  return last.inverse(Eigen::Isometry) * old;
}

MatrixXd RewrittenArm::covariance() const {
  constexpr double kStep_mm = 1e-3, kStep_rad = 1e-6;
  const Index count = table_.size();
  MatrixXd jacobian = MatrixXd::Zero(count, count);
  std::vector<Vector3d> normals = normals_;
  for (Index p = 0; p < count; ++p) {
    if (!(arm_.covariance(p, p) > 0)) continue;
    const double step = is_angle(p) ? kStep_rad : kStep_mm;
    const auto moved = [&](double by) {
      VectorXd table = table_;
      table(p) += by;
      return in_one_column(written(table, {}, normals));
    };
    VectorXd change = moved(step) - moved(-step);
    for (Index k = 0; k < count; ++k)
      if (is_angle(k)) change(k) = wrapped(change(k));
    jacobian.col(p) = change / (2 * step);
  }
  return jacobian * arm_.covariance * jacobian.transpose();
}

AxisFrame RewrittenArm::first_frame() const {
  AxisFrame frame;
  frame.z *= arm_.positive.front();
  return frame;
}

std::vector<DhRow> RewrittenArm::written(const VectorXd& table, const std::vector<DhRow>& like,
                                         std::vector<Vector3d>& normals) const {
  const std::size_t joints = arm_.dh.size();
  const bool choose = normals.empty();
  std::vector<Line> axes;  // from the second on
  Isometry3d old = Isometry3d::Identity();
  for (std::size_t i = 0; i + 1 < joints; ++i) {
    old = old * transform(row_of(table, i));
    axes.push_back(Line::through(old.translation(), arm_.positive[i + 1] * old.linear().col(2)));
    if (choose) normals.push_back(old.linear().col(0));
  }
  std::vector<DhRow> rows(joints);
  AxisFrame frame = first_frame();
  for (std::size_t i = 0; i + 1 < joints; ++i) {
    Line& next = axes[i];
    const auto step = [&](const Vector3d& near) {
      return step_to(frame, next, steps_[i].relation, near, steps_[i].b_mm);
    };
    if (i + 2 < joints && arm_.dh[i + 1].linear && steps_[i + 1].parallel()) {
      // It meets the axis behind it b above its own origin, which moves with it a little.
      const Line& through = axes[i + 1];
      const Vector3d& along = next.direction;
      for (int round = 0; round < 3; ++round) {
        const Vector3d above = step(normals[i]).frame.origin_mm + steps_[i + 1].b_mm * along;
        const Vector3d start = through.point_mm();
        next = Line::through(
            start + through.direction * (along.dot(above - start) / along.dot(through.direction)),
            along);
      }
    }
    // What is a normal by convention is the same one of both arms: the row tells none.
    const bool conventional = i > 0 && arm_.dh[i].linear && steps_[i].parallel();
    if (choose && !like.empty() && conventional)
      normals[i] = Eigen::AngleAxisd(like[i].theta_rad, frame.z) * frame.x;
    AxisStep taken = step(normals[i]);
    if (choose && !like.empty() && !conventional) {
      const AxisStep other = step(-normals[i]);
      if (apart(other.row, like[i]) < apart(taken.row, like[i])) taken = other;
    }
    if (choose) normals[i] = taken.normal;
    rows[i] = taken.row;
    frame = taken.frame;
  }
  return rows;
}

}  // namespace identify
