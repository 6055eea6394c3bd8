#include "identify/poses/pose_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Cholesky>

#include "identify/chain/home_turn.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/poses/drift_spread.hpp"
#include "identify/poses/pose_sag.hpp"
#include "identify/poses/pose_start.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// To begin with, half of what is left comes from the joints, at this distance.
constexpr double kStartOrientation_rad = 1e-4;
constexpr double kLeastStart_mm = 1e-3;
constexpr double kStartPlay_rad = 10 * kArcsec;
/// No device measures as well.
constexpr double kComputed_mm = 1e-4;

std::size_t targets_in(const std::vector<Pose>& poses, const ChainEstimate* sweeps) {
  std::size_t count = sweeps != nullptr ? sweeps->chain.targets_mm.size() : 0;
  for (const Pose& pose : poses) count = std::max(count, pose.target + 1);
  return count;
}

/// One of those of a target whose angles are alike: that it was seen there again tells of its
/// noise, and nothing of the arm.
std::vector<std::size_t> different_poses(const std::vector<Pose>& poses) {
  const auto alike = [&](const Pose& one, const Pose& other) {
    for (std::size_t j = 0; j < one.sample.joints; ++j)
      if (std::abs(one.sample.angles_rad[j] - other.sample.angles_rad[j]) > kOnePlace_rad)
        return false;
    return one.target == other.target;
  };
  std::vector<std::size_t> different;
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (std::none_of(different.begin(), different.end(),
                     [&](std::size_t k) { return alike(poses[i], poses[k]); }))
      different.push_back(i);
  return different;
}

/// The shares of the noise of positions (and orientations), of joints, of what sweeps told, and of
/// what drifted amid the poses.
std::vector<ChainEstimate::Part> parts_of(const PoseFit& fit,
                                          const std::optional<FromSweeps>& sweeps,
                                          const MatrixXd& drifted) {
  const Index count = fit.covariance.rows();
  MatrixXd positions = MatrixXd::Zero(count, count), joints = positions;
  const auto square = [](double sigma) { return sigma * sigma; };
  for (const StandRows& stand : fit.counted()) {
    const MatrixXd weighed = stand.divided_again(stand.columns.transpose());
    const auto add = [&](const MatrixXd& covariance, MatrixXd& sum) {
      sum(stand.parameters, stand.parameters) +=
          weighed.transpose() * covariance * weighed / fit.widened;
    };
    add(square(fit.noise.position_mm) * stand.by_position +
            square(fit.noise.orientation_rad) * stand.by_orientation,
        positions);
    add(square(fit.noise.joint_rad) * stand.by_joints, joints);
  }
  Index at = fit.model.chain_parameters().count(true);
  const auto know = [&](double sigma) { joints(at, at) += 1 / (sigma * sigma), ++at; };
  for (const JointEffect& effect : fit.model.effects)
    for (Index k = 0; k < effect.count(); ++k) know(fit.known_beforehand(effect));
  for (const JointPlace& place : fit.model.places) know(fit.known_beforehand(place));
  const auto share = [&](const MatrixXd& of) {
    return MatrixXd(fit.covariance * of * fit.covariance);
  };
  std::vector<ChainEstimate::Part> parts{{Cause::noise, share(positions)},
                                         {Cause::angles, share(joints)}};
  if (!drifted.isZero(0)) parts.push_back({Cause::drift, drifted});
  if (!sweeps) return parts;
  const Index chain = sweeps->prior.information.rows();
  for (const auto& part : sweeps->parts) {
    MatrixXd of = MatrixXd::Zero(count, count);
    of.topLeftCorner(chain, chain) =
        sweeps->prior.information * part.covariance * sweeps->prior.information;
    const auto same = std::find_if(parts.begin(), parts.end(),
                                   [&](const auto& one) { return one.cause == part.cause; });
    if (same != parts.end())
      same->covariance += share(of);
    else
      parts.push_back({part.cause, share(of)});
  }
  return parts;
}

