#include "identify/poses/pose_stands.hpp"

#include <algorithm>
#include <map>

namespace identify {

using Eigen::Index;
using Eigen::MatrixXd;

std::vector<Stand> stands_of(const std::vector<Pose>& poses) {
  std::vector<Stand> stands;
  std::map<decltype(Sample::angles_rad), std::size_t> newest;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto [at, first] = newest.try_emplace(poses[i].sample.angles_rad, stands.size());
    const bool again = !first && std::any_of(stands[at->second].begin(), stands[at->second].end(),
                                             [&](std::size_t other) {
                                               return poses[other].target == poses[i].target;
                                             });
    if (again) at->second = stands.size();
    if (first || again) stands.emplace_back();
    stands[at->second].push_back(i);
  }
  return stands;
}

StandRows::StandRows(const PoseNoise& noise, const std::vector<PoseRow>& rows,
                     const Eigen::VectorXd& weights, const Stand& stand) {
  Index count = 0;
  for (const std::size_t i : stand) {
    if (!(weights(static_cast<Index>(i)) > 0)) continue;
    poses.push_back(i);
    count += rows[i].off.size();
  }
  if (poses.empty()) return;
  const PoseRow& first = rows[poses.front()];
  MatrixXd by_parameter(count, first.by_parameter.cols()), by_own(count, first.by_own.cols());
  off.resize(count);
  Index at = 0;
  for (const std::size_t i : poses) {
    const Index own = rows[i].off.size();
    by_parameter.middleRows(at, own) = rows[i].by_parameter;
    by_own.middleRows(at, own) = rows[i].by_own;
    off.segment(at, own) = rows[i].off;
    at += own;
  }
  by_position = MatrixXd::Zero(count, count);
  by_orientation = by_position;
  by_joints = by_own * by_own.transpose();
  at = 0;
  for (const std::size_t i : poses) {
    const Index own = rows[i].off.size();
    const double larger = 1 / weights(static_cast<Index>(i));
    by_position.diagonal().segment(at, 3).setConstant(larger);
    by_orientation.diagonal().segment(at + 3, own - 3).setConstant(larger);
    by_joints.block(at, at, own, own) *= larger;
    at += own;
  }
  const auto square = [](double sigma) { return sigma * sigma; };
  root.compute(square(noise.position_mm) * by_position +
               square(noise.orientation_rad) * by_orientation +
               square(noise.joint_rad) * by_joints);
  for (Index p = 0; p < by_parameter.cols(); ++p)
    if (!by_parameter.col(p).isZero(0)) parameters.push_back(p);
  columns = root.matrixL().solve(MatrixXd(by_parameter(Eigen::all, parameters))).transpose();
  root.matrixL().solveInPlace(off);
}

}  // namespace identify
