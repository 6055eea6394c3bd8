#pragma once

#include <vector>

#include <Eigen/Core>

#include "identify/sweeps/sample.hpp"
#include "identify/sweeps/stroke_moments.hpp"
#include "identify/sweeps/sweep.hpp"

namespace identify {

/// A stroke's samples while its moments are made; the symbols are those of StrokeMoments. The
/// functions stand in the order in which they are called.
struct StrokeSamples {
  std::vector<const Sample*> samples;               ///< those with a position
  std::vector<bool> beside;                         ///< far from the circle
  std::vector<double> turns;                        ///< x
  std::vector<double> told;                         ///< where it follows the arc
  Eigen::Matrix<double, 6, Eigen::Dynamic> errors;  ///< e
  Eigen::VectorXd weights;                          ///< w
};
/// The sweep has to outlive them.
[[nodiscard]] StrokeSamples samples_in(const Sweep& sweep);

/// What is nowhere near the circle tells nothing of the turn.
void set_aside(const StrokeMoments& stroke, StrokeSamples& seen);
/// Which way x goes about the circle, where it is zero, and whether what is told follows the arc.
void set_turns(StrokeMoments& stroke, StrokeSamples& seen);
/// In place of that: x, and what is told, by a reference that is given.
void set_turns_by(const StrokeMoments& like, StrokeSamples& seen);
/// The least and greatest turn; all others lie between them.
void set_range(StrokeMoments& stroke, StrokeSamples& seen);
/// The reference orientation: the mean of what each sample says, from the middle one.
void set_orientation(StrokeMoments& stroke, const StrokeSamples& seen);
void set_errors(const StrokeMoments& stroke, StrokeSamples& seen);
/// By the distance from the stroke's own curve. Sets the stroke's blocks and its rounding, too.
void set_weights(StrokeMoments& stroke, StrokeSamples& seen);
void count_weights(StrokeMoments& stroke, const StrokeSamples& seen);

}  // namespace identify
