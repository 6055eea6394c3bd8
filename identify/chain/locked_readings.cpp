#include "identify/chain/locked_readings.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Less than one by so many standard deviations, or all is believed.
constexpr double kSurely = 4;

/// Joints that scatter by more steps than these have readings that tell it.
constexpr double kMostScatter = 3;

/// The share of each locked joint's readings, and its standard deviation: least squares of the
/// departures over the readings, both about the means of the nodes. Of a joint whose readings are
/// all the same, one.
struct Shares {
  VectorXd share;
  VectorXd sigma;
};

Shares shares_in(const StrokeMoments& stroke, std::size_t first, const ChainNodes& nodes,
                 const Chain& chain, const ChainNoise& noise) {
  const auto joints = static_cast<Index>(stroke.content.joints);
  const Index begin = 1 + (stroke.content.orientation ? 6 : 3);
  MatrixXd normal = MatrixXd::Zero(joints, joints);
  VectorXd right = VectorXd::Zero(joints);
  ChainPose pose(chain);
  for (std::size_t n = 0; n < stroke.nodes.size(); ++n) {
    const MatrixXd& sums = stroke.nodes[n].sums;
    if (!(sums(0, 0) > 0)) continue;
    const ChainObservation& seen = nodes.observations[first + n];
    pose.set(seen.target, turns_of(chain, seen, noise), false);
    ChainResidual<3> residual;
    residual.set(chain, seen, pose, noise);
    Eigen::Matrix3Xd by_turn = Eigen::Matrix3Xd::Zero(3, joints);
    for (Index k = 0; k < joints; ++k)
      if (const auto joint = static_cast<std::size_t>(k); joint != seen.joint && nodes.known[joint])
        by_turn.col(k) = pose.by_turn[joint].head<3>();
    const MatrixXd about_mean = sums - sums.col(0) * sums.row(0) / sums(0, 0);
    const MatrixXd weighted = residual.weight * by_turn;
    normal += (by_turn.transpose() * weighted)
                  .cwiseProduct(about_mean.block(begin, begin, joints, joints));
    const Eigen::Matrix3Xd departures = stroke.directions(stroke.nodes[n].turn_rad).transpose() *
                                        about_mean.block(1, begin, 3, joints);
    right += weighted.cwiseProduct(departures).colwise().sum().transpose();
  }
  Shares found{VectorXd::Ones(joints), VectorXd::Zero(joints)};
  const VectorXd scale = normal.diagonal().cwiseMax(0).cwiseSqrt();
  if (!(scale.maxCoeff() > 0)) return found;
  for (Index k = 0; k < joints; ++k) {
    const double by = scale(k) > 0 ? 1 / scale(k) : 0;
    normal.row(k) *= by;
    normal.col(k) *= by;
    right(k) *= by;
    // Joints whose readings did the same share.
    normal(k, k) += by > 0 ? 1e-6 : 1;
  }
  const Eigen::LDLT<MatrixXd> solver(normal);
  const VectorXd slope = solver.solve(right);
  const MatrixXd inverse = solver.solve(MatrixXd::Identity(joints, joints));
  for (Index k = 0; k < joints; ++k)
    if (scale(k) > 0) {
      found.share(k) = slope(k) / scale(k);
      found.sigma(k) = std::sqrt(stroke.correlation * std::max(0.0, inverse(k, k))) / scale(k);
    }
  return found;
}

/// Root mean square of what stands at this place of the nodes' sums.
double scatter(const StrokeMoments& stroke, Index at) {
  double squares = 0;
  for (const StrokeMoments::Node& node : stroke.nodes) squares += node.sums(at, at);
  return std::sqrt(std::max(0.0, squares) / stroke.weight);
}

/// `seen`: of the stroke's nodes; `at`: the joint's place in their sums.
void discount(StrokeMoments& stroke, ChainObservation* seen, Index joint, Index at, double share) {
  double sum = 0, weight = 0;
  for (std::size_t n = 0; n < stroke.nodes.size(); ++n) {
    sum += seen[n].weight * seen[n].turns[static_cast<std::size_t>(joint)];
    weight += seen[n].weight;
  }
  // Where the stroke's mean, and that of home, are off by no more than the steps make by chance.
  const double off_home = sum / weight;
  const double by_chance =
      kSurely * scatter(stroke, at) * std::sqrt(2 * stroke.correlation / weight);
  const double level = std::abs(off_home) <= by_chance ? off_home : 0;
  for (std::size_t n = 0; n < stroke.nodes.size(); ++n) {
    Eigen::MatrixXd& sums = stroke.nodes[n].sums;
    const double mean = sums(0, 0) > 0 ? sums(at, 0) / sums(0, 0) : 0;
    seen[n].turns[static_cast<std::size_t>(joint)] -= (1 - share) * (level + mean);
    sums.row(at) *= share;
    sums.col(at) *= share;
  }
}

}  // namespace

bool discount_readings(ChainNodes& nodes, const Chain& chain, const ChainNoise& noise,
                       double step_rad) {
  bool any = false;
  if (!(step_rad > 0)) return any;
  for (std::size_t s = 0; s < nodes.strokes.size(); ++s) {
    StrokeMoments& stroke = nodes.strokes[s];
    if (!stroke.squares || stroke.content.joints == 0) continue;
    const Shares found = shares_in(stroke, nodes.first[s], nodes, chain, noise);
    const Index begin = 1 + (stroke.content.orientation ? 6 : 3);
    for (Index k = 0; k < found.share.size(); ++k) {
      if (!(found.share(k) < 1 - kSurely * found.sigma(k)) || found.sigma(k) == 0) continue;
      if (scatter(stroke, begin + k) > kMostScatter * step_rad) continue;
      any = true;
      discount(stroke, &nodes.observations[nodes.first[s]], k, begin + k,
               std::max(0.0, found.share(k)));
    }
  }
  return any;
}

}  // namespace identify
