#include "identify/poses/pose_estimate.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "identify/geometry/line.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Rows beyond the unknowns: fewer tell nothing of the noise.
constexpr Index kSpareRows = 6;
constexpr double kMetre_mm = 1000;
/// To begin with, half of what is left comes from the joints, at this distance.
constexpr double kStartOrientation_rad = 1e-4;
constexpr double kLeastStart_mm = 1e-3;
/// No device measures as well.
constexpr double kComputed_mm = 1e-4;

struct Start {
  PoseModel model;
  double middle_mm = 0;  ///< distance of the middle pose
};

std::size_t targets_in(const std::vector<Pose>& poses, const ChainEstimate* sweeps) {
  std::size_t count = sweeps != nullptr ? sweeps->chain.targets_mm.size() : 0;
  for (const Pose& pose : poses) count = std::max(count, pose.target + 1);
  return count;
}

bool whole(const ChainEstimate* sweeps) {
  return sweeps != nullptr && std::all_of(sweeps->axes.begin(), sweeps->axes.end(),
                                          [](const auto& axis) { return axis.has_value(); });
}

/// From the chain's parameters to (direction, point) of each axis, the targets, and the tool's
/// rotation, as a ChainEstimate's covariance has them.
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

/// What the sweeps tell, in the parameters of a chain with `targets` targets.
struct FromSweeps {
  ChainPrior prior;
  std::vector<ChainEstimate::Part> parts;
};

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
    return all;
  };
  from.prior.information = inverse_where_known(widened(sweeps.covariance));
  for (const auto& part : sweeps.parts)
    from.parts.push_back({part.cause, widened(part.covariance)});
  return from;
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

Start start_of(const std::vector<Pose>& poses, const Campaign& campaign,
               const ChainEstimate* sweeps, const std::vector<double>& home_rad,
               std::size_t targets) {
  Start start;
  start.model.home_rad = home_rad;
  VectorXd distances;
  if (campaign.specified) {
    Arm arm = *campaign.specified;
    for (std::size_t j = 0; j < arm.joints(); ++j) arm.rows[j] = arm.row_at(j, home_rad[j]);
    arm.home_rad = home_rad;
    const PlacedArm placed = placed_robustly(arm, Freedom::zeros, poses, targets);
    start.model.chain = placed.chain();
    start.model.up = placed.base.linear().col(2);
    start.model.loads = placed_loads(campaign.loads, placed.arm, placed.base, home_rad);
    distances = distances_mm(placed, poses);
  }
  if (whole(sweeps)) {
    start.model.chain = sweeps->chain;
    start.model.chain.zero_rad.clear();
    start.model.chain.sags.clear();
    start.model.chain.targets_mm.resize(targets, sweeps->chain.targets_mm.front());
    distances.resize(static_cast<Index>(poses.size()));
    for (std::size_t i = 0; i < poses.size(); ++i)
      distances(static_cast<Index>(i)) =
          (poses[i].sample.position_mm - start.model.position_mm(poses[i])).norm();
  }
  start.middle_mm = middle_of(distances);
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

Observability observability_of(const PoseFit& fit, const std::vector<Pose>& poses) {
  const ChainParameters parameters = fit.model.chain_parameters();
  VectorXd unit = VectorXd::Ones(fit.model.parameters());  // of a step of about a millimetre
  for (std::size_t j = 0; j < parameters.joints; ++j)
    unit.segment<2>(parameters.axis(j)).setConstant(1 / kMetre_mm);
  unit.tail(unit.size() - parameters.tool()).setConstant(1 / kMetre_mm);
  MatrixXd normal = MatrixXd::Zero(unit.size(), unit.size());
  Observability seen;
  double count = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double weight = fit.weights(static_cast<Index>(i));
    if (weight == 0) continue;
    const PoseRow& row = fit.rows[i];
    const MatrixXd columns = row.by_parameter * unit.asDiagonal();
    normal +=
        weight * columns.transpose() * fit.noise.covariance(row.by_joint).llt().solve(columns);
    count += weight;
    const Eigen::Matrix3d of =
        row.by_parameter.topRows<3>() * fit.covariance * row.by_parameter.topRows<3>().transpose();
    seen.displacement_mm =
        std::max(seen.displacement_mm,
                 std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(of).eigenvalues()(2)));
  }
  std::vector<Index> there;  // without a tool that was not seen
  for (Index i = 0; i < unit.size(); ++i)
    if (normal(i, i) > 0) there.push_back(i);
  const VectorXd squares =
      Eigen::SelfAdjointEigenSolver<MatrixXd>(MatrixXd(normal(there, there))).eigenvalues();
  const VectorXd values = squares.cwiseMax(0.0).cwiseSqrt();
  seen.largest = values(values.size() - 1);
  seen.smallest = values(0);
  seen.mean = values(0) > 0 ? std::exp(values.array().log().mean()) / std::sqrt(count) : 0;
  return seen;
}

