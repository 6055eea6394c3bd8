#pragma once

// A take of three markers and a body that move, and the files that devices' programs leave of it:
// columns, units, signs of what was not seen, as the sources of the formats' headers show them.

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <spdlog/fmt/fmt.h>

namespace sweepd::test {

struct Frame {
  double time_s = 0;
  std::vector<std::optional<Eigen::Vector3d>> markers_mm;
  Eigen::Vector3d body_mm = Eigen::Vector3d::Zero();
  Eigen::Quaterniond body_turn = Eigen::Quaterniond::Identity();
};

struct Take {
  double rate_hz = 100;
  std::vector<std::string> names;
  std::vector<Frame> frames;
};

/// Anything that moves smoothly, with one marker that is hidden for two frames.
inline Take some_take(std::size_t frames = 20) {
  Take take;
  take.names = {"Tool:m1", "Tool:m2", "Tool:m3"};
  for (std::size_t i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) / take.rate_hz;
    Frame frame;
    frame.time_s = t;
    frame.body_mm = {1200 + 300 * std::cos(t), -450 + 300 * std::sin(t), 801.25 + 40 * t};
    frame.body_turn = Eigen::AngleAxisd(0.3 + t, Eigen::Vector3d(1, 2, -2).normalized());
    for (const Eigen::Vector3d& place :
         {Eigen::Vector3d(80, 0, 10), Eigen::Vector3d(-30, 60, 0), Eigen::Vector3d(-20, -70, 5)})
      frame.markers_mm.emplace_back(frame.body_mm + frame.body_turn * place);
    if (i == 3 || i == 4) frame.markers_mm[1].reset();
    take.frames.push_back(std::move(frame));
  }
  return take;
}

/// What of a take a file has.
enum class Of { markers, body };

/// Six decimals of the unit, or as many empty fields.
inline std::string xyz_text(const std::optional<Eigen::Vector3d>& mm, double unit_mm,
                            const std::string& separator, const std::string& missing = "") {
  if (!mm) return missing + separator + missing + separator + missing;
  return fmt::format("{:.6f}{}{:.6f}{}{:.6f}", mm->x() / unit_mm, separator, mm->y() / unit_mm,
                     separator, mm->z() / unit_mm);
}

inline std::string xyzw_text(const Eigen::Quaterniond& q, const std::string& separator) {
  return fmt::format("{:.8f}{}{:.8f}{}{:.8f}{}{:.8f}", q.x(), separator, q.y(), separator, q.z(),
                     separator, q.w());
}

inline std::string wxyz_text(const Eigen::Quaterniond& q, const std::string& separator) {
  return fmt::format("{:.8f}{}{:.8f}{}{:.8f}{}{:.8f}", q.w(), separator, q.x(), separator, q.y(),
                     separator, q.z());
}

inline std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t k = 0; k < times; ++k) all += text;
  return all;
}

