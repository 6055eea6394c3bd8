#pragma once

#include "daemon/devices/device_layout.hpp"
#include "daemon/devices/device_text.hpp"

namespace sweepd {

// The formats of makers' programs: whether a file is of one, by its first lines, and where in it
// which value stands.

// OptiTrack Motive, "Export Tracking Data" as CSV, format versions 1.2 to 1.25 (Motive 1.9 to 3.x).
// Source: OptiTrack's documentation, "Data Export: CSV" (Motive 2.1, 3.0, 3.1), and its knowledge
// base, "Changes in Motive's Reported Euler Angles".
//
// The first line has metadata in pairs: Length Units, Export Frame Rate, Rotation Type. Then come
// rows of type, name, ID, perhaps parent, and of what a column is, until the one that begins with
// Frame. Empty cells were not seen. Quaternions are X, Y, Z, W. Angles turn about the body's own
// axes in the order that Rotation Type names.
//
// Targets are the labelled markers as they were seen, and rigid bodies without three markers in the
// file. Left out are bodies with them (their poses are made of these), markers as a body's model
// has them ("Rigid Body Marker": they stand still where nothing was seen), skeletons, and markers
// without a label where there are others.

[[nodiscard]] bool is_motive_csv(const DeviceText& text);
[[nodiscard]] DeviceLayout motive_layout(const DeviceText& text);

// NDI ToolBox (Polaris, Aurora), tracking data as CSV, and NDI First Principles (Optotrak), text
// with tabs or commas. Source: a file of ToolBox as a public reader of it has it (columns, states,
// -3.697314E28 for what was not measured), NDI's Combined API for the quaternion's order, and the
// exported file of the public project otaithleigh/optotrak (First Principles).
//
// ToolBox: one row names the columns. A tool begins with Port, then Frame, perhaps Time [sec],
// Face, State, Q0 (w), Qx, Qy, Qz, Tx, Ty, Tz in mm, Error, Markers, and State, Tx, Ty, Tz of each
// marker. What has another state than OK was not measured. Without times, frames count sixtieths of
// a second, as Polaris counts them. Markers of a tool are targets where there are three or more,
// the tool else.
//
// First Principles: Number of frames, Frequency and Units, an empty line, then Frame and NAME x,
// NAME y, NAME z of each marker, or NAME q0, qx, qy, qz too.

[[nodiscard]] bool is_ndi_csv(const DeviceText& text);
[[nodiscard]] DeviceLayout ndi_layout(const DeviceText& text);

// Qualisys Track Manager, export to TSV of 3D and of 6DOF data. Source: QTM's manual, "Motion data
// (.tsv)" and "Rotation angles in QTM" (file version 2.0.0 and before), and a 6D file of the public
// project shiplab/dt_cv.
//
// The header has a name and its values in each line: FREQUENCY, DATA_INCLUDED, MARKER_NAMES or
// BODY_NAMES. Then comes perhaps a row that names the columns, then the data, with frame and time
// in front or without. Positions are in mm. A target that was not seen is empty, null, or at 0, 0,
// 0. A body has position, roll, pitch, yaw, residual, and its rotation matrix, column by column.

[[nodiscard]] bool is_qtm_tsv(const DeviceText& text);
[[nodiscard]] DeviceLayout qtm_layout(const DeviceText& text);

// Poses of ROS, with commas: geometry_msgs/PoseStamped and messages that hold one (with covariance,
// Odometry, TransformStamped, PointStamped). Source: ROS wiki, rostopic echo -p; ros2cli, ros2
// topic echo --csv; definitions of geometry_msgs; REP 103 for metres.
//
// `rostopic echo -p` names the columns, with % in front: field.header.stamp in nanoseconds,
// field.pose.position.x ... and field.pose.orientation.w. Names of rosbag's converters, with
// header.stamp.secs and .nsecs, are understood too, and PlotJuggler's, with slashes and __time.
// Stamps with decimals are seconds. `ros2 topic echo --csv` names none: seconds,
// nanoseconds, frame, position, and the quaternion x, y, z, w. Times are those of the header; where
// it has none, those of reception.

[[nodiscard]] bool is_ros_csv(const DeviceText& text);
[[nodiscard]] DeviceLayout ros_layout(const DeviceText& text);

// Vicon Nexus ("Export ASCII") and Vicon Tracker, CSV or with semicolons. Source: files of both
// programs in public projects and their readers: ccu.uni-konstanz.de (Nexus, Tracker trajectories),
// ic.unicamp.br/~stolfi (Nexus), readers of Tracker's RX, RY, RZ, RW.
//
// A file has sections with an empty line between. Each has its name (Trajectories, Objects,
// Segments), its rate in Hz, the targets' names, the names of the columns (Frame, Sub Frame, X, Y,
// Z or RX ... TX ...), units, and the data; frames are turned into times by the rate. Trajectories
// are taken, or else Objects, or else Segments. RX, RY, RZ, RW are a quaternion. RX, RY, RZ alone
// may be Euler angles or a helical axis: the file does not tell, so they are left out. Markers that
// Nexus numbers ("*12") are left out where others have names.

[[nodiscard]] bool is_vicon_csv(const DeviceText& text);
[[nodiscard]] DeviceLayout vicon_layout(const DeviceText& text);

// Tables with a line for each point, as programs of laser trackers and measuring arms write them:
// SpatialAnalyzer, PolyWorks, Leica (T-Mac, AT9x0), FARO CAM2. Users choose their columns, so the
// columns are known by their names: X, Y, Z with or without a unit ("X (mm)", "Measured X"), Q0 to
// Q3 (w first) or QX ... QW, Time, Timestamp, Date, Name, Group, Collection, Reflector. What has
// another name is passed over.
//
// Source: SpatialAnalyzer's manual, "Exporting ASCII Formatted Points" (names of collection, group
// and target, coordinates, then options; // before comments; blanks or commas), exported files of
// the public project FinnLinxxx/akig; manuals of PolyWorks and CAM2 leave the columns to the user.
//
// Without names of columns, SpatialAnalyzer's order counts: names, x, y, z, more. Units stand in
// the names of columns, in a row below, or in a line with the word unit; else millimetres are
// assumed, and said to be.
//
// A group that is named as a joint ("Joint 3", "A3") tells which joint moves; other groups are
// targets, and so are reflectors. Points without a group are of one target, unless the same names
// come again and again. Date and time count where points are dense enough to be a stream.

[[nodiscard]] bool is_spatial_analyzer_text(const DeviceText& text);
[[nodiscard]] bool is_polyworks_text(const DeviceText& text);
[[nodiscard]] bool is_leica_csv(const DeviceText& text);
[[nodiscard]] bool is_faro_csv(const DeviceText& text);
/// Of no known maker; units or a quaternion tell it from sweepd's own columns.
[[nodiscard]] bool is_tracker_table(const DeviceText& text);

[[nodiscard]] DeviceLayout tracker_layout(const DeviceText& text);

}  // namespace sweepd