/// `drifted`: the covariance of what drifted amid the poses.
ChainEstimate chain_of(const PoseFit& fit, const std::optional<FromSweeps>& sweeps,
                       const MatrixXd& drifted) {
  ChainEstimate chain;
  chain.chain = fit.model.chain;
  chain.with_orientation = fit.with_orientation;
  const ChainParameters parameters = fit.model.chain_parameters();
  const Index of_chain = parameters.count(true);
  const MatrixXd map = to_estimate(chain.chain, fit.with_orientation);
  const auto mapped = [&](const MatrixXd& of) {
    return MatrixXd(map * of.topLeftCorner(of_chain, of_chain) * map.transpose());
  };
  chain.covariance = mapped(fit.whole_covariance() + drifted);
  for (const auto& part : parts_of(fit, sweeps, drifted))
    chain.parts.push_back({part.cause, mapped(part.covariance)});
  for (std::size_t j = 0; j < chain.chain.axes.size(); ++j) {
    const ChainAxis& axis = chain.chain.axes[j];
    const auto at = static_cast<Index>(6 * j);
    Axis found{axis.direction, axis.point_mm, chain.covariance.block<6, 6>(at, at), axis.linear};
    const bool seen = !fit.model.still[j] && found.direction_sigma_rad() < kWorstDirection_rad;
    chain.axes.emplace_back(seen ? std::optional(found) : std::nullopt);
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

/// What play leaves open of home (add_turns_at_home). On which side of it a joint stood before its
/// first move nothing tells. Between that side and the one of later rests half of the joints show
/// twice the half, and the others nothing; what a joint shows itself is at least so.
std::vector<double> variances_of_sides(const PoseFit& fit, const std::vector<Pose>& poses) {
  std::vector<double> variances(fit.model.chain.axes.size(), 0.0);
  for (const JointEffect& effect : fit.model.effects) {
    if (effect.kind != JointEffect::Kind::play) continue;
    const bool unseen = std::any_of(poses.begin(), poses.end(), [&](const Pose& pose) {
      return pose.senses[effect.joint] == 0;
    });
    if (unseen)
      variances[effect.joint] = std::max(fit.noise.play_rad * fit.noise.play_rad / 2,
                                         effect.size.x() * effect.size.x() / 4);
  }
  return variances;
}

/// The same as add_turns_at_home(), of the fit's parameters.
MatrixXd turns_of_parameters(const ChainEstimate& estimate, const PoseFit& fit,
                             const std::vector<double>& variances) {
  MatrixXd turns = MatrixXd::Zero(fit.covariance.rows(), fit.covariance.cols());
  std::vector<bool> known;
  for (const auto& axis : estimate.axes) known.push_back(axis.has_value());
  const MatrixXd map = to_estimate(estimate.chain, fit.with_orientation);
  const Eigen::LDLT<MatrixXd> normal(map.transpose() * map);
  const Index count = map.cols();
  for (std::size_t j = 0; j < variances.size(); ++j) {
    if (!known[j] || !(variances[j] > 0)) continue;
    const VectorXd turn = normal.solve(
        map.transpose() * by_turn_at_home(estimate.chain, j, known,
                                          estimate.chain.targets_mm.size(), fit.with_orientation));
    turns.topLeftCorner(count, count) += variances[j] * turn * turn.transpose();
  }
  return turns;
}

/// What distances between targets that were seen from one stand vary by, from stand to stand. The
/// tool is rigid: whatever the angles are like, positions that were computed do not vary so.
double distances_vary_mm(const PoseEstimate& found) {
  std::map<std::pair<std::size_t, std::size_t>, std::vector<double>> distances_mm;
  for (const Stand& stand : found.fit.stands)
    for (const std::size_t a : stand)
      for (const std::size_t b : stand) {
        const Pose &one = found.poses[a], &other = found.poses[b];
        if (one.target < other.target && found.fit.weights(static_cast<Index>(a)) > 0.5 &&
            found.fit.weights(static_cast<Index>(b)) > 0.5)
          distances_mm[{one.target, other.target}].push_back(
              (one.sample.position_mm - other.sample.position_mm).norm());
      }
  double squares = 0, free = 0;
  for (const auto& [pair, all] : distances_mm) {
    const Eigen::Map<const VectorXd> of(all.data(), static_cast<Index>(all.size()));
    squares += (of.array() - of.mean()).square().sum();
    free += static_cast<double>(all.size() - 1);
  }
  return free > 0 ? std::sqrt(squares / free) : 0;
}

/// Whether nothing excludes that the positions were computed from the angles: what is left is what
/// printing leaves, and neither the noise of positions nor that of joints is larger than rounded
/// angles may make it seem, nor do distances between targets vary.
bool may_be_computed(const PoseEstimate& found, const Resolution& resolution) {
  const double step_mm = kComputed_mm + resolution.position_mm;
  const double angle_rad = kEvenlySpread * resolution.angle_rad;
  constexpr double kMostOfJoints = 1.5;  // of 144 files of computed poses it was 1.2 at most
  return found.left.rms_mm < step_mm + kMetre_mm * resolution.angle_rad &&
         found.fit.noise.position_mm < step_mm + kMetre_mm * angle_rad &&
         found.fit.noise.joint_rad < kMostOfJoints * angle_rad + step_mm / kMetre_mm &&
         distances_vary_mm(found) < step_mm;
}

}  // namespace

Left left_of(const VectorXd& distances_mm) {
  if (distances_mm.size() == 0) return {};
  return {distances_mm.mean(),
          distances_mm.norm() / std::sqrt(static_cast<double>(distances_mm.size())),
          distances_mm.maxCoeff()};
}

double middle_left_mm(const PoseFit& fit) {
  VectorXd distances(static_cast<Index>(fit.rows.size()));
  for (Index i = 0; i < distances.size(); ++i)
    distances(i) = fit.rows[static_cast<std::size_t>(i)].off.head<3>().norm();
  return middle_of(distances);
}

Eigen::Matrix3d PoseEstimate::covariance_at(const Pose& pose) const {
  const PoseRow row = pose_row(fit.model, pose, false);
  const MatrixXd of = whole_covariance();
  return row.by_parameter * of * row.by_parameter.transpose() +
         fit.noise.covariance(row.by_own).topLeftCorner<3, 3>() +
         play_covariance(fit.model, pose, row);
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
  const std::vector<std::size_t> different = different_poses(poses);
  Index rows = 0;
  for (const std::size_t i : different) rows += poses[i].sample.has_orientation ? 6 : 3;
  const Index unknowns = parameters.count(oriented);
  if (!whole(sweeps) && rows < unknowns + kSpareRows) {
    const Index each = oriented ? 6 : 3;
    const std::string distinct = different.size() < poses.size() ? "different " : "";
    reason = std::to_string(different.size()) + " " + distinct + "poses give " +
             std::to_string(rows) + " numbers for " + std::to_string(unknowns) +
             " unknowns: measure at least " +
             std::to_string((unknowns + kSpareRows + each - 1) / each) + " " + distinct +
             "poses, better 30";
    return std::nullopt;
  }

  const PoseStart start = pose_start(poses, campaign, sweeps, home, targets);
  std::optional<FromSweeps> known;
  std::optional<ChainPrior> prior;
  if (sweeps != nullptr) {
    known = from_sweeps(*sweeps, targets);
    prior = known->prior;
  }
  PoseNoise noise;
  noise.position_mm = std::max(kLeastStart_mm, start.middle_mm / 2);
  noise.joint_rad = noise.position_mm / kMetre_mm;
  if (!start.model.effects.empty()) noise.play_rad = kStartPlay_rad;
  noise.orientation_rad = oriented ? kStartOrientation_rad : 0;
  PoseEstimate found;
  EffectsFit with_effects = fitted_with_effects(start.model, noise, poses, oriented, prior);
  found.fit = std::move(with_effects.fit);
  found.effects = std::move(with_effects.effects);
  widen(found.fit, poses, prior);
  for (EffectEvidence& one : found.effects) one.sigma *= std::sqrt(found.fit.widened);
  found.with_sweeps = sweeps != nullptr;
  if (found.with_sweeps) found.weights_unsure_rad = weights_unsure_rad(found.fit, poses, prior);
  if (const Index spare = rows - unknowns; sweeps != nullptr && spare >= kSpareRows) {
    const PoseFit alone = fitted(start.model, noise, poses, oriented, std::nullopt);
    found.left_alone_mm =
        middle_left_mm(alone) * std::sqrt(static_cast<double>(rows) / static_cast<double>(spare));
  }
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
  found.poses = poses;
  found.computed = may_be_computed(found, campaign.resolution);
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
  found.observability = observability_of(found.fit);
  found.drift = drift_of(found.fit);
  found.step = step_in(found.fit, poses);
  found.beside = MatrixXd::Zero(found.fit.covariance.rows(), found.fit.covariance.cols());
  const Index fixed = found.fit.model.fixed_parameters();
  if (found.drift.seen) found.beside.topLeftCorner(fixed, fixed) += drift_spread(found.fit);
  if (found.step.seen)
    found.beside.topLeftCorner(fixed, fixed) += found.step.bias * found.step.bias.transpose();
  found.chain = chain_of(found.fit, known, found.beside);
  const std::vector<double> sides = variances_of_sides(found.fit, poses);
  found.beside += turns_of_parameters(found.chain, found.fit, sides);
  add_turns_at_home(found.chain, sides);
  return found;
}

}  // namespace identify
