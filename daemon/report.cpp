#include "daemon/report.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include "daemon/numbers.hpp"
#include "daemon/units.hpp"
#include "identify/dh_comparison.hpp"

namespace sweepd {
namespace {

using identify::DhNumber;
using identify::Identification;
using identify::Knowledge;

constexpr std::size_t kColumns = 80;

/// `label` and the words of `text`, in lines that fit the terminal; all but the first begin in the
/// column in which `text` began.
std::string paragraph(const std::string& label, std::string_view text) {
  const auto width = [](std::string_view word) {
    return static_cast<std::size_t>(std::count_if(word.begin(), word.end(), [](char c) {
      return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
    }));
  };
  std::string out = label;
  std::size_t column = label.size();
  while (!text.empty()) {
    const auto word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    if (column > label.size() && column + 1 + width(word) > kColumns) {
      out += "\n" + std::string(label.size(), ' ');
      column = label.size();
    } else if (column > label.size()) {
      out += ' ';
      ++column;
    }
    out += word;
    column += width(word);
  }
  return out + "\n";
}

std::string right(std::string text, std::size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}
std::string left(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}
std::string number(double value, int decimals, std::size_t width) {
  return right(fixed(value, decimals), width);
}
std::string number(const std::optional<double>& value, int decimals, std::size_t width) {
  return value ? number(*value, decimals, width) : right("-", width);
}

/// Axes from elsewhere: nothing was swept.
bool is_given(const Outcome& outcome) {
  return outcome.source_kind == "axes";
}

std::string points_text(const PointCounts& points) {
  const auto counted = [](std::size_t number, const std::string& noun) {
    return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
  };
  std::string text = std::to_string(points.points) + " in " + counted(points.sweeps, "sweep") +
                     " of " + counted(points.files, "file");
  if (points.targets > 1) text += ", " + counted(points.targets, "target point");
  return paragraph("points      ", text);
}

std::string source_text(const Outcome& outcome) {
  if (outcome.points) return points_text(*outcome.points);
  if (is_given(outcome))
    return paragraph("axes        ",
                     std::to_string(outcome.identification.joints.size()) + ", given as lines");
  const auto& counts = outcome.counts;
  const auto& link = counts.link;
  std::string telegrams = std::to_string(link.telegrams);
  if (counts.cycle_ms) telegrams += ", one every " + std::to_string(*counts.cycle_ms) + " ms";
  std::string late = "late by the controller's count " + std::to_string(link.late_replies);
  if (link.late_runs > 0)
    late += ", in " + std::to_string(link.late_runs) + " runs of at most " +
            std::to_string(link.longest_late_run);
  std::string text =
      paragraph("telegrams   ", telegrams) +
      paragraph("link        ", "lost " + std::to_string(link.lost) + ", duplicated " +
                                    std::to_string(link.duplicated) + ", reordered " +
                                    std::to_string(link.reordered) + ", malformed " +
                                    std::to_string(counts.malformed_in_all()) + ", restarts " +
                                    std::to_string(link.restarts)) +
      paragraph("replies     ", late);
  if (counts.unusable_values > 0)
    text += paragraph("values      ", std::to_string(counts.unusable_values) + " were no numbers");
  return text;
}

std::string home_text(const Identification& found) {
  std::string text;
  for (std::size_t j = 0; j < found.home_rad.size(); ++j)
    if (found.home_rad[j])
      text += (text.empty() ? "" : ", ") + ("A" + std::to_string(j + 1)) + " " +
              fixed(degrees(*found.home_rad[j]), 3);
  return text.empty() ? text : paragraph("home        ", text + " deg");
}

std::string circles(const Identification& found) {
  std::string text =
      "joint  sweeps  used  samples  arc deg  radius mm  plane um  radial um  axis deg\n";
  for (std::size_t j = 0; j < found.joints.size(); ++j) {
    const auto& joint = found.joints[j];
    std::size_t used = 0;
    std::size_t samples = 0;
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
      if (!joint.used[s]) continue;
      ++used;
      samples += joint.sweeps[s].samples->size();
    }
    text += right(std::to_string(j + 1), 5) + right(std::to_string(joint.sweeps.size()), 8) +
            right(std::to_string(used), 6) + right(std::to_string(samples), 9);
    if (joint.circle)
      text += number(degrees(joint.circle->arc_rad), 2, 9) +
              number(joint.circle->radius_mm, 3, 11) +
              number(1000 * joint.circle->plane_rms_mm, 2, 10) +
              number(1000 * joint.circle->radial_rms_mm, 2, 11);
    if (joint.axis) text += number(degrees(joint.axis->direction_sigma_rad()), 5, 10);
    text += "\n";
  }
  return text;
}

std::string dh_table(const Identification& found) {
  const auto differences = compare_with_specified(found);
  const bool compared = !differences.empty();
  std::string text = "DH parameters by the paper's circles (estimator circle)\n\n" +
                     left("joint", 22) + right("identified", 14) + right("std unc", 11);
  if (compared) text += right("specified", 14) + right("difference", 14);
  text += "\n";
  bool conventions = false;
  for (std::size_t i = 0; i < found.dh.size(); ++i) {
    const auto& row = found.dh[i];
    const auto line = [&](std::string_view name, const DhNumber& found_number, double scale,
                          int decimals, double specified, const std::optional<double>& difference) {
      const bool identified = found_number.knowledge == Knowledge::identified;
      std::optional<double> value;
      if (found_number.knowledge != Knowledge::undetermined) value = scale * found_number.value;
      text += right(name == "b      mm" ? std::to_string(i + 1) : "", 5) + "   " +
              left(std::string(name), 14) + number(value, decimals, 14);
      if (found_number.knowledge == Knowledge::by_convention) {
        text += right("(set)", 11);
        conventions = true;
      } else {
        text += number(identified ? std::optional(scale * found_number.sigma) : std::nullopt,
                       decimals, 11);
      }
      if (compared)
        text +=
            number(scale * specified, decimals, 14) +
            number(difference ? std::optional(scale * *difference) : std::nullopt, decimals, 14);
      text += "\n";
    };
    const identify::DhRow expected = compared ? found.specified[i] : identify::DhRow{};
    const identify::DhDifference difference = compared ? differences[i] : identify::DhDifference{};
    line("b      mm", row.b_mm, 1, 4, expected.b_mm, difference.b_mm);
    line("theta  deg", row.theta_rad, degrees(1), 5, expected.theta_rad, difference.theta_rad);
    line("a      mm", row.a_mm, 1, 4, expected.a_mm, difference.a_mm);
    line("alpha  deg", row.alpha_rad, degrees(1), 5, expected.alpha_rad, difference.alpha_rad);
    if (i + 1 < found.dh.size())
      text += "        to the next axis: " + std::string(identify::text(row.relation)) + "\n";
  }
  if (conventions) text += "\n(set): not determined by the data, but set by convention.\n";
  return text;
}

std::string box_text(const identify::BoundingBox& box) {
  const auto lengths = box.lengths_mm;
  return "Smallest box around the points: " + fixed(lengths(0), 3) + " x " + fixed(lengths(1), 3) +
         " x " + fixed(lengths(2), 3) + " mm, " + fixed(box.volume_mm3() * 1e-9, 4) + " m3\n";
}

}  // namespace

