#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "daemon/results/poses_json.hpp"
#include "identify/poses/pose.hpp"

namespace sweepd {

/// A result by which a controller can be corrected: of an arm, by static poses, with the table that
/// the controller computes with.
struct Correctable {
  std::filesystem::path file;  ///< result.json
  std::string robot;
  PosePredictor identified;
  /// poses.csv, with targets as `identified` counts them; outliers have the weight 0.
  std::vector<identify::Pose> poses;
  Eigen::VectorXd weights;
  std::vector<std::size_t> open;  ///< joints without an axis, from 1
  /// Of each joint, rad (a linear one's mm are degrees): the description's limits, infinite where
  /// it has none; and where the poses were.
  std::vector<std::pair<double, double>> limits;
  std::vector<std::pair<double, double>> measured;

  /// The specified arm where it stands, with its targets.
  [[nodiscard]] const identify::PlacedArm& controller() const { return identified.levels.front(); }
};

/// `path` is a folder that identify has written, or its result.json; poses.csv lies beside it.
/// Throws std::runtime_error with what is wrong and what to do: a controller's model, no specified
/// table, doubtful, failed, not of static poses.
[[nodiscard]] Correctable read_correctable(const std::filesystem::path& path);

}  // namespace sweepd
