#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "identify/sweeps/sample.hpp"
#include "identify/sweeps/stroke_curve.hpp"
#include "identify/sweeps/stroke_moments.hpp"
#include "identify/sweeps/sweep.hpp"

namespace identify {

/// A stroke's samples while its moments are made; the symbols are those of StrokeMoments. The
/// functions stand in the order in which they are called.
struct StrokeSamples {
  std::vector<const Sample*> samples;            ///< those with a position
  SampleRows positions_mm;                       ///< X, Y, Z
  SampleRows errors;                             ///< e
  Eigen::ArrayXd distances;                      ///< from the circle, see distances_of()
  Eigen::Array<bool, Eigen::Dynamic, 1> beside;  ///< far from it
  Eigen::ArrayXd turns;                          ///< x
  Eigen::ArrayXd told;                           ///< where it follows the arc
  std::vector<Eigen::Quaterniond> said;          ///< the tool, turned back to `zero_rad`
  Eigen::ArrayXd weights;                        ///< w
};
/// The sweep has to outlive them.
[[nodiscard]] StrokeSamples samples_in(const Sweep& sweep);

/// Where they lie beside the circle, and where about it. What is nowhere near it tells nothing of
/// the turn.
void set_across(const StrokeMoments& stroke, StrokeSamples& seen);
/// Which way x goes about the circle, where it is zero, and whether what is told follows the arc.
void set_turns(StrokeMoments& stroke, StrokeSamples& seen);
/// In place of that: x, and what is told, by a reference that is given.
void set_turns_by(const StrokeMoments& like, StrokeSamples& seen);
/// The least and greatest turn; all others lie between them.
void set_range(StrokeMoments& stroke, StrokeSamples& seen);
void set_said(const StrokeMoments& stroke, StrokeSamples& seen);
/// The reference orientation: the mean of what each sample says, from the middle one.
void set_orientation(StrokeMoments& stroke, const StrokeSamples& seen);
/// Those along the arc, and of the orientation.
void set_errors(const StrokeMoments& stroke, StrokeSamples& seen);
/// By the distance from the stroke's own curve. Sets the stroke's blocks and its rounding, too.
void set_weights(StrokeMoments& stroke, StrokeSamples& seen);
void count_weights(StrokeMoments& stroke, const StrokeSamples& seen);

}  // namespace identify
