#include "identify/dh/dh_extraction.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "identify/dh/dh_run.hpp"
#include "identify/geometry/angle.hpp"

namespace identify {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr double kNoAngle_rad = 1;     // first order says nothing of such an angle,
constexpr double kNoLength_mm = 1000;  // nor of such a length where the arm is no larger

/// `covariance` is that of the run's axes, six rows an axis.
std::vector<RowNumbers> variances_of(const DhRun& run, const MatrixXd& covariance) {
  if (covariance.isZero(0)) return std::vector<RowNumbers>(run.choices.size(), RowNumbers::Zero());
  const MatrixXd jacobian = jacobian_of(run);
  const MatrixXd spread = jacobian.lazyProduct(covariance);
  std::vector<RowNumbers> variances(run.choices.size());
  for (std::size_t i = 0; i < variances.size(); ++i)
    for (Eigen::Index k = 0; k < 5; ++k) {
      const auto row = static_cast<Eigen::Index>(5 * i) + k;
      const double variance = spread.row(row).dot(jacobian.row(row));
      variances[i](k) = variance < 0 ? 0 : variance;  // not a number remains that
    }
  return variances;
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

void fill(const DhRun& run, const MatrixXd& covariance, double size,
          std::vector<DhEstimate>& table) {
  const double no_length = std::max(size, kNoLength_mm);
  const auto rows = rows_of(run);
  const auto variances = variances_of(run, covariance);
  // Without the axis before, neither X nor origin of the first frame is known.
  bool origin_known = run.start == 0, x_known = origin_known, x_meaningful = true;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    DhEstimate& row = table[run.start + i];
    const DhChoice& choice = run.choices[i];
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

/// Angles within half a turn of the specified ones.
void turn_to(const std::vector<DhRow>& specified, std::vector<DhEstimate>& table) {
  const auto turn = [](DhNumber& number, double to) {
    if (number.knowledge == Knowledge::identified)
      number.value -= 2 * kPi * std::nearbyint((number.value - to) / (2 * kPi));
  };
  for (std::size_t i = 0; i < std::min(table.size(), specified.size()); ++i) {
    turn(table[i].theta_rad, specified[i].theta_rad);
    turn(table[i].alpha_rad, specified[i].alpha_rad);
    turn(table[i].beta_rad, specified[i].beta_rad);
  }
}

}  // namespace

double wrapped(double angle) {
  const double turned = std::remainder(angle, 2 * kPi);
  return turned <= -kPi ? turned + 2 * kPi : turned;
}

DhRow specified_row(const Arm& arm, std::size_t joint, double home_rad) {
  constexpr double kOfHome = 0.1 * kDegree;
  DhRow row = arm.row_at(joint, home_rad);
  row.theta_rad = wrapped(row.theta_rad - kOfHome) + kOfHome;
  return row;
}

Eigen::Isometry3d first_frame(const Axis& axis) {
  const DhFrame frame = frame_on(axis.line());
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
  for (const DhRun& run : runs_of(axes, size, specified)) {
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
  turn_to(specified, table);
  return table;
}

MatrixXd dh_jacobian(const std::vector<std::optional<Axis>>& axes, double size,
                     const std::vector<DhRow>& specified) {
  const auto count = static_cast<Eigen::Index>(axes.size());
  MatrixXd whole = MatrixXd::Zero(5 * count, 6 * count);
  for (const DhRun& run : runs_of(axes, size, specified)) {
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

std::optional<Eigen::Isometry3d> last_frame(const Axis& first, const std::vector<DhEstimate>& table,
                                            const std::vector<DhRow>& specified) {
  for (const DhEstimate& row : table)
    for (const auto* number : {&row.b_mm, &row.theta_rad, &row.a_mm, &row.alpha_rad})
      if (number->knowledge == Knowledge::undetermined) return std::nullopt;
  std::vector<DhRow> rows = values(table);
  if (!specified.empty()) rows.back() = specified.back();
  Eigen::Isometry3d last = first_frame(first);
  for (const DhRow& row : rows) last = last * transform(row);
  return last;
}

}  // namespace identify
