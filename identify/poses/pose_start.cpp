#include "identify/poses/pose_start.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "identify/chain/chain_effects.hpp"
#include "identify/geometry/line.hpp"
#include "identify/poses/arm_fit.hpp"

namespace identify {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The inverse over what has a variance.
MatrixXd inverse_where_known(const MatrixXd& covariance) {
  std::vector<Index> known;
  for (Index i = 0; i < covariance.rows(); ++i)
    if (covariance(i, i) > 0) known.push_back(i);
  MatrixXd inverse = MatrixXd::Zero(covariance.rows(), covariance.cols());
  if (known.empty()) return inverse;
  const MatrixXd part = covariance(known, known);
  const VectorXd scale = part.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * part * scale.asDiagonal();
  inverse(known, known) =
      scale.asDiagonal() *
      MatrixXd(scaled.ldlt().solve(MatrixXd::Identity(part.rows(), part.cols()))) *
      scale.asDiagonal();
  return inverse;
}

std::vector<Load> placed_loads(const std::vector<Load>& loads, const Arm& arm,
                               const Eigen::Isometry3d& base, const std::vector<double>& home_rad) {
  std::vector<Load> placed = loads;
  for (Load& load : placed) {
    Eigen::Isometry3d frame = base;
    for (std::size_t j = 0; j <= load.joint; ++j)
      frame = frame * transform(arm.row_at(j, home_rad[j]));
    load.center_mm = frame * load.center_mm;
  }
  return placed;
}

/// Each is an unknown: of more, those count in which most stands are.
constexpr std::size_t kMostPlaces = 200;

/// Where joints stand in two stands or more.
std::vector<JointPlace> shared_places(const std::vector<Pose>& poses, const PoseModel& model) {
  struct Shared {
    JointPlace place;
    std::ptrdiff_t stands;
  };
  const std::vector<Stand> stands = stands_of(poses);
  std::vector<Shared> shared;
  for (std::size_t j = 0; j < model.chain.axes.size(); ++j) {
    if (model.chain.axes[j].linear) continue;
    std::vector<double> told;
    for (const Stand& stand : stands) {
      const double turn = model.told(poses[stand.front()].sample)[j];
      if (!model.is_known(turn)) told.push_back(turn);
    }
    std::sort(told.begin(), told.end());
    for (auto from = told.begin(); from != told.end();) {
      const auto to = std::upper_bound(from, told.end(), *from + 2 * kOnePlace_rad);
      if (to - from > 1) shared.push_back({{j, (*from + *(to - 1)) / 2}, to - from});
      from = to;
    }
  }
  std::stable_sort(shared.begin(), shared.end(),
                   [](const Shared& a, const Shared& b) { return a.stands > b.stands; });
  std::vector<JointPlace> places;
  for (std::size_t k = 0; k < std::min(kMostPlaces, shared.size()); ++k)
    places.push_back(shared[k].place);
  return places;
}

/// By the last decimals of what is told they seem to turn, and these would tell their axes.
std::vector<bool> still_joints(const PoseModel& model, const std::vector<Pose>& poses,
                               const ChainEstimate* sweeps) {
  std::vector<bool> still;
  for (std::size_t j = 0; j < model.chain.axes.size(); ++j)
    still.push_back(!(sweeps != nullptr && sweeps->axes[j]) &&
                    std::all_of(poses.begin(), poses.end(), [&](const Pose& pose) {
                      return std::abs(model.told(pose.sample)[j]) <= kOnePlace_rad;
                    }));
  return still;
}

/// Of joints that came to rest both ways.
std::vector<JointEffect> plays(const PoseModel& model, const std::vector<Pose>& poses) {
  std::vector<JointEffect> all;
  for (std::size_t j = 0; j < model.chain.axes.size(); ++j) {
    const auto came = [&](std::int8_t sense) {
      return std::any_of(poses.begin(), poses.end(),
                         [&](const Pose& pose) { return pose.senses[j] == sense; });
    };
    if (model.chain.axes[j].linear || !came(1) || !came(-1)) continue;
    all.push_back({JointEffect::Kind::play, j});
    all.back().assumed = true;
  }
  return all;
}

}  // namespace