/// The shares of the noise of positions (and orientations), of joints, and of what sweeps told.
std::vector<ChainEstimate::Part> parts_of(const PoseFit& fit,
                                          const std::optional<FromSweeps>& sweeps) {
  const Index count = fit.covariance.rows();
  MatrixXd positions = MatrixXd::Zero(count, count), joints = positions;
  for (std::size_t i = 0; i < fit.rows.size(); ++i) {
    const double weight = fit.weights(static_cast<Index>(i));
    const PoseRow& row = fit.rows[i];
    const MatrixXd weighed = fit.noise.covariance(row.by_joint).llt().solve(row.by_parameter);
    PoseNoise apart = fit.noise;
    apart.joint_rad = 0;
    positions += weight * weighed.transpose() * apart.covariance(row.by_joint) * weighed;
    const MatrixXd by_joint = fit.noise.joint_rad * row.by_joint.transpose() * weighed;
    joints += weight * by_joint.transpose() * by_joint;
  }
  const auto share = [&](const MatrixXd& of) {
    return MatrixXd(fit.covariance * of * fit.covariance);
  };
  std::vector<ChainEstimate::Part> parts{{Cause::noise, share(positions)},
                                         {Cause::angles, share(joints)}};
  if (!sweeps) return parts;
  const Index chain = sweeps->prior.information.rows();
  for (const auto& part : sweeps->parts) {
    MatrixXd of = MatrixXd::Zero(count, count);
    of.topLeftCorner(chain, chain) =
        sweeps->prior.information * part.covariance * sweeps->prior.information;
    if (part.cause == Cause::noise)
      parts.front().covariance += share(of);
    else
      parts.push_back({part.cause, share(of)});
  }
  return parts;
}

ChainEstimate chain_of(const PoseFit& fit, const std::optional<FromSweeps>& sweeps) {
  ChainEstimate chain;
  chain.chain = fit.model.chain;
  chain.with_orientation = fit.with_orientation;
  const ChainParameters parameters = fit.model.chain_parameters();
  const Index of_chain = parameters.count(true);
  const MatrixXd map = to_estimate(chain.chain, fit.with_orientation);
  const auto mapped = [&](const MatrixXd& of) {
    return MatrixXd(map * of.topLeftCorner(of_chain, of_chain) * map.transpose());
  };
  chain.covariance = mapped(fit.whole_covariance());
  for (const auto& part : parts_of(fit, sweeps))
    chain.parts.push_back({part.cause, mapped(part.covariance)});
  for (std::size_t j = 0; j < chain.chain.axes.size(); ++j) {
    const ChainAxis& axis = chain.chain.axes[j];
    const auto at = static_cast<Index>(6 * j);
    Axis found{axis.direction, axis.point_mm, chain.covariance.block<6, 6>(at, at), axis.linear};
    chain.axes.emplace_back(found.direction_sigma_rad() < kWorstDirection_rad ? std::optional(found)
                                                                              : std::nullopt);
  }
  chain.angles.resize(chain.axes.size());
  chain.noise.position_mm = fit.noise.position_mm;
  chain.noise.orientation_rad = fit.noise.orientation_rad;
  chain.noise.locked_rad = fit.noise.joint_rad;
  chain.noise.swept_rad.assign(chain.axes.size(), kFreeAngle);
  chain.samples = fit.rows.size();
  chain.summary.converged = fit.converged;
  chain.summary.ending = fit.converged ? "converged" : "no convergence";
  chain.summary.iterations = fit.iterations;
  chain.summary.condition = fit.condition;
  chain.summary.undetermined = static_cast<std::size_t>(fit.open.cols());
  return chain;
}

}  // namespace

Left left_of(const VectorXd& distances_mm) {
  if (distances_mm.size() == 0) return {};
  return {distances_mm.mean(),
          distances_mm.norm() / std::sqrt(static_cast<double>(distances_mm.size())),
          distances_mm.maxCoeff()};
}

