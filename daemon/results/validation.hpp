#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/results/poses_json.hpp"
#include "identify/poses/pose_estimate.hpp"

namespace sweepd {

/// Visits of one commanded pose and target, as ISO 9283 judges them: how far the mean of what was
/// attained is from where the result has it, and the radius around that mean.
struct Visits {
  std::string first;            ///< the name of the first
  std::size_t count = 0;        ///< at least three
  double accuracy_mm = 0;       ///< AP (ISO 9283:1998, 7.2.1)
  double repeatability_mm = 0;  ///< RP = l + 3 S_l (7.2.2)
};

/// What a result predicts of poses that it was not made of, against where they were seen.
struct Validation {
  struct Off {
    std::string name;
    Eigen::Vector3d mm;   ///< seen less predicted
    bool inside = false;  ///< the 95 % ellipsoid
  };
  std::vector<Off> poses;
  identify::Left left;
  std::vector<identify::Left> levels;  ///< of the specified arm, so much of it let go
  std::vector<Visits> visits;

  [[nodiscard]] std::size_t inside() const;
};

/// `poses`: with targets as the predictor counts them.
[[nodiscard]] Validation validated(const PosePredictor& predictor,
                                   const std::vector<identify::Pose>& poses);

[[nodiscard]] std::string validation_text(const Validation& found);
/// Schema `sweepd.validation/1`.
[[nodiscard]] nlohmann::ordered_json validation_json(const Validation& found);

}  // namespace sweepd
