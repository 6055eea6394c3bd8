#pragma once

#include <string>

#include "daemon/results/outcome.hpp"
#include "identify/models/kinematic_model.hpp"

namespace sweepd {

// What an outcome is written as: the text of a file each.

/// The text of result.json, schema sweepd.result/1. The same outcome gives the same bytes.
///
/// A number that the data do not determine is null; one that is set by convention stands in
/// "by_convention" of its row and has a difference of null: it was not identified. One that came
/// out infinite or as no number is null too, and "not_finite" holds its place as a JSON pointer.
[[nodiscard]] std::string result_json(const Outcome& outcome);

/// The text of dh.csv: a row a joint, for each number identified / standard uncertainty / specified
/// / difference, and the 95 % interval's ends; `positive` is 1 where Z is along positive rotation,
/// -1 where against it; theta is the angle at `home_deg`. Empty where something is not known.
[[nodiscard]] std::string dh_csv(const Outcome& outcome);

/// The text of sweeps.csv: a row for each sample that was used, with its distances from the fitted
/// plane and circle (empty for a sweep from elsewhere than home), and from where the chain has it.
/// `target` counts from 1.
[[nodiscard]] std::string sweeps_csv(const Outcome& outcome);

/// The text of poses.csv: a row for each static pose, as it was given, with where it was seen less
/// where the fit has it, and the size of that in standard deviations of the noise.
[[nodiscard]] std::string poses_csv(const Outcome& outcome);

/// currents.csv: a line for each joint and whole degree at which it was seen moving alone.
[[nodiscard]] std::string currents_csv(const Outcome& outcome);

/// dh.tex: the DH table as a `tabular` that a paper can \input; needs the package booktabs.
/// Identified numbers with the half-width of their 95 % interval to two digits, specified ones and
/// the difference where there is a specified table; a dagger marks what convention sets. beta has a
/// row where axes are parallel or coincident.
[[nodiscard]] std::string dh_latex(const Outcome& outcome);

/// robot.urdf of a model in the form `urdf`: links base_link (the measurement frame), link_1 ...
/// link_n, and tool0 at the target point; metres, radians, full precision. A joint's value is the
/// controller's angle; where its home is not known, the angle from home. The identified numbers
/// stand in the origins, where every reader looks; `calibration` tags are not used. A joint with
/// known limits and home is revolute, others are continuous; a linear one is prismatic, in metres,
/// its limits the description's or the range that was swept, for URDF demands some. Velocity limits
/// are the description's, 0 where it has none. What is no printable ASCII in the robot's name
/// becomes `_`.
[[nodiscard]] std::string urdf(const identify::KinematicModel& model, const Outcome& outcome);

}  // namespace sweepd