/// Motive 2.x, metres, version 1.23.
inline std::string motive_file(const Take& take, Of of) {
  std::string type = ",", name = ",", id = ",", component = ",", axis = "Frame,Time (Seconds)";
  const auto add = [&](const std::string& t, const std::string& n, const std::string& c,
                       const std::string& axes) {
    for (const char a : axes) {
      type += "," + t;
      name += "," + n;
      id += "," + n.substr(n.size() - 1) + "F01";
      component += "," + c;
      axis += a == ' ' ? std::string(",") : std::string(",") + a;
    }
  };
  if (of == Of::body) {
    add("Rigid Body", "Tool", "Rotation", "XYZW");
    add("Rigid Body", "Tool", "Position", "XYZ");
    add("Rigid Body", "Tool", "Mean Marker Error", " ");
    add("Rigid Body Marker", "Tool:Marker1", "Position", "XYZ");
    add("Rigid Body Marker", "Tool:Marker1", "Marker Quality", " ");
  } else {
    for (const auto& marker : take.names) add("Marker", marker, "Position", "XYZ");
    add("Marker", "Unlabeled 1189", "Position", "XYZ");
  }
  std::string text = fmt::format(
      "Format Version,1.23,Take Name,Take 2024-03-14 01.22.33 PM,Take Notes,,Capture Frame "
      "Rate,{0:.6f},Export Frame Rate,{0:.6f},Capture Start Time,2024-03-14 01.22.33.456 PM,Total "
      "Frames in Take,{1},Total Exported Frames,{1},Rotation Type,Quaternion,Length "
      "Units,Meters,Coordinate Space,Global\r\n\r\n",
      take.rate_hz, take.frames.size());
  text += type + "\r\n" + name + "\r\n" + id + "\r\n" + component + "\r\n" + axis + "\r\n";
  for (std::size_t i = 0; i < take.frames.size(); ++i) {
    const Frame& frame = take.frames[i];
    text += fmt::format("{},{:.6f}", i, frame.time_s);
    if (of == Of::body) {
      text += "," + xyzw_text(frame.body_turn, ",") + "," + xyz_text(frame.body_mm, 1000, ",") +
              ",0.000123," + xyz_text(Eigen::Vector3d(1, 2, 3), 1000, ",") + ",1.000000";
    } else {
      for (const auto& marker : frame.markers_mm) text += "," + xyz_text(marker, 1000, ",");
      text += i % 7 == 0 ? ",0.100000,0.200000,0.300000" : ",,,";
    }
    text += "\r\n";
  }
  return text;
}

/// Nexus, with a section of a device before.
inline std::string vicon_file(const Take& take, Of of) {
  std::string text;
  if (of == Of::markers)
    text =
        "Devices\r\n1000\r\n,,Plate - Force,,\r\nFrame,Sub Frame,Fx,Fy,Fz\r\n,,N,N,N\r\n"
        "1,0,0.1,0.2,0.3\r\n1,1,0.1,0.2,0.3\r\n\r\n";
  text += (of == Of::markers ? "Trajectories\r\n" : "Objects\r\n") +
          fmt::format("{:g}\r\n", take.rate_hz);
  std::string names = ",", axes = "Frame,Sub Frame", units = ",";
  if (of == Of::body) {
    names += ",Tool,,,,,,";
    axes += ",RX,RY,RZ,RW,TX,TY,TZ";
    units += ",,,,,mm,mm,mm";
  } else {
    for (const auto& name : take.names) {
      names += "," + name + ",,";
      axes += ",X,Y,Z";
      units += ",mm,mm,mm";
    }
  }
  text += names + "\r\n" + axes + "\r\n" + units + "\r\n";
  for (std::size_t i = 0; i < take.frames.size(); ++i) {
    const Frame& frame = take.frames[i];
    text += fmt::format("{},0", i + 1);
    if (of == Of::body)
      text += "," + xyzw_text(frame.body_turn, ",") + "," + xyz_text(frame.body_mm, 1, ",");
    else
      for (const auto& marker : frame.markers_mm) text += "," + xyz_text(marker, 1, ",");
    text += "\r\n";
  }
  return text;
}

/// QTM, with the row that names the columns.
inline std::string qtm_file(const Take& take, Of of) {
  std::string text = fmt::format(
      "NO_OF_FRAMES\t{}\r\nNO_OF_CAMERAS\t8\r\n{}\t{}\r\nFREQUENCY\t{:g}\r\nNO_OF_ANALOG\t0\r\n"
      "ANALOG_FREQUENCY\t0\r\nDESCRIPTION\t--\r\nTIME_STAMP\t2024-03-14, "
      "13:22:33.456\t94247.45402301\r\nDATA_INCLUDED\t{}\r\n",
      take.frames.size(), of == Of::body ? "NO_OF_BODIES" : "NO_OF_MARKERS",
      of == Of::body ? 1 : take.names.size(), take.rate_hz, of == Of::body ? "6D" : "3D");
  if (of == Of::body) {
    text += "BODY_NAMES\tTool\r\nFrame\tTime\tTool X\tY\tZ\tRoll\tPitch\tYaw\tResidual";
    for (int k = 0; k < 9; ++k) text += fmt::format("\tRot[{}]", k);
  } else {
    text += "MARKER_NAMES";
    for (const auto& name : take.names) text += "\t" + name;
    text += "\r\nTRAJECTORY_TYPES" + repeated("\tMeasured", take.names.size()) + "\r\nFrame\tTime";
    for (const auto& name : take.names)
      for (const char axis : {'X', 'Y', 'Z'}) text += "\t" + name + " " + axis;
  }
  text += "\r\n";
  for (std::size_t i = 0; i < take.frames.size(); ++i) {
    const Frame& frame = take.frames[i];
    text += fmt::format("{}\t{:.5f}", i + 1, frame.time_s);
    if (of == Of::body) {
      text += "\t" + xyz_text(frame.body_mm, 1, "\t") + "\t1.00000\t2.00000\t3.00000\t0.12345";
      const Eigen::Matrix3d turn = frame.body_turn.toRotationMatrix();
      for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row) text += fmt::format("\t{:.6f}", turn(row, column));
    } else {
      for (const auto& marker : frame.markers_mm)
        text += "\t" + xyz_text(marker, 1, "\t", "0.000000");
    }
    text += "\r\n";
  }
  return text;
}