bool whole(const ChainEstimate* sweeps) {
  return sweeps != nullptr && std::all_of(sweeps->axes.begin(), sweeps->axes.end(),
                                          [](const auto& axis) { return axis.has_value(); });
}

MatrixXd to_estimate(const Chain& chain, bool with_tool) {
  const ChainParameters parameters{chain.axes.size(), chain.targets_mm.size()};
  const auto axes = static_cast<Index>(6 * chain.axes.size());
  const Index rest = parameters.count(with_tool) - parameters.target(0);
  MatrixXd map = MatrixXd::Zero(axes + rest, parameters.count(true));
  for (std::size_t j = 0; j < chain.axes.size(); ++j) {
    const auto basis = across(chain.axes[j].direction);
    const auto row = static_cast<Index>(6 * j);
    map.block<3, 2>(row, parameters.axis(j)) = basis;
    map.block<3, 2>(row + 3, parameters.axis(j) + 2) = basis;
  }
  map.block(axes, parameters.target(0), rest, rest).setIdentity();
  return map;
}

FromSweeps from_sweeps(const ChainEstimate& sweeps, std::size_t targets) {
  FromSweeps from;
  from.prior.chain = sweeps.chain;
  const ChainParameters own{sweeps.chain.axes.size(), sweeps.chain.targets_mm.size()};
  const MatrixXd map = to_estimate(sweeps.chain, sweeps.with_orientation).transpose();
  from.prior.chain.targets_mm.resize(targets, sweeps.chain.targets_mm.front());
  const ChainParameters wide{own.joints, targets};
  const auto widened = [&](const MatrixXd& covariance) {
    const MatrixXd narrow = map * covariance * map.transpose();
    MatrixXd all = MatrixXd::Zero(wide.count(true), wide.count(true));
    const Index common = own.tool();
    all.topLeftCorner(common, common) = narrow.topLeftCorner(common, common);
    all.bottomRightCorner<3, 3>() = narrow.bottomRightCorner<3, 3>();
    all.bottomLeftCorner(3, common) = narrow.bottomLeftCorner(3, common);
    all.topRightCorner(common, 3) = narrow.topRightCorner(common, 3);
    // Nothing is known of an axis that was not found, but for rounding. A linear one has no place:
    // that of another axis stands for it, by convention.
    for (std::size_t j = 0; j < own.joints; ++j) {
      const Index known = !sweeps.axes[j] ? 0 : sweeps.chain.axes[j].linear ? 2 : 4;
      all.middleRows(wide.axis(j) + known, 4 - known).setZero();
      all.middleCols(wide.axis(j) + known, 4 - known).setZero();
    }
    return all;
  };
  for (const auto& part : sweeps.parts)
    from.parts.push_back({part.cause, widened(part.covariance)});
  // The device goes on to drift until it sees the poses: all that it knows of the sweeps may be
  // elsewhere by then, as one body.
  MatrixXd all = widened(sweeps.covariance);
  MatrixXd shifted = MatrixXd::Zero(wide.count(true), 6);  // and turned about the first target
  const auto by = [&](const Eigen::Vector3d& point) {
    Eigen::Matrix<double, 3, 6> columns;
    columns << Eigen::Matrix3d::Identity(), -cross_matrix(point - sweeps.chain.targets_mm.front());
    return columns;
  };
  for (std::size_t j = 0; j < own.joints; ++j) {
    const ChainAxis& axis = sweeps.chain.axes[j];
    const Eigen::Matrix<double, 2, 3> basis = across(axis.direction).transpose();
    shifted.block<2, 3>(wide.axis(j), 3) = -basis * cross_matrix(axis.direction);
    shifted.middleRows<2>(wide.axis(j) + 2) = basis * by(axis.point_mm);
  }
  for (std::size_t t = 0; t < targets; ++t)
    shifted.middleRows<3>(wide.target(t)) = by(from.prior.chain.targets_mm[t]);
  for (Index i = 0; i < all.rows(); ++i)
    if (!(all(i, i) > 0)) shifted.row(i).setZero();
  Eigen::Matrix<double, 6, 6> drift = Eigen::Matrix<double, 6, 6>::Zero();
  drift.topLeftCorner<3, 3>().diagonal().setConstant(std::pow(sweeps.wander_mm, 2));
  if (const auto& steady = sweeps.steady_drift)
    drift.topLeftCorner<3, 3>() += steady->mm * steady->mm.transpose();
  if (const auto& move = sweeps.move) {  // the poses may have come first
    drift.topLeftCorner<3, 3>() += move->mm * move->mm.transpose() + move->covariance;
    drift.diagonal().tail<3>().setConstant(move->mm.squaredNorm() /
                                           (kMoveLever_mm * kMoveLever_mm));
  }
  const MatrixXd later = shifted * drift * shifted.transpose();
  all += later;
  from.prior.information = inverse_where_known(all);
  const auto drifted = std::find_if(from.parts.begin(), from.parts.end(),
                                    [](const auto& part) { return part.cause == Cause::drift; });
  if (drifted != from.parts.end()) drifted->covariance += later;
  return from;
}

