#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "daemon/report/file_parts.hpp"

namespace sweepd {

/// Throws std::runtime_error where `json`, the content of `file`, is none of schemas::kResult.
void require_result(const nlohmann::ordered_json& json, const std::filesystem::path& file);

/// One row of sweeps.csv, as far as a picture needs it. Not a number where the file has nothing.
struct StrokePoint {
  Eigen::Vector3d position_mm;
  double time_s;
  double angle;  ///< of the joint that moves, degrees; of a linear joint mm
  /// From where the chain has the target, along the axis and away from it; without a chain, off
  /// the plane of its circle and off the circle.
  double axial_mm;
  double radial_mm;
  double along_arcsec;  ///< error of the angle
  double curve_arcsec;  ///< that part of it which repeats
};

/// The rows of one sweep and target.
struct Stroke {
  std::size_t joint = 0;            ///< from 0
  std::size_t sweep = 0;            ///< from 0
  std::size_t target = 0;           ///< from 0
  std::vector<StrokePoint> points;  ///< in the order of the file, evenly thinned
};

/// The mean square of something.
struct MeanSquare {
  std::size_t count = 0;
  double squares = 0;

  void add(double value);  ///< not a number is nothing
  [[nodiscard]] double root() const;
};

/// What all points of a joint have in common, not only those that are drawn.
struct PointSums {
  MeanSquare axial_mm;
  MeanSquare radial_mm;
  MeanSquare along_arcsec;
  /// Of the target that comes first; one target's points alone lie on one circle.
  std::optional<std::size_t> target;
  std::size_t count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();  ///< of positions, from `origin`
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();    ///< the first point
};

/// The files of a folder that a report is made of.
// NOLINTNEXTLINE(bugprone-exception-escape): what nlohmann's move may throw, it never does
struct ReportFolder {
  /// Of a joint's points so many are kept for drawing, and one more a stroke, whatever was
  /// recorded: the report of a day is as long as that of a minute.
  static constexpr std::size_t kMostPoints = 1600;

  nlohmann::ordered_json result;  ///< of schemas::kResult
  nlohmann::ordered_json run;     ///< run.json; null where there is none
  nlohmann::ordered_json link;    ///< link.json; null where there is none
  std::string dh_csv;             ///< empty where there is none
  std::string displacement_csv;   ///< the same
  std::string currents_csv;       ///< the same
  std::vector<Stroke> strokes;    ///< in the order of sweeps.csv
  std::vector<PointSums> sums;    ///< one a joint
  std::string name;               ///< of the folder, for titles
  /// Of which it was made, whether they are there or not.
  std::vector<std::filesystem::path> files;
};

/// Throws std::runtime_error where there is no result.json, or none that can be read. What else is
/// missing is left out.
[[nodiscard]] ReportFolder read_report_folder(const std::filesystem::path& folder);

/// The same of texts, for who has them already.
void read_strokes(std::string_view sweeps_csv, ReportFolder& folder);

}  // namespace sweepd
