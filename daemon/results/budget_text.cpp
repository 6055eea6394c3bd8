#include "daemon/results/budget_text.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "daemon/text/numbers.hpp"
#include "daemon/text/text_layout.hpp"
#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

using identify::Cause;
using identify::Identification;

std::string size(Cause cause, const Identification& found) {
  const identify::ChainEstimate& estimate = *found.chain;
  const auto length = [](double mm) { return fixed(mm, 4) + " mm "; };
  const auto angle = [](double rad) { return fixed(degrees(rad), 5) + " deg"; };
  const auto& effects = estimate.effects;
  switch (cause) {
    case Cause::noise:
      return length(estimate.noise.position_mm);
    case Cause::home:
      return angle(effects.home_rad);
    case Cause::drift:
      return length(std::hypot(effects.drift_mm, effects.steady_mm, effects.moved_mm));
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
