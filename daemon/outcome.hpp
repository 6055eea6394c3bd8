#pragma once

#include <string>

#include "daemon/pipeline.hpp"
#include "identify/identification.hpp"

namespace sweepd {

/// Everything that the result files tell.
struct Outcome {
  std::string robot;  ///< its name in the settings, or of its description
  std::string source_kind = "trace";
  SourceCounts counts;
  identify::Identification identification;
};

/// Lengths in files: mm to so many decimals, that is a nanometre and less than noise.
inline constexpr int kLengthDecimals = 6;
/// Angles in files: degrees to so many decimals.
inline constexpr int kAngleDecimals = 7;

}  // namespace sweepd