/// ToolBox with the tool alone, or with its markers.
inline std::string ndi_file(const Take& take, Of of) {
  std::string text =
      "Tools,Port 0x01: Tool,Frame,Time [sec],Face,State,Q0,Qx,Qy,Qz,Tx,Ty,Tz,Error,Markers";
  const bool with_markers = of == Of::markers;
  if (with_markers) text += repeated(",State,Tx,Ty,Tz", take.names.size());
  text += "\n";
  for (std::size_t i = 0; i < take.frames.size(); ++i) {
    const Frame& frame = take.frames[i];
    text += fmt::format("1,Port 0x01: Tool,{},{:.9f},1,OK,{},{},0.2372032,{}", 650512279 + 3 * i,
                        1778067471.318767388 + frame.time_s, wxyz_text(frame.body_turn, ","),
                        xyz_text(frame.body_mm, 1, ","), with_markers ? take.names.size() : 0);
    for (std::size_t k = 0; with_markers && k < take.names.size(); ++k)
      text += frame.markers_mm[k] ? ",OK," + xyz_text(frame.markers_mm[k], 1, ",")
                                  : ",Missing,-3.697314E28,-3.697314E28,-3.697314E28";
    text += "\n";
  }
  return text;
}

/// First Principles has tabs, and one at the end of each line.
inline std::string first_principles_file(const Take& take) {
  std::string text = fmt::format("Number of frames: {}\nFrequency: {:g}\nUnits: mm\n\nFrame",
                                 take.frames.size(), take.rate_hz);
  for (const auto& name : take.names)
    for (const char axis : {'x', 'y', 'z'}) text += "\t" + name + " " + axis;
  text += "\n";
  for (std::size_t i = 0; i < take.frames.size(); ++i) {
    text += fmt::format("{}", i + 1);
    for (const auto& marker : take.frames[i].markers_mm) text += "\t" + xyz_text(marker, 1, "\t");
    text += "\t\n";
  }
  return text;
}

/// rostopic echo -p of a PoseStamped.
inline std::string ros1_file(const Take& take) {
  std::string text =
      "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.pose.position.x,field."
      "pose.position.y,field.pose.position.z,field.pose.orientation.x,field.pose.orientation.y,"
      "field.pose.orientation.z,field.pose.orientation.w\n";
  for (std::size_t i = 0; i < take.frames.size(); ++i) {
    const Frame& frame = take.frames[i];
    const auto stamp = 1710422553000000000 + std::llround(frame.time_s * 1e9);
    text += fmt::format("{},{},{},world,{},{}\n", stamp + 312345, i, stamp,
                        xyz_text(frame.body_mm, 1000, ","), xyzw_text(frame.body_turn, ","));
  }
  return text;
}

/// ros2 topic echo --csv of a PoseStamped.
inline std::string ros2_file(const Take& take) {
  std::string text;
  for (const Frame& frame : take.frames) {
    const auto stamp = 1710422553990000000 + std::llround(frame.time_s * 1e9);
    text += fmt::format("{},{},world,{},{}\n", stamp / 1000000000, stamp % 1000000000,
                        xyz_text(frame.body_mm, 1000, ","), xyzw_text(frame.body_turn, ","));
  }
  return text;
}

