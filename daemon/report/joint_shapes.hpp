#pragma once

#include <vector>

#include <Eigen/Core>

#include "daemon/report/report_folder.hpp"

namespace sweepd {

/// What figures in space show of one joint, mm. Not numbers where the result has nothing.
struct JointShape {
  static inline const Eigen::Vector3d kNowhere = Eigen::Vector3d::Constant(kNothing);

  std::size_t index = 0;              ///< from 0
  Eigen::Vector3d centre = kNowhere;  ///< of the circle; of a linear joint a point of its line
  Eigen::Vector3d normal = kNowhere;
  double radius = 0;
  double length = 0;  ///< of the line of a linear joint
  Eigen::Vector3d on_axis = kNowhere;
  Eigen::Vector3d along_axis = kNowhere;
  std::vector<Eigen::Vector3d> circle;  ///< drawn whole
  std::vector<Eigen::Vector3d> moved;   ///< measured points of all strokes
};

[[nodiscard]] std::vector<JointShape> joint_shapes(const ReportFolder& folder);

/// The arm as its axes have it at home: from the foot of the first axis along the common
/// perpendiculars to the target. Empty where an axis is missing or has no place.
[[nodiscard]] std::vector<Eigen::Vector3d> arm_at_home(const ReportFolder& folder,
                                                       const std::vector<JointShape>& shapes);

}  // namespace sweepd
