#include "identify/correction/combined_poses.hpp"

#include <algorithm>
#include <utility>

#include "identify/poses/pose_rows.hpp"

namespace identify {

constexpr std::size_t kCombined = 600;

std::vector<Pose> combined_poses(const PoseModel& model, const std::vector<Pose>& measured,
                                 const Eigen::VectorXd& weights) {
  std::vector<const Pose*> count;
  for (std::size_t i = 0; i < measured.size(); ++i)
    if (weights(static_cast<Eigen::Index>(i)) > 0) count.push_back(&measured[i]);
  const std::size_t rounds =
      std::max<std::size_t>(1, kCombined / std::max<std::size_t>(1, count.size()));
  const std::size_t joints = model.chain.axes.size();
  const std::size_t first = joints - std::min<std::size_t>(3, joints / 2);
  std::vector<Pose> poses;
  for (std::size_t round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < count.size(); ++i) {
      Pose pose = *count[i];
      const Pose& wrist = *count[(i + 1 + round * count.size() / rounds) % count.size()];
      for (std::size_t j = first; j < joints; ++j)
        pose.sample.angles_rad[j] = wrist.sample.angles_rad[j];
      pose.target = wrist.target;
      pose.sample.position_mm = model.position_mm(pose);
      poses.push_back(std::move(pose));
    }
  return poses;
}

Eigen::MatrixXd by_parameter(const PoseModel& model, const std::vector<Pose>& poses) {
  Eigen::MatrixXd rows(3 * static_cast<Eigen::Index>(poses.size()), model.parameters());
  for (std::size_t i = 0; i < poses.size(); ++i)
    rows.middleRows<3>(3 * static_cast<Eigen::Index>(i)) =
        pose_row(model, poses[i], false).by_parameter.topRows<3>();
  return rows;
}

}  // namespace identify
