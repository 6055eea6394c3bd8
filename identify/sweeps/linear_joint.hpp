#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/geometry/line_fit.hpp"
#include "identify/sweeps/sweep.hpp"

namespace identify {

/// What the positions of a joint's strokes say of how it moves.
enum class Straightness {
  straight,   ///< a linear joint: no arc that a joint could turn on is as straight
  undecided,  ///< the stroke is too short, or the noise too large, to tell a line from an arc
  bent,       ///< it turns
};

/// How the target moved along `line` in sweeps of one target, by what the joint was told.
struct ToldWay {
  double range_rad = 0;    ///< of the angles told; zero: none were
  double mm_per_unit = 0;  ///< way along the line by kLinear_mm * angle; 1 or -1 of a linear joint
};
[[nodiscard]] ToldWay told_way(const LineFit& line, const std::vector<Sweep>& sweeps,
                               std::size_t joint);

/// A joint that turned by q on a chord of length L has the sagitta (L / 2) tan(q / 4); without
/// angles L^2 / (8 R) is the least of any arm, R being 10 m. The line is straight where its bend,
/// four standard uncertainties more, is less than half of that and, with angles, the target moved
/// by as many mm as were told, to a per cent; it is bent where the bend is more than half of it,
/// four standard uncertainties less, or the way is another.
[[nodiscard]] Straightness straightness(const LineFit& line, const ToldWay& told);

/// Whether a joint is linear, by what is described and what its strokes show.
struct LinearVerdict {
  std::optional<LineFit> line;  ///< of a linear joint, along positive mm or as the points run
  std::string contradiction;    ///< of the description; empty: none
};
/// `described_linear`: nothing without a description. The strokes decide where they can; where they
/// cannot, the description does, and without one the joint counts as one that turns. `used`: the
/// sweeps that `points_mm` are of.
[[nodiscard]] LinearVerdict linear_verdict(const Eigen::Matrix3Xd& points_mm,
                                           const std::vector<Sweep>& used, std::size_t joint,
                                           std::optional<bool> described_linear);

/// Of a sweep whose positions were judged as an arc's: what it is as a stroke of a linear joint,
/// defect and, without angles, range. Others stay as they are.
[[nodiscard]] Sweep judged_as_line(Sweep sweep, bool known_linear);

}  // namespace identify
