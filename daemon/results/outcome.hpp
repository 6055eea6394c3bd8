#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/settings/robot_description.hpp"
#include "daemon/stream/pipeline.hpp"
#include "daemon/stream/session.hpp"
#include "identify/clock/clock_match.hpp"
#include "identify/identification.hpp"

namespace sweepd {

/// What was read of points that came from elsewhere than a controller.
struct PointCounts {
  std::size_t points = 0;
  std::size_t sweeps = 0;  ///< found in them that can be used
  std::size_t files = 0;
  std::size_t poses = 0;             ///< static ones, of the points
  std::vector<std::string> targets;  ///< their names in order of appearance
  bool timed = true;                 ///< else the samples' times are only an order
};

/// A device's clock beside the controller's, and what was made of both.
struct JoinedClocks {
  identify::ClockMatch clock;  ///< after what the sweeps showed
  std::size_t sweeps = 0;
  std::size_t poses = 0;
  std::size_t restless = 0;
  double left_out_s = 0;
  double fastest_mm_s = 0;
};

/// Everything that the result files tell.
struct Outcome {
  std::string robot;  ///< its name in the settings, or of its description
  std::string source_kind = "trace";
  SourceCounts counts;
  identify::Identification identification;
  std::optional<PointCounts> points = {};  ///< in place of `counts` where there were no telegrams
  /// One a joint: +1 where Z of the DH table is along positive rotation, -1 where against it;
  /// empty: all along it.
  std::vector<int> positive = {};
  /// Where sweeps were recognised by positions alone.
  std::optional<identify::MotionLimit> motion_limit = {};
  std::vector<JointLimits> limits = {};             ///< one a joint; empty: not known
  std::vector<JointCurrents::Joint> currents = {};  ///< empty: the stream has none
  std::optional<JoinedClocks> joined = {};  ///< where a device's points met a controller's angles
  double angle_step_rad = 0;  ///< one unit of the last decimal that angles were told with; 0: none
};

/// Whether anybody knows when the sweeps ran.
[[nodiscard]] inline bool is_timed(const Outcome& outcome) {
  return !outcome.points || outcome.points->timed;
}

/// Runs the engine. The same snapshot gives the same outcome.
[[nodiscard]] Outcome outcome_of(const Snapshot& snapshot);

/// What the numbers are of.
enum class Described {
  controller_model,  ///< positions that the controller computed from its angles
  arm,               ///< positions that a device measured
};

/// RIst is computed by the controller from its axis angles: what was seen only through RSI is the
/// controller's model. So are points from elsewhere where they follow from the angles beside them
/// to the printed decimals.
[[nodiscard]] Described described(const Outcome& outcome);

/// As in result.json.
[[nodiscard]] std::string_view text(Described described) noexcept;
/// What the numbers are of, and what they are good for: one paragraph.
[[nodiscard]] std::string explanation(const Outcome& outcome);

/// Lengths in files: mm to so many decimals, that is a nanometre and less than noise.
inline constexpr int kLengthDecimals = 6;
/// Angles in files: degrees to so many decimals.
inline constexpr int kAngleDecimals = 7;
/// Errors of angles, seconds of arc.
inline constexpr int kArcsecDecimals = 4;

}  // namespace sweepd
