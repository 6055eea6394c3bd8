#pragma once

#include <vector>

#include <Eigen/Core>

#include "identify/poses/pose_model.hpp"

namespace identify {

/// Some hundred poses of an identified arm, where its model has them: each the first joints of one
/// measured pose and the last three of another. What a controller cannot hold is no noise, and in a
/// few poses it asks for numbers that help there and nowhere else. `weights`: one a measured pose,
/// those of 0 are left out.
[[nodiscard]] std::vector<Pose> combined_poses(const PoseModel& model,
                                               const std::vector<Pose>& measured,
                                               const Eigen::VectorXd& weights);

/// How they change with the model's parameters: three rows a pose.
[[nodiscard]] Eigen::MatrixXd by_parameter(const PoseModel& model, const std::vector<Pose>& poses);

}  // namespace identify
