#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "daemon/krl/corrected_program.hpp"
#include "daemon/results/correctable.hpp"
#include "identify/correction/controller_fit.hpp"

namespace sweepd {

/// What is to be corrected, in words that an option takes.
enum class CorrectionLevel { mastering, frames, machine_data, targets };
[[nodiscard]] const char* text(CorrectionLevel level) noexcept;

/// What a result says is to be corrected.
struct Correction {
  CorrectionLevel level = CorrectionLevel::mastering;
  std::string robot;
  std::vector<std::string> targets;  ///< the names of the measured ones
  std::size_t poses = 0;             ///< that count
  identify::ControllerFit fit;       ///< of targets: base and tool alone
  identify::Left left;               ///< what that leaves of the poses
  identify::Left frames;             ///< and base and tool alone
  identify::Left identified;         ///< and the identified model
  /// How far the identified model is from what the controller can take over, over the poses.
  identify::Left unheld;
  identify::Arm specified;
  Eigen::Isometry3d flange = Eigen::Isometry3d::Identity();  ///< in the frame after the last row
  Eigen::Matrix3d tool = Eigen::Matrix3d::Identity();        ///< orientation of $TOOL, as given
  std::optional<CorrectedProgram> program;                   ///< of targets

  /// The frame of the measurements in the robot's base, and a target in $FLANGE.
  [[nodiscard]] Eigen::Isometry3d base_frame() const;
  [[nodiscard]] Eigen::Isometry3d tool_frame(std::size_t target) const;
  /// Standard uncertainties of base_frame(): mm, then rad about X, Y, Z of the robot's base.
  [[nodiscard]] Eigen::Matrix<double, 6, 1> base_sigma() const;
  [[nodiscard]] Eigen::Vector3d tool_sigma_mm(std::size_t target) const;
  /// By how much a joint really stands farther along its positive sense than is shown, rad.
  [[nodiscard]] double offset(const identify::ControllerNumber& zero) const;
  /// What has to be known before anything of it is done, each a sentence or some.
  [[nodiscard]] std::vector<std::string> warnings() const;
};

/// For the levels of the controller's own numbers; of targets what comes before their program.
[[nodiscard]] Correction correction_of(const Correctable& of, CorrectionLevel level);

[[nodiscard]] std::string correction_text(const Correction& correction);
/// Schema `sweepd.correction/1`.
[[nodiscard]] nlohmann::ordered_json correction_json(const Correction& correction);

/// "theta2", "b4".
[[nodiscard]] std::string name_of(const identify::ControllerNumber& number,
                                  const identify::Arm& arm);

}  // namespace sweepd
