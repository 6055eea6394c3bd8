#include "daemon/results/chain_text.hpp"

#include <algorithm>
#include <vector>

#include "daemon/text/numbers.hpp"
#include "daemon/text/text_layout.hpp"
#include "daemon/text/units.hpp"
#include "identify/geometry/warning.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using identify::AngleEvidence;
using identify::ChainEstimate;

std::string fit_text(const ChainEstimate& estimate) {
  const auto& summary = estimate.summary;
  return paragraph(
      "fit         ",
      rsi::counted(estimate.samples, "sample") + ", " + rsi::counted(estimate.outliers, "outlier") +
          ", position noise " + fixed(1000 * estimate.noise.position_mm, 3) + " um, " +
          fixed(estimate.samples_per_independent, 1) +
          " samples tell as much as one independent sample, orientations " +
          (estimate.with_orientation ? "used" : "not used") + "; " + std::string(summary.ending) +
          ", after " + rsi::counted(static_cast<std::uint64_t>(summary.iterations), "iteration"));
}

/// Joints that share a reason, with it.
std::string reasons(const std::vector<AngleEvidence>& angles) {
  std::string text;
  for (std::size_t j = 0; j < angles.size(); ++j) {
    const auto same = [&](const AngleEvidence& other) { return other.reason == angles[j].reason; };
    if (std::find_if(angles.begin(), angles.end(), same) - angles.begin() <
        static_cast<std::ptrdiff_t>(j))
      continue;
    std::vector<std::size_t> joints;
    for (std::size_t k = j; k < angles.size(); ++k)
      if (same(angles[k])) joints.push_back(k);
    text += paragraph("  - ", identify::joints_named(joints) + ": " + angles[j].reason);
  }
  return text;
}

}  // namespace

std::string chain_text(const ChainEstimate& estimate) {
  const auto& angles = estimate.angles;
  std::string text = fit_text(estimate);
  if (std::all_of(angles.begin(), angles.end(),
                  [](const AngleEvidence& seen) { return seen.samples == 0; }))
    return text;
  const auto& axes = estimate.chain.axes;
  const bool any_linear =
      std::any_of(axes.begin(), axes.end(), [](const auto& axis) { return axis.linear; });
  text += "\nAngles: the controller's minus those at which the target was seen, in arcsec" +
          std::string(any_linear ? ",\nof linear joints in um" : "") + "\n\n" + left("joint", 8) +
          left("angles", 9) + right("error rms", 12) + right("beside curve", 14) +
          right("expected", 12) + right("backlash", 12) + "\n";
  for (std::size_t j = 0; j < angles.size(); ++j) {
    const AngleEvidence& seen = angles[j];
    text +=
        left(right(std::to_string(j + 1), 5), 8) + left(std::string(identify::text(seen.trust)), 9);
    const auto column = [&](bool there, double radians, std::size_t width) {
      const double shown = axes[j].linear ? 1000 * degrees(radians) : arcsec(radians);
      text += there ? number(shown, 2, width) : right("-", width);
    };
    const bool any = seen.samples > 0;
    column(any, seen.error_rms_rad, 12);
    column(any, seen.remainder_rms_rad, 14);
    column(any, seen.expected_rms_rad, 12);
    column(any && seen.backlash_sigma_rad > 0, seen.backlash_rad, 12);
    text += "\n";
  }
  return text + "\n" + reasons(angles);
}

}  // namespace sweepd
