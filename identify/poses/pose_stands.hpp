#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "identify/poses/pose_rows.hpp"

namespace identify {

/// Poses of different targets that were seen where the arm stood at the same angles, digit for
/// digit: what joints are off there, all of them show alike.
using Stand = std::vector<std::size_t>;

/// Each pose is of one of them. They come in the order of their first poses.
[[nodiscard]] std::vector<Stand> stands_of(const std::vector<Pose>& poses);

/// The rows of a stand's poses that count, one pose below the other, divided by their standard
/// deviations. Their covariance (PoseNoise) is
///   V = position^2 by_position + orientation^2 by_orientation + joint^2 by_joints,
/// in which a pose that counts less has a variance so much larger. A joint stands at one place of
/// many: most of the model's parameters do nothing to a stand.
struct StandRows {
  StandRows(const PoseNoise& noise, const std::vector<PoseRow>& rows,
            const Eigen::VectorXd& weights, const Stand& stand);

  /// What a fit with this covariance takes up of the rows.
  [[nodiscard]] Eigen::MatrixXd taken_up(const Eigen::MatrixXd& covariance) const {
    return columns.transpose() * covariance(parameters, parameters) * columns;
  }
  /// V^-1 of what is divided already by the standard deviations once.
  [[nodiscard]] Eigen::MatrixXd divided_again(const Eigen::MatrixXd& once) const {
    return root.matrixU().solve(once);
  }

  Stand poses;                           ///< that count
  std::vector<Eigen::Index> parameters;  ///< that do something
  Eigen::MatrixXd columns;  ///< transposed: one row a parameter, one column a row of the poses
  Eigen::VectorXd off;
  Eigen::MatrixXd by_position, by_orientation, by_joints;
  Eigen::LLT<Eigen::MatrixXd> root;  ///< of V
};

}  // namespace identify
