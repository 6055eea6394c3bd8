#include "identify/chain/chain_table.hpp"

#include <algorithm>

#include "identify/chain/target_level.hpp"
#include "identify/dh/base_height.hpp"
#include "identify/dh/placed_axes.hpp"
#include "identify/geometry/line.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// `first_axes`: what tells of where the base is, three at most.
Isometry3d base_of(const TableAxes& axes, const std::vector<std::optional<Axis>>& first_axes,
                   const std::vector<DhRow>& specified) {
  const DhRow wanted = specified.empty() ? DhRow{} : specified.front();
  const auto count = static_cast<std::ptrdiff_t>(std::min(first_axes.size(), specified.size()));
  const auto table =
      extract_dh(first_axes, axes.size_mm, {specified.begin(), specified.begin() + count});
  const DhRow row{table[0].b_mm.value - wanted.b_mm, table[0].theta_rad.value - wanted.theta_rad, 0,
                  0};
  return first_frame(*first_axes[0]) * transform(row);
}

}  // namespace

void place_linear_axes(ChainEstimate& estimate, const Campaign& campaign,
                       const std::vector<DhRow>& specified) {
  if (!any_linear(estimate.axes)) return;
  const auto rows = static_cast<Index>(6 * estimate.axes.size());
  std::vector<std::optional<Axis>> z = estimate.axes;
  Eigen::VectorXd turned = Eigen::VectorXd::Ones(rows);  // from positive rotation to the table
  double size_mm = 1;
  const Vector3d& target = estimate.chain.targets_mm.front();
  for (std::size_t j = 0; j < z.size(); ++j) {
    if (!z[j]) continue;
    size_mm = std::max(size_mm, (z[j]->point_mm - target).norm());
    if (!campaign.specified || campaign.specified->positive[j] > 0) continue;
    z[j] = z[j]->reversed();
    turned.segment<3>(static_cast<Index>(6 * j)).setConstant(-1);
  }
  const MatrixXd of_table = [&] {
    Eigen::VectorXd all = Eigen::VectorXd::Ones(rows + 3);
    all.head(rows) = turned;
    return MatrixXd(all.asDiagonal() * estimate.covariance.topLeftCorner(rows + 3, rows + 3) *
                    all.asDiagonal());
  }();
  const TargetLevel level = target_level(z, target, of_table, campaign, specified, size_mm);
  const PlacedAxes found = placed(z, level.at_mm, of_table, specified, size_mm);
  // From the estimate to the estimate: all but the axes stays.
  const Index count = estimate.covariance.rows();
  MatrixXd map = MatrixXd::Identity(count, count);
  map.topLeftCorner(rows, rows + 3) = turned.asDiagonal() * found.by_given;
  map.topLeftCorner(rows, rows) *= turned.asDiagonal();
  const auto mapped = [&](const MatrixXd& covariance) -> MatrixXd {
    return map.lazyProduct(MatrixXd(covariance.lazyProduct(map.transpose())));
  };
  estimate.covariance = mapped(estimate.covariance);
  for (ChainEstimate::Part& part : estimate.parts) part.covariance = mapped(part.covariance);
  estimate.by_target = found.by_given.rightCols<3>();
  if (level.open_mm > 0) {
    Eigen::VectorXd by_level = Eigen::VectorXd::Zero(count);
    by_level.head(rows) =
        level.open_mm * (turned.asDiagonal() * change_with_level(found, specified, size_mm));
    if (!by_level.isZero()) {
      estimate.height_open_mm = level.open_mm;
      estimate.parts.push_back({Cause::height, by_level * by_level.transpose()});
      estimate.covariance += estimate.parts.back().covariance;
    }
  }
  for (std::size_t j = 0; j < z.size(); ++j) {
    if (!z[j] || !z[j]->linear) continue;
    const auto at = static_cast<Index>(6 * j);
    estimate.chain.axes[j].point_mm = estimate.axes[j]->point_mm = found.z[j]->point_mm;
    estimate.axes[j]->covariance = estimate.covariance.block<6, 6>(at, at);
  }
}

