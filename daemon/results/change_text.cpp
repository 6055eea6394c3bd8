
#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "daemon/results/change.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/text_layout.hpp"
#include "rsi/ascii.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using identify::ArmNumber;
using identify::LeftOutBecause;

/// As many as show two digits of the smallest uncertainty.
struct ChangeDecimals {
  explicit ChangeDecimals(const Change& change) {
    double least_length = 1, least_angle = 1;
    for (std::size_t k = 0; k < change.arms.numbers.size(); ++k) {
      const ArmNumber& number = change.arms.numbers[k];
      double& least = number.length ? least_length : least_angle;
      least = std::min(least, kCoverage * in_unit(number, change.test.numbers[k].sigma));
    }
    length = decimals_for(least_length, kFewestOfChange, kMostOfChange);
    angle = decimals_for(least_angle, kFewestOfChange, kMostOfChange);
  }
  [[nodiscard]] int of(const ArmNumber& number) const { return number.length ? length : angle; }
  int length = 0;
  int angle = 0;
};

std::string verdict(const Change& change, const ChangeDecimals& decimals) {
  const std::string chance =
      share_text(change.test.p) + " of pairs of unchanged robots differ at least as much.";
  if (!change.test.changed) return "No change seen: " + chance;
  std::string changed;
  for (std::size_t k = 0; k < change.arms.numbers.size(); ++k) {
    const ArmNumber& number = change.arms.numbers[k];
    if (!change.test.numbers[k].changed) continue;
    const double difference = in_unit(number, change.arms.difference(static_cast<Eigen::Index>(k)));
    changed += (changed.empty() ? "" : ", ") + name_of(number) + " by " +
               (difference > 0 ? "+" : "") + fixed(difference, decimals.of(number)) + ' ' +
               unit_of(number);
  }
  return (changed.empty() ? "Changed, though no number alone tells what: "
                          : "Changed: " + changed + "; ") +
         chance;
}

std::string about(const ToldArm& told) {
  return rsi::printable(told.file.string() + ": " + told.robot) + ", " +
         (told.describes == "arm" ? "the arm" : "the controller's model") + ", " + told.status;
}

std::string table(const Change& change, const ChangeDecimals& decimals) {
  constexpr std::size_t kName = 7, kUnit = 5, kValue = 13, kDifference = 11, kSize = 10;
  std::string out = left("number", kName) + left("unit", kUnit) + right("A", kValue) +
                    right("B", kValue) + right("B - A", kDifference) + right("U", kSize) +
                    right("smallest", kSize) + "  verdict\n";
  for (std::size_t k = 0; k < change.arms.numbers.size(); ++k) {
    const ArmNumber& number = change.arms.numbers[k];
    const auto at = static_cast<Eigen::Index>(k);
    const auto cell = [&](double value, std::size_t width) {
      return ' ' + sweepd::number(in_unit(number, value), decimals.of(number), width - 1);
    };
    const auto& found = change.test.numbers[k];
    out += left(name_of(number), kName) + left(unit_of(number), kUnit) +
           cell(change.arms.first(at), kValue) + cell(change.arms.second(at), kValue) +
           cell(change.arms.difference(at), kDifference) + cell(kCoverage * found.sigma, kSize) +
           cell(found.smallest, kSize) + (found.changed ? "  changed\n" : "  -\n");
  }
  return out;
}

std::string left_out(const Change& change, LeftOutBecause because) {
  std::string names;
  for (const auto& one : change.arms.left_out)
    if (one.because == because) names += (names.empty() ? "" : ", ") + name_of(one.number);
  return names;
}

std::string left_out(const Change& change) {
  std::string text;
  const auto add = [&](LeftOutBecause because, const std::string& why) {
    const std::string names = left_out(change, because);
    if (!names.empty()) text += names + " (" + why + "), ";
  };
  add(LeftOutBecause::frame, "they tell where the base stands");
  add(LeftOutBecause::no_home, "the controller's angles at home are not known of both");
  add(LeftOutBecause::other_home,
      "the homes are apart, and no angles tell what gears are off by there");
  add(LeftOutBecause::convention, "set by convention");
  if (!change.first.whole())
    return fmt::format("{}rows {} to {} (open).", text, change.first.joints(),
                       change.first.all_joints);
  return text + "row " + std::to_string(change.first.joints()) + " (the tool).";
}

std::string size_of(const identify::Displacement& found) {
  return fixed(found.largest_mm, 4) + " mm (95 %: " + fixed(found.low_mm, 4) + " to " +
         fixed(found.high_mm, 4) + ')';
}

std::string usual_range(const Change& change) {
  const auto& linear = change.first.reach.linear;
  const bool any_linear = std::find(linear.begin(), linear.end(), true) != linear.end();
  return any_linear ? fmt::format("{0} deg or {0} mm", kUsualTurn_deg)
                    : fmt::format("{} deg", kUsualTurn_deg);
}

std::string displacement(const Change& change) {
  std::string text;
  if (change.changes_displacement)
    text = "moved by up to " + size_of(*change.changes_displacement) +
           " by the changes that are named. All differences, noise included, make ";
  else
    text = "all differences, noise included, move it by up to ";
  return text + size_of(change.displacement) + " at the worst of " +
         std::to_string(kComparedPoses) + " poses " +
         (change.first.with_limits ? "within the limits"
                                   : "up to " + usual_range(change) + " from home") +
         ". Base and tool are fitted: what they take up does not count.";
}

}  // namespace

std::string change_text(const Change& change) {
  const ChangeDecimals decimals(change);
  std::string out = paragraph("", verdict(change, decimals)) + '\n';
  out += paragraph("A  ", about(change.first)) + paragraph("B  ", about(change.second));
  for (const std::string& note : change.notes) out += paragraph("!  ", note);
  out += '\n' + table(change, decimals) + '\n';
  out += paragraph("zero      ", "theta minus the controller's angle at home");
  out += paragraph("U         ", "expanded uncertainty of B - A, k = 2");
  out += paragraph("smallest  ", "a change of this number alone that would be named in " +
                                     fixed(100 * kPower, 0) + " % of cases, at level " +
                                     fmt::format("{}", change.level));
  out += paragraph("together  ", "T2 = " + fixed(change.test.t_squared, 1) + " of " +
                                     rsi::counted(change.arms.numbers.size(), "number", "numbers") +
                                     ", p " + (change.test.p < kLeastChance ? "" : "= ") +
                                     chance_text(change.test.p));
  out += paragraph("left out  ", left_out(change));
  out += paragraph(change.first.whole() ? "tool      " : "frame     ", displacement(change));
  return out;
}

}  // namespace sweepd
