#include "identify/chain/home_turn.hpp"

#include <algorithm>
#include <utility>

#include "identify/geometry/angle.hpp"

namespace identify {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

VectorXd by_turn_at_home(const Chain& at_home, std::size_t joint, const std::vector<bool>& known,
                         std::size_t targets, bool with_orientation) {
  const std::size_t joints = at_home.axes.size();
  const ChainAxis& turning = at_home.axes[joint];
  const Vector3d turns = turning.linear ? Vector3d(Vector3d::Zero()) : turning.direction;
  const auto moves = [&](const Vector3d& point) -> Vector3d {
    if (turning.linear) return kLinear_mm * turning.direction;
    return turns.cross(point - turning.point_mm);
  };
  const auto tool = static_cast<Index>(6 * joints + 3 * targets);
  VectorXd change = VectorXd::Zero(tool + (with_orientation ? 3 : 0));
  for (std::size_t j = joint + 1; j < joints; ++j) {
    const auto row = static_cast<Index>(6 * j);
    change.segment<3>(row) = turns.cross(at_home.axes[j].direction);
    change.segment<3>(row + 3) = moves(at_home.axes[j].point_mm);
  }
  for (std::size_t t = 0; t < targets; ++t)
    change.segment<3>(static_cast<Index>(6 * joints + 3 * t)) = moves(at_home.targets_mm[t]);
  // A linear joint's place is the first target's.
  for (std::size_t j = 0; j <= joint; ++j)
    if (known[j] && at_home.axes[j].linear)
      change.segment<3>(static_cast<Index>(6 * j + 3)) = moves(at_home.targets_mm.front());
  if (with_orientation) change.segment<3>(tool) = turns;
  return change;
}

void add_turns_at_home(ChainEstimate& estimate, const std::vector<double>& variances) {
  if (std::none_of(variances.begin(), variances.end(), [](double one) { return one > 0; })) return;
  const std::vector<bool> known = known_of(estimate.axes);
  MatrixXd added = MatrixXd::Zero(estimate.covariance.rows(), estimate.covariance.cols());
  for (std::size_t j = 0; j < known.size(); ++j) {
    if (!known[j] || !(variances[j] > 0)) continue;
    const VectorXd turn = by_turn_at_home(
        estimate.chain, j, known, estimate.chain.targets_mm.size(), estimate.with_orientation);
    added.noalias() += variances[j] * turn * turn.transpose();
  }
  estimate.covariance += added;
  const auto home = std::find_if(estimate.parts.begin(), estimate.parts.end(),
                                 [](const auto& part) { return part.cause == Cause::home; });
  if (home == estimate.parts.end())
    estimate.parts.push_back({Cause::home, std::move(added)});
  else
    home->covariance += added;
  for (std::size_t j = 0; j < known.size(); ++j)
    if (known[j])
      estimate.axes[j]->covariance =
          estimate.covariance.block<6, 6>(static_cast<Index>(6 * j), static_cast<Index>(6 * j));
}

std::vector<double> play_variances(const std::vector<AngleEvidence>& angles) {
  std::vector<double> variances;
  for (const AngleEvidence& seen : angles) {
    const double play = seen.backlash_rad, chance = seen.backlash_sigma_rad;
    variances.push_back(
        seen.trust == AngleTrust::trusted ? 0 : std::max(0.0, play * play - chance * chance) / 4);
  }
  return variances;
}

}  // namespace identify