TableAxes table_axes(const ChainEstimate& chain, const Campaign& campaign) {
  TableAxes axes;
  axes.z = chain.axes;
  const std::size_t joints = chain.axes.size();
  const auto targets = static_cast<Index>(6 * joints);
  const auto tool = targets + static_cast<Index>(3 * chain.chain.targets_mm.size());
  std::vector<Vector3d> places = chain.chain.targets_mm;
  for (const auto& axis : axes.z)
    if (axis) places.push_back(axis->point_mm);
  axes.size_mm = largest_distance_mm(places);

  // From the axes along positive rotation, the first target, and the tool's rotation.
  const Index rows = targets + (chain.with_orientation ? 6 : 0);
  MatrixXd map = MatrixXd::Zero(rows, chain.covariance.rows());
  map.leftCols(targets).topRows(targets).setIdentity();
  for (std::size_t j = 0; j < joints; ++j) {
    if (!axes.z[j] || !campaign.specified || campaign.specified->positive[j] > 0) continue;
    axes.z[j] = axes.z[j]->reversed();
    const auto row = static_cast<Index>(6 * j);
    map.block<3, 3>(row, row) *= -1;
  }
  if (chain.with_orientation) {
    const Vector3d z = chain.chain.tool.col(2);
    map.block<3, 3>(targets, tool) = -cross_matrix(z);
    map.block<3, 3>(targets + 3, targets).setIdentity();
    axes.z.push_back(Axis{z, chain.chain.targets_mm.front()});
  }
  axes.by_estimate = map;
  axes.by_target = chain.by_target;
  if (chain.axes.back()) axes.height_open_mm = chain.height_open_mm * chain.axes.back()->direction;
  axes.covariance = map.lazyProduct(MatrixXd(chain.covariance.lazyProduct(map.transpose())));
  if (chain.with_orientation) axes.z.back()->covariance = axes.covariance.bottomRightCorner<6, 6>();
  return axes;
}

TableAxes at_base(TableAxes axes, std::size_t joints, const std::vector<DhRow>& specified) {
  const std::vector<std::optional<Axis>> of_joints(
      axes.z.begin(), axes.z.begin() + static_cast<std::ptrdiff_t>(joints));
  const auto seen = seen_from_base(of_joints, axes.size_mm, specified);
  for (std::size_t j = joints; j-- > 0;)
    if (of_joints[j]) axes.origin_mm = of_joints[j]->point_mm - seen[j]->point_mm;
  // Behind a gap each stretch of axes has an origin of its own; the tool goes with the last joint.
  for (std::size_t j = joints; j < axes.z.size(); ++j)
    if (of_joints.back()) axes.z[j]->point_mm -= of_joints.back()->point_mm - seen.back()->point_mm;
  std::copy(seen.begin(), seen.end(), axes.z.begin());
  return axes;
}

std::vector<DhEstimate> table_of(const TableAxes& axes, std::size_t joints,
                                 const std::vector<DhRow>& specified) {
  const std::vector<std::optional<Axis>> of_joints(
      axes.z.begin(), axes.z.begin() + static_cast<std::ptrdiff_t>(joints));
  const auto count = static_cast<Index>(6 * joints);
  auto table =
      extract_dh(of_joints, axes.size_mm, specified, axes.covariance.topLeftCorner(count, count));
  if (axes.by_target.size() > 0)
    leave_to_target(table, of_joints, axes.by_target, specified, axes.size_mm);
  return table;
}

void leave_first_to_frame(std::vector<DhEstimate>& table, const std::vector<DhRow>& specified) {
  const DhRow first = specified.empty() ? DhRow{} : specified.front();
  table.front().b_mm = {first.b_mm, 0, Knowledge::by_convention};
  table.front().theta_rad = {first.theta_rad, 0, Knowledge::by_convention};
}

