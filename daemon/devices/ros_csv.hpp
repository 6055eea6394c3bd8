#pragma once

#include "daemon/devices/device_layout.hpp"
#include "daemon/devices/device_text.hpp"

namespace sweepd {

// Poses of ROS, with commas: geometry_msgs/PoseStamped and messages that hold one (with covariance,
// Odometry, TransformStamped, PointStamped). Source: ROS wiki, rostopic echo -p; ros2cli, ros2
// topic echo --csv; definitions of geometry_msgs; REP 103 for metres.
//
// `rostopic echo -p` names the columns, with % in front: field.header.stamp in nanoseconds,
// field.pose.position.x ... and field.pose.orientation.w. Names of rosbag's converters, with
// header.stamp.secs and .nsecs, are understood too. `ros2 topic echo --csv` names none: seconds,
// nanoseconds, frame, position, and the quaternion x, y, z, w. Times are those of the header; where
// it has none, those of reception.

[[nodiscard]] bool is_ros_csv(const DeviceText& text);
[[nodiscard]] DeviceLayout ros_layout(const DeviceText& text);

}  // namespace sweepd
