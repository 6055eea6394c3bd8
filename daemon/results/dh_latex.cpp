#include <optional>

#include "daemon/results/result_formats.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "identify/dh/dh_comparison.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/models/kinematic_model.hpp"

namespace sweepd {
namespace {

using identify::DhNumber;
using identify::Knowledge;

constexpr int kMostDecimals = 9;

/// Without zeros at the end.
std::string short_number(double value) {
  std::string text = fixed(value, kLengthDecimals);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string math(const std::string& text) {
  return "$" + text + "$";
}

struct Entry {
  const char* symbol = "";
  const char* unit = "";
  double scale = 1;  // from mm or rad to the unit
  DhNumber found;
  double specified = 0;
  std::optional<double> difference;
};

std::string line(const Entry& entry, std::size_t joint, bool compared) {
  const double value = entry.scale * entry.found.value;
  const double half = identify::kSigmasOf95Percent * entry.scale * entry.found.sigma;
  const int decimals = half > 0 ? decimals_for(half, 0, kMostDecimals) : kLengthDecimals;
  std::string text = std::string(" & $") + entry.symbol + "_{" + std::to_string(joint) + "}$ (" +
                     entry.unit + ") & ";
  if (entry.found.knowledge == Knowledge::undetermined)
    text += "--";
  else if (entry.found.knowledge == Knowledge::by_convention)
    text += math(short_number(value) + "^{\\dagger}");
  else if (half > 0)
    text += math(fixed(value, decimals) + " \\pm " + fixed(half, decimals));
  else
    text += math(fixed(value, decimals));
  if (compared) {
    text += " & " + math(short_number(entry.scale * entry.specified)) + " & ";
    text += entry.difference ? math(fixed(entry.scale * *entry.difference, decimals)) : "--";
  }
  return text + " \\\\\n";
}

}  // namespace

std::string dh_latex(const Outcome& outcome) {
  const auto& found = outcome.identification;
  const auto differences = compare_with_specified(found.dh, found.specified, found.home_rad);
  const bool compared = !differences.empty();
  std::string text =
      "% DH parameters in the notation of Tz(b) Rz(theta) Tx(a) Rx(alpha) Ry(beta).\n"
      "% \\usepackage{booktabs}; then \\input this file.\n"
      "\\begin{tabular}{";
  text += compared ? "clrrr}\n" : "clr}\n";
  text += "\\toprule\nJoint & Parameter & Identified";
  text += compared ? " & Specified & Difference \\\\\n" : " \\\\\n";
  for (std::size_t i = 0; i < found.dh.size(); ++i) {
    const auto& row = found.dh[i];
    const identify::DhRow expected = compared ? found.specified[i] : identify::DhRow{};
    const identify::DhDifference difference = compared ? differences[i] : identify::DhDifference{};
    const double degree = degrees(1);
    text += "\\midrule\n" + std::to_string(i + 1);
    text += line({"b", "mm", 1, row.b_mm, expected.b_mm, difference.b_mm}, i + 1, compared);
    text +=
        line({"\\theta", "deg", degree, row.theta_rad, expected.theta_rad, difference.theta_rad},
             i + 1, compared);
    text += line({"a", "mm", 1, row.a_mm, expected.a_mm, difference.a_mm}, i + 1, compared);
    text +=
        line({"\\alpha", "deg", degree, row.alpha_rad, expected.alpha_rad, difference.alpha_rad},
             i + 1, compared);
    if (row.beta_rad.knowledge == Knowledge::identified)
      text += line({"\\beta", "deg", degree, row.beta_rad, expected.beta_rad, difference.beta_rad},
                   i + 1, compared);
  }
  const std::string span =
      "\\multicolumn{" + std::string(compared ? "5" : "3") + "}{l}{\\footnotesize ";
  return text + "\\bottomrule\n" + span + "$\\pm$: half-width of the 95\\,\\% interval.} \\\\\n" +
         span + "$^{\\dagger}$ Set by convention, not determined by the data.}\n\\end{tabular}\n";
}

}  // namespace sweepd
