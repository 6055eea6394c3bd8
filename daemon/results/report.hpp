#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "daemon/results/outcome.hpp"
#include "identify/chain/chain_estimate.hpp"
#include "identify/identification.hpp"
#include "identify/poses/pose_estimate.hpp"

namespace sweepd {

/// The text of report.txt: what was seen and identified, for a person at a terminal of 80 columns.
[[nodiscard]] std::string report(const Outcome& outcome);

/// "joint 3: sweep of +90.0 deg in 4.60 s, 1150 samples": what a person wants to see as it happens.
/// `planned`: the joint by the plan, counted from 0, for a sweep that does not know its own.
/// `limits`: one a joint, of which the linear ones are told in mm; or none.
[[nodiscard]] std::string sweep_line(const identify::Sweep& sweep,
                                     std::optional<std::size_t> planned = {},
                                     const std::vector<JointLimits>& limits = {});

// Its parts.

/// The DH table for people: identified, standard uncertainty, the circles' value where the table is
/// the chain's, and the specified table where there is one.
[[nodiscard]] std::string dh_text(const identify::Identification& found);

/// How the chain's fit ended, and how far each joint's angles were believed, for people.
[[nodiscard]] std::string chain_text(const identify::ChainEstimate& estimate);

/// What the uncertainties of the table come from, for people; empty where the chain found nothing.
[[nodiscard]] std::string budget_text(const identify::Identification& found);

/// The report's part on static poses: what is left of them, what each level of correction buys, and
/// what joints do beside what their angles say.
[[nodiscard]] std::string poses_text(const identify::PoseEstimate& found);

/// A line of a table of what is left: who, mean, rms and max in mm.
[[nodiscard]] std::string left_line(const std::string& who, const identify::Left& left);
[[nodiscard]] std::string left_header();

}  // namespace sweepd