/// Of the time of day 13:22:33 plus `time_s`.
inline std::string clock_text(double time_s) {
  const auto ms = std::llround(time_s * 1000) + 33000;
  return fmt::format("13:{:02}:{:02}.{:03}", 22 + ms / 60000, ms / 1000 % 60, ms % 1000);
}

/// SpatialAnalyzer: collection, group, target, x, y, z, and the time, behind comments.
inline std::string spatial_analyzer_file(const Take& take) {
  std::string text =
      "// SpatialAnalyzer 2023.1.0613.9\n// Working frame: A::WORLD\n// Units: Millimeters\n";
  for (std::size_t i = 0; i < take.frames.size(); ++i)
    text +=
        fmt::format("A,  Scan,  p{},  {},  03/14/2024 {}\n", i + 1,
                    xyz_text(take.frames[i].body_mm, 1, ",  "), clock_text(take.frames[i].time_s));
  return text;
}

/// PolyWorks: names of columns, blanks between, inches.
inline std::string polyworks_file(const Take& take) {
  std::string text = "# PolyWorks|Inspector 2022 IR5\n# Units: inches\nName X Y Z I J K\n";
  for (std::size_t i = 0; i < take.frames.size(); ++i)
    text += fmt::format("point_{} {} 0.0 0.0 1.0\n", i + 1,
                        xyz_text(take.frames[i].body_mm, 25.4, " "));
  return text;
}

/// Leica T-Mac: metadata, units in brackets, w first.
inline std::string leica_file(const Take& take) {
  std::string text =
      "Leica Absolute Tracker AT960,SN 750123\nProbe,T-Mac 2\nTimestamp [s],X [mm],Y [mm],Z "
      "[mm],Q0,Q1,Q2,Q3,Status\n";
  for (const Frame& frame : take.frames)
    text += fmt::format("{:.6f},{},{},0\n", 12.5 + frame.time_s, xyz_text(frame.body_mm, 1, ","),
                        wxyz_text(frame.body_turn, ","));
  return text;
}

/// FARO: date and time apart, metres in a row below the names.
inline std::string faro_file(const Take& take) {
  std::string text =
      "FARO Laser Tracker Vantage\n\nPoint Name,Date,Time,X,Y,Z,RMS\n,,,(m),(m),(m),(m)\n";
  for (std::size_t i = 0; i < take.frames.size(); ++i)
    text += fmt::format("P{},3/14/2024,{},{},0.00001\n", i, clock_text(take.frames[i].time_s),
                        xyz_text(take.frames[i].body_mm, 1000, ","));
  return text;
}

/// A file of each kind, and what it has of a take.
struct DeviceFile {
  std::string format;  ///< as --format names it
  std::function<std::string(const Take&)> write;
  Of of = Of::body;
  bool has_turn = false;  ///< the body's
  bool has_times = true;
};

inline std::vector<DeviceFile> device_files() {
  const auto with = [](std::string (*write)(const Take&, Of), Of of) {
    return [=](const Take& take) { return write(take, of); };
  };
  return {{"motive", with(motive_file, Of::markers), Of::markers},
          {"motive", with(motive_file, Of::body), Of::body, true},
          {"vicon", with(vicon_file, Of::markers), Of::markers},
          {"vicon", with(vicon_file, Of::body), Of::body, true},
          {"qtm", with(qtm_file, Of::markers), Of::markers},
          {"qtm", with(qtm_file, Of::body), Of::body, true},
          {"ndi", with(ndi_file, Of::markers), Of::markers},
          {"ndi", with(ndi_file, Of::body), Of::body, true},
          {"ndi", first_principles_file, Of::markers},
          {"ros", ros1_file, Of::body, true},
          {"ros", ros2_file, Of::body, true},
          {"spatialanalyzer", spatial_analyzer_file},
          {"polyworks", polyworks_file, Of::body, false, false},
          {"leica", leica_file, Of::body, true},
          {"faro", faro_file}};
}

}  // namespace sweepd::test
