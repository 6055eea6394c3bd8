#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "daemon/krl/krl_data.hpp"
#include "identify/correction/corrected_joints.hpp"
#include "identify/poses/arm_fit.hpp"
#include "identify/poses/pose_fit.hpp"

namespace sweepd {

/// What points of a program are told in.
struct PointFrames {
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();  ///< $BASE, in $ROBROOT
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();  ///< $TOOL, in $FLANGE
};

struct ProgramOptions {
  Eigen::Isometry3d flange = Eigen::Isometry3d::Identity();  ///< in the frame after the last row
  std::optional<Eigen::Isometry3d> base;                     ///< of all points
  std::optional<Eigen::Isometry3d> tool;
  /// $CONFIG.DAT: frames by the FDAT of each point, where they are not given above.
  std::optional<std::vector<KrlAggregate>> config;
  double largest_shift_mm = 3;
  std::vector<std::string> leave;  ///< names of points that stay as they are, in capitals
  /// Lowest and highest angle of each joint, rad, as far as they are known.
  std::vector<std::pair<double, double>> limits;
  /// And of the poses that the result was made of.
  std::vector<std::pair<double, double>> measured;
};

struct CorrectedPoint {
  std::string name;
  std::size_t line = 0;
  std::string type;
  double shift_mm = 0;     ///< of the point, from old to new, as the controller computes it
  double turn_rad = 0;     ///< and of its orientation
  double expected_mm = 0;  ///< of what is left, root mean square
  std::array<double, 6> angles_rad{};  ///< the controller's, as corrected
  bool left = false;                   ///< as it is, as it was asked for
  bool outside = false;                ///< a joint is beyond what the poses covered
  std::optional<std::pair<unsigned, unsigned>> turn_bits;  ///< T, where a joint passes zero
  double from_target_mm = 0;  ///< how far its tool is from the measured target
};

struct CorrectedProgram {
  std::string text;  ///< the file as it was but for numbers of points
  std::vector<CorrectedPoint> points;
};

/// Points of types E6POS, POS, E6AXIS and AXIS, with values, so that the identified arm stands
/// where the controller believes itself to be with the points of `text`. S stays, and T but where
/// an angle passes zero; external axes and all else stays to the byte. Throws KrlError with all
/// that is wrong: points without S and T, out of reach, near a singularity of the wrist, beyond the
/// joints' limits, or shifted by more than `largest_shift_mm`; or no points at all.
[[nodiscard]] CorrectedProgram corrected_program(std::string_view text,
                                                 const identify::PoseFit& identified,
                                                 const identify::PlacedArm& controller,
                                                 const ProgramOptions& options);

}  // namespace sweepd