std::string report(const Outcome& outcome) {
  const Identification& found = outcome.identification;
  std::string status(identify::text(found.status));
  if (!found.reason.empty()) status += ": " + found.reason;
  std::string text = paragraph("robot       ", outcome.robot) + paragraph("status      ", status) +
                     source_text(outcome) + home_text(found) + "\n";
  if (!is_given(outcome)) text += circles(found) + "\n";
  const bool any_axis = found.status != identify::Status::failed && found.bounding_box;
  if (any_axis || is_given(outcome)) text += dh_table(found);
  if (any_axis) text += "\n" + box_text(*found.bounding_box);
  if (!found.warnings.empty()) {
    text += "\nWarnings\n";
    for (const auto& warning : found.warnings)
      text += paragraph("  - ", warning.message + " [" + warning.code + "]");
  }
  return text;
}

std::string sweep_line(const identify::Sweep& sweep) {
  const std::string who =
      sweep.joint ? "joint " + std::to_string(*sweep.joint + 1) : std::string("a joint");
  return who + ": sweep of " +
         (sweep.direction > 0   ? "+"
          : sweep.direction < 0 ? "-"
                                : "") +
         fixed(degrees(sweep.range_rad), 1) + " deg in " +
         fixed(sweep.last().time_s - sweep.first().time_s, 2) + " s, " +
         std::to_string(sweep.samples->size()) + " samples";
}

}  // namespace sweepd
