#pragma once

#include <string>

#include "identify/poses/pose_estimate.hpp"

namespace sweepd {

/// The report's part on static poses: what is left of them, what each level of correction buys, and
/// what joints do beside what their angles say.
[[nodiscard]] std::string poses_text(const identify::PoseEstimate& found);

/// A line of a table of what is left: who, mean, rms and max in mm.
[[nodiscard]] std::string left_line(const std::string& who, const identify::Left& left);
[[nodiscard]] std::string left_header();

}  // namespace sweepd
