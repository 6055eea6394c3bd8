#pragma once

#include <optional>
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

/// What a result predicts of poses, against where they were seen.
struct JudgedPoses {
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

/// The same of poses that were measured in another frame, brought into the result's. The frame is
/// made of these poses: of few of them little is left for that alone.
struct OtherFrame {
  double moved_mm = 0;    ///< the middle of the poses
  double turned_rad = 0;  ///< about any axis
  JudgedPoses judged;
};

/// Of poses that the result was not made of, as they are; and in the frame that fits them, where
/// they lie far off without it and all as one body.
struct Validation : JudgedPoses {
  std::optional<OtherFrame> frame;
};

/// `poses`: with targets as the predictor counts them.
[[nodiscard]] Validation validated(const PosePredictor& predictor,
                                   const std::vector<identify::Pose>& poses);

[[nodiscard]] std::string validation_text(const Validation& found);
/// Schema `sweepd.validation/1`.
[[nodiscard]] nlohmann::ordered_json validation_json(const Validation& found);

}  // namespace sweepd
