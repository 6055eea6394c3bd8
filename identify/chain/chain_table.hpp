#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "identify/chain/chain_estimate.hpp"
#include "identify/dh/dh_extraction.hpp"
#include "identify/sweeps/campaign.hpp"

namespace identify {

/// Places the axes of the estimate's linear joints, its covariance and parts included. Arms that
/// only turn stay as they are.
void place_linear_axes(ChainEstimate& estimate, const Campaign& campaign,
                       const std::vector<DhRow>& specified);

/// The Z axes of a chain's DH table: as the specified table turns them, or along positive rotation.
/// Where the tool's orientation was measured, the Z axis of the tool's frame is one more, behind
/// the last joint's.
struct TableAxes {
  std::vector<std::optional<Axis>> z;
  Eigen::MatrixXd covariance;   ///< of all (direction, point), six rows an axis
  Eigen::MatrixXd by_estimate;  ///< how these change with what the estimate's covariance is of
  Eigen::MatrixXd by_target;    ///< as in ChainEstimate
  double size_mm = 0;           ///< of the arm: the largest distance between axes, targets
  /// Along the last axis: how far it is open how high the base stands, as in ChainEstimate.
  Eigen::Vector3d height_open_mm = Eigen::Vector3d::Zero();
  /// Of the frame in which `z` is, in the measurement frame; directions are alike.
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();
};
[[nodiscard]] TableAxes table_axes(const ChainEstimate& chain, const Campaign& campaign);

/// The same as `seen_from_base` has them (see base_height.hpp), for points in a device's frame.
[[nodiscard]] TableAxes at_base(TableAxes axes, std::size_t joints,
                                const std::vector<DhRow>& specified);

/// The DH table, one row a joint; the last is zero by convention. `specified` has one row a joint
/// or none.
[[nodiscard]] std::vector<DhEstimate> table_of(const TableAxes& axes, std::size_t joints,
                                               const std::vector<DhRow>& specified);

/// The same of points in a device's frame: what depends on where the base stands is by convention.
[[nodiscard]] std::vector<DhEstimate> device_table_of(const TableAxes& axes, std::size_t joints,
                                                      const std::vector<DhRow>& specified);

/// Where the measurement frame is a device's: b and theta of row 1 tell where it stands, not how
/// the arm is made, and are by convention as specified (zero without a specified table).
void leave_first_to_frame(std::vector<DhEstimate>& table, const std::vector<DhRow>& specified);

/// What the last row is where it leads to the Z axis of the tool's frame; nothing where the tool's
/// orientation was not measured. In a device's frame, what hangs on the base's height is by
/// convention, `axes` being those of `at_base`.
[[nodiscard]] std::optional<DhEstimate> row_to_tool(const TableAxes& axes, std::size_t joints,
                                                    const std::vector<DhRow>& specified,
                                                    bool device_frame);

/// Where the robot's base stands in the measurement frame.
struct RobotPose {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Eigen::Vector3d position_sigma_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation_sigma_rad =
      Eigen::Vector3d::Zero();  ///< about the measurement frame's X, Y, Z
};

/// Such that b and theta of row 1 are as specified, or zero without a specified table. Nothing
/// without the first two axes.
[[nodiscard]] std::optional<RobotPose> robot_pose(const TableAxes& axes,
                                                  const std::vector<DhRow>& specified);

/// The tool in the frame behind the last row, that row taken as specified (zero without a specified
/// table); its rotation means something only where it was measured. Nothing if another number of
/// the table is undetermined.
[[nodiscard]] std::optional<Eigen::Isometry3d> tool_pose(const ChainEstimate& chain,
                                                         const TableAxes& axes,
                                                         const std::vector<DhEstimate>& table,
                                                         const std::vector<DhRow>& specified);

}  // namespace identify