std::vector<DhEstimate> device_table_of(const TableAxes& axes, std::size_t joints,
                                        const std::vector<DhRow>& specified) {
  const TableAxes seen = at_base(axes, joints, specified);
  auto table = table_of(seen, joints, specified);
  leave_first_to_frame(table, specified);
  leave_to_height(table, {seen.z.begin(), seen.z.begin() + static_cast<std::ptrdiff_t>(joints)},
                  seen.size_mm, specified);
  return table;
}

std::optional<DhEstimate> row_to_tool(const TableAxes& axes, std::size_t joints,
                                      const std::vector<DhRow>& specified, bool device_frame) {
  if (axes.z.size() == joints) return std::nullopt;
  std::vector<DhRow> expected = specified;
  if (!expected.empty()) expected.resize(axes.z.size());
  auto table = extract_dh(axes.z, axes.size_mm, expected, axes.covariance);
  if (device_frame) leave_to_height(table, axes.z, axes.size_mm, expected);
  return table[joints - 1];
}

std::optional<RobotPose> robot_pose(const TableAxes& axes, const std::vector<DhRow>& specified) {
  if (axes.z.size() < 2 || !axes.z[0] || !axes.z[1]) return std::nullopt;
  const std::size_t told_by = std::min<std::size_t>(3, axes.z.size());
  std::vector<std::optional<Axis>> first_axes(
      axes.z.begin(), axes.z.begin() + static_cast<std::ptrdiff_t>(told_by));
  RobotPose found;
  found.pose = base_of(axes, first_axes, specified);
  found.pose.pretranslate(axes.origin_mm);
  constexpr double kDirectionStep = 1e-6;
  constexpr double kPointStep_mm = 1e-3;
  const auto count = static_cast<Index>(6 * told_by);
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian = MatrixXd::Zero(6, count);
  for (Index p = 0; p < count; ++p) {
    const auto k = static_cast<std::size_t>(p / 6);
    if (!axes.z[k]) continue;
    const double step = p % 6 < 3 ? kDirectionStep : kPointStep_mm;
    const auto moved = [&](double by) {
      first_axes[k] = axes.z[k];
      (p % 6 < 3 ? first_axes[k]->direction(p % 6) : first_axes[k]->point_mm(p % 6 - 3)) += by;
      return base_of(axes, first_axes, specified);
    };
    const Isometry3d above = moved(step);
    const Isometry3d below = moved(-step);
    first_axes[k] = axes.z[k];
    const Eigen::AngleAxisd turned(Matrix3d(above.linear() * below.linear().transpose()));
    Vector6d change;
    change << above.translation() - below.translation(), turned.angle() * turned.axis();
    jacobian.col(p) = change / (2 * step);
  }
  const MatrixXd covariance = axes.covariance.topLeftCorner(count, count);
  Vector6d variance = (jacobian * covariance * jacobian.transpose()).diagonal();
  variance.head<3>() += axes.height_open_mm.cwiseAbs2();
  if (!variance.allFinite() || !found.pose.matrix().allFinite()) return std::nullopt;
  const Vector6d sigma = variance.cwiseMax(0.0).cwiseSqrt();
  found.position_sigma_mm = sigma.head<3>();
  found.rotation_sigma_rad = sigma.tail<3>();
  return found;
}

std::optional<Isometry3d> tool_pose(const ChainEstimate& chain, const TableAxes& axes,
                                    const std::vector<DhEstimate>& table,
                                    const std::vector<DhRow>& specified) {
  if (table.empty() || !axes.z.front()) return std::nullopt;
  const auto last = last_frame(*axes.z.front(), table, specified);
  if (!last) return std::nullopt;
  Isometry3d tool = Isometry3d::Identity();
  tool.linear() = chain.chain.tool;
  tool.translation() = chain.chain.targets_mm.front() - axes.origin_mm;
  return last->inverse() * tool;
}

}  // namespace identify