Eigen::Matrix3d PoseEstimate::covariance_at(const Pose& pose) const {
  const PoseRow row = pose_row(fit.model, pose, false);
  const MatrixXd of = fit.whole_covariance();
  return row.by_parameter * of * row.by_parameter.transpose() +
         fit.noise.covariance(row.by_joint).topLeftCorner<3, 3>();
}

std::optional<PoseEstimate> estimate_poses(const std::vector<Pose>& poses, const Campaign& campaign,
                                           const ChainEstimate* sweeps,
                                           const std::vector<std::optional<double>>& home_rad,
                                           std::string& reason) {
  const bool all_homes =
      home_rad.size() == campaign.joints &&
      std::all_of(home_rad.begin(), home_rad.end(), [](const auto& at) { return at.has_value(); });
  if (sweeps != nullptr && (!all_homes || !sweeps->summary.converged)) sweeps = nullptr;
  if (!campaign.specified && !whole(sweeps)) {
    reason =
        "poses alone need a start: give a robot description with a DH table, or sweeps of all "
        "joints beside the poses";
    return std::nullopt;
  }
  std::vector<double> home =
      campaign.specified ? campaign.specified->home_rad : std::vector<double>(campaign.joints);
  if (sweeps != nullptr)
    for (std::size_t j = 0; j < home.size(); ++j) home[j] = *home_rad[j];
  const std::size_t targets = targets_in(poses, sweeps);
  const bool oriented = std::any_of(poses.begin(), poses.end(),
                                    [](const Pose& pose) { return pose.sample.has_orientation; });
  const ChainParameters parameters{campaign.joints, targets};
  Index rows = 0;
  for (const Pose& pose : poses) rows += pose.sample.has_orientation ? 6 : 3;
  const Index unknowns = parameters.count(oriented);
  if (sweeps == nullptr && rows < unknowns + kSpareRows) {
    const Index each = oriented ? 6 : 3;
    reason = std::to_string(poses.size()) + " poses give " + std::to_string(rows) +
             " numbers for " + std::to_string(unknowns) + " unknowns: measure at least " +
             std::to_string((unknowns + kSpareRows + each - 1) / each) + " poses, better 30";
    return std::nullopt;
  }

  const Start start = start_of(poses, campaign, sweeps, home, targets);
  std::optional<FromSweeps> known;
  std::optional<ChainPrior> prior;
  if (sweeps != nullptr) {
    known = from_sweeps(*sweeps, targets);
    prior = known->prior;
  }
  PoseNoise noise;
  noise.position_mm = std::max(kLeastStart_mm, start.middle_mm / 2);
  noise.joint_rad = noise.position_mm / kMetre_mm;
  noise.orientation_rad = oriented ? kStartOrientation_rad : 0;
  PoseEstimate found;
  found.fit = fitted(start.model, noise, poses, oriented, prior);
  found.effects = add_effects(found.fit, poses, prior);
  found.with_sweeps = sweeps != nullptr;
  VectorXd distances(static_cast<Index>(poses.size()));
  VectorXd counted(distances.size());
  Index in = 0;
  for (Index i = 0; i < distances.size(); ++i) {
    const bool outlier = found.fit.weights(i) < 0.5;
    counted(i) = outlier ? 0 : 1;
    if (outlier)
      found.outliers.push_back(static_cast<std::size_t>(i));
    else
      distances(in++) = found.fit.rows[static_cast<std::size_t>(i)].off.head<3>().norm();
  }
  found.left = left_of(distances.head(in));
  found.computed = found.left.rms_mm < kComputed_mm + campaign.resolution.position_mm +
                                           kMetre_mm * campaign.resolution.angle_rad;
  found.poses = poses;
  if (campaign.specified) {
    Arm arm = *campaign.specified;
    PlacedArm at = placed_robustly(arm, Freedom::frames, poses, targets);
    for (std::size_t f = 0; f < kFreedoms; ++f) {
      const auto freedom = static_cast<Freedom>(f);
      at = fitted(at, freedom, poses, counted);
      const VectorXd all = distances_mm(at, poses);
      VectorXd used(in);
      Index k = 0;
      for (Index i = 0; i < all.size(); ++i)
        if (counted(i) > 0) used(k++) = all(i);
      found.levels.push_back({freedom, at, left_of(used)});
    }
  }
  found.observability = observability_of(found.fit, poses);
  found.chain = chain_of(found.fit, known);
  return found;
}

}  // namespace identify