PoseStart pose_start(const std::vector<Pose>& poses, const Campaign& campaign,
                     const ChainEstimate* sweeps, const std::vector<double>& home_rad,
                     std::size_t targets) {
  PoseStart start;
  start.model.home_rad = home_rad;
  VectorXd distances;
  if (campaign.specified) {
    Arm arm = *campaign.specified;
    for (std::size_t j = 0; j < arm.joints(); ++j) arm.rows[j] = arm.row_at(j, home_rad[j]);
    arm.home_rad = home_rad;
    const PlacedArm placed = placed_robustly(arm, Freedom::zeros, poses, targets);
    start.model.chain = placed.chain();
    start.model.chain.up = placed.base.linear() * campaign.up;
    start.model.loads = placed_loads(campaign.loads, placed.arm, placed.base, home_rad);
    distances = distances_mm(placed, poses);
  }
  if (sweeps != nullptr) {
    // What sweeps told is of axes where they saw them, at the same points of them.
    Chain& chain = start.model.chain;
    chain.axes.resize(sweeps->axes.size());
    for (std::size_t j = 0; j < chain.axes.size(); ++j)
      if (sweeps->axes[j]) chain.axes[j] = sweeps->chain.axes[j];
    chain.targets_mm.resize(targets, sweeps->chain.targets_mm.front());
    std::copy(sweeps->chain.targets_mm.begin(), sweeps->chain.targets_mm.end(),
              chain.targets_mm.begin());
    chain.tool = sweeps->chain.tool;
    if (!sweeps->chain.up.isZero()) chain.up = sweeps->chain.up;
    start.model.seen_at_home = true;
    distances.resize(static_cast<Index>(poses.size()));
    for (std::size_t i = 0; i < poses.size(); ++i)
      distances(static_cast<Index>(i)) =
          (poses[i].sample.position_mm - start.model.position_mm(poses[i])).norm();
  }
  start.middle_mm = middle_of(distances);
  start.model.still = still_joints(start.model, poses, sweeps);
  start.model.places = shared_places(poses, start.model);
  start.model.effects = plays(start.model, poses);
  // The tool's orientation at home, by the first pose that has one.
  for (const Pose& pose : poses) {
    if (!pose.sample.has_orientation) continue;
    const Turns turns = start.model.told(pose.sample);
    start.model.chain.tool =
        start.model.chain.displacement(turns).linear().transpose() * orientation(pose.sample);
    break;
  }
  return start;
}

}  // namespace identify
