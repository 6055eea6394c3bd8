#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "daemon/results/outcome.hpp"
#include "identify/poses/pose_estimate.hpp"

namespace sweepd {

/// "poses" of result.json, of a result that has them. "model" in it has all digits: predictions are
/// made from it.
[[nodiscard]] nlohmann::ordered_json poses_json(const Outcome& outcome);

/// What predicts poses, as result.json has it.
struct PosePredictor {
  identify::PoseFit fit;             ///< model, noise and covariance; no rows
  std::vector<std::string> targets;  ///< their names
  std::vector<identify::PlacedArm> levels;

  [[nodiscard]] Eigen::Vector3d position_mm(const identify::Pose& pose) const {
    return fit.model.position_mm(pose);
  }
  /// Of what will be seen: the model's, and the noise of one pose.
  [[nodiscard]] Eigen::Matrix3d covariance_at(const identify::Pose& pose) const;
};

/// From "poses" of a result.json. Throws nlohmann::json::exception where it is another's.
[[nodiscard]] PosePredictor pose_predictor(const nlohmann::ordered_json& poses);

/// What of the specified arm is let go, in words: "base and tool".
[[nodiscard]] const char* words(identify::Freedom freedom) noexcept;

}  // namespace sweepd
