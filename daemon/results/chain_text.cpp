#include <algorithm>
#include <cmath>
#include <vector>

#include "daemon/results/report.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/text_layout.hpp"
#include "daemon/text/units.hpp"
#include "identify/geometry/warning.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using identify::AngleEvidence;
using identify::Cause;
using identify::ChainEstimate;
using identify::Identification;

/// With three digits: "0.213 µm", "14.2 µm", "583 µm", "1.27 mm".
std::string in_three_digits(double mm) {
  const double um = 1000 * mm;
  if (um >= 1000) return fixed(mm, um < 10'000 ? 2 : 1) + " mm";
  return fixed(um, um < 1 ? 3 : um < 10 ? 2 : um < 100 ? 1 : 0) + " µm";
}

std::string fit_text(const ChainEstimate& estimate) {
  const auto& summary = estimate.summary;
  const std::string correlated = fixed(estimate.samples_per_independent, 1);
  return paragraph(
      "fit         ",
      rsi::counted(estimate.samples, "sample") + ", " + rsi::counted(estimate.outliers, "outlier") +
          ", position noise " + in_three_digits(estimate.noise.position_mm) +
          (correlated == "1.0" ? ""
                               : ", correlated: " + correlated +
                                     " samples tell as much as one independent sample") +
          ", orientations " + (estimate.with_orientation ? "used" : "not used") + "; " +
          std::string(summary.ending) + ", after " +
          rsi::counted(static_cast<std::uint64_t>(summary.iterations), "iteration"));
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

std::string size(Cause cause, const Identification& found) {
  const identify::ChainEstimate& estimate = *found.chain;
  const auto length = [](double mm) { return fixed(mm, 4) + " mm "; };
  const auto angle = [](double rad) { return fixed(degrees(rad), 5) + " deg"; };
  const auto& effects = estimate.effects;
  switch (cause) {
    case Cause::noise:
      return length(estimate.noise.position_mm);
    case Cause::home:
      return angle(std::hypot(effects.home_rad, effects.creep_rad));
    case Cause::drift: {
      double mm = std::hypot(effects.drift_mm, effects.steady_mm, effects.moved_mm);
      for (const auto& other : estimate.others) mm = std::max(mm, other.mm);
      return length(mm);
    }
    case Cause::figure:
      return length(effects.figure_mm());
    case Cause::offset:
      return angle(effects.offset_rad);
    case Cause::print:
      return length(effects.print_mm);
    case Cause::sag:
      return angle(effects.sag_rad);
    case Cause::angles:
      return angle(found.poses ? found.poses->fit.noise.joint_rad : 0);
    case Cause::height:
      return length(estimate.height_open_mm);
  }
  return "";
}

/// Shares in the variances of all identified numbers: the middle one, and the largest with whose it
/// is.
struct Shares {
  double usual = 0;
  double largest = 0;
  std::string of;
};

Shares shares_of(const Eigen::VectorXd& part, const Eigen::MatrixXd& covariance) {
  std::vector<double> all;
  Shares found;
  for (Eigen::Index k = 0; k < part.size(); ++k) {
    if (!(covariance(k, k) > 0)) continue;
    all.push_back(part(k) / covariance(k, k));
    if (all.back() <= found.largest) continue;
    found.largest = all.back();
    found.of = std::string(identify::kDhNumbers[static_cast<std::size_t>(k % 5)].name) +
               std::to_string(k / 5 + 1);
  }
  if (all.empty()) return found;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  found.usual = *middle;
  return found;
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
          std::string(any_linear ? ",\nof linear joints in µm" : "") + "\n\n" + left("joint", 8) +
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

std::string budget_text(const Identification& found) {
  if (!found.chain || found.dh_budget.empty()) return "";
  std::string text =
      "Uncertainty: what it comes from, and its percentage of the variances above\n\n" +
      left("cause", 34) + right("size", 14) + right("usual", 10) + right("largest", 10) + "\n";
  for (const auto& share : found.dh_budget) {
    const Shares of = shares_of(share.variances, found.dh_covariance);
    text += left(std::string(words(share.cause)), 34) + right(size(share.cause, found), 14) +
            number(100 * of.usual, 0, 10) + number(100 * of.largest, 0, 10) +
            (of.of.empty() ? "" : "  of " + of.of) + "\n";
  }
  return text;
}

}  // namespace sweepd
