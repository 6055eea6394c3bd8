#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "daemon/krl/krl_position.hpp"
#include "daemon/results/correction.hpp"
#include "daemon/results/report.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/text_layout.hpp"
#include "daemon/text/units.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using identify::ControllerNumber;
using Kind = ControllerNumber::Kind;
using Verdict = ControllerNumber::Verdict;

constexpr std::size_t kLabelWidth = 10;
constexpr const char* kExpanded =
    "expanded uncertainty, k = 2: of the result, of what is left as noise, and of numbers that are "
    "left and may be off all the same";

std::string labelled(const std::string& label, const std::string& words) {
  return paragraph(left(label, kLabelWidth), words);
}

bool is_length(const ControllerNumber& number, const identify::Arm& arm) {
  return number.kind == Kind::a || number.kind == Kind::b || arm.is_linear(number.joint);
}

std::string verdict_text(const ControllerNumber& number, const char* to_do) {
  switch (number.verdict) {
    case Verdict::significant:
      return to_do;
    case Verdict::not_significant:
      return "leave: not significant";
    case Verdict::inseparable:
      return "leave: not told from base, tool or others";
  }
  return "";
}

std::string levels_text(const Correction& correction, const std::string& corrected) {
  std::string text = "\nWhat is left of the poses\n\n" + left_header() +
                     left_line("base and tool", correction.frames);
  if (!corrected.empty()) text += left_line(corrected, correction.left);
  return text + left_line("all that the result tells", correction.identified);
}

std::string frames_text(const Correction& correction) {
  const auto base = correction.base_frame();
  const auto u = (kCoverage * correction.base_sigma()).eval();
  const auto& determined = correction.fit.frames_determined;
  const bool base_told =
      std::all_of(determined.begin(), determined.begin() + 6, [](bool told) { return told; });
  std::string text = "$BASE = " + krl_frame_text(base) + "\n";
  text += labelled("", "The frame of the measurements, in $ROBROOT.");
  text += base_told
              ? labelled("U (k = 2)",
                         fmt::format("{:.4f}, {:.4f}, {:.4f} mm along X, Y, Z; {:.4f}, {:.4f}, "
                                     "{:.4f} deg about them",
                                     u(0), u(1), u(2), degrees(u(3)), degrees(u(4)), degrees(u(5))))
              : labelled("U (k = 2)", "The poses do not tell all of it from the tool.");
  for (std::size_t t = 0; t < correction.targets.size(); ++t) {
    const Eigen::Vector3d of_tool = kCoverage * correction.tool_sigma_mm(t);
    const auto first = determined.begin() + static_cast<std::ptrdiff_t>(6 + 3 * t);
    const bool told = std::all_of(first, first + 3, [](bool one) { return one; });
    text += "\n$TOOL = " + krl_frame_text(correction.tool_frame(t)) + "\n";
    text += labelled("", "Target " + correction.targets[t] + ", in $FLANGE.");
    text += labelled("U (k = 2)", told ? fmt::format("{:.4f}, {:.4f}, {:.4f} mm along X, Y, Z",
                                                     of_tool.x(), of_tool.y(), of_tool.z())
                                       : "The poses do not tell all of it from the base.");
  }
  text += levels_text(correction, "");
  return text + "\n" +
         labelled("to do",
                  "Enter the tool with its number, and the base with the number that programs of "
                  "points in the frame of the measurements use.");
}

std::string mastering_text(const Correction& correction) {
  const auto& arm = correction.specified;
  std::string text = left("joint", 7) + left("unit", 5) + right("offset", 10) + right("U", 10) +
                     right("chance", 10) + "  what to do\n";
  for (const ControllerNumber& zero : correction.fit.numbers) {
    const bool known = zero.verdict != Verdict::inseparable;
    const bool length = is_length(zero, arm);
    const auto in_unit = [&](double value) { return length ? value : degrees(value); };
    text += left(std::to_string(zero.joint + 1), 7) + left(length ? "mm" : "deg", 5) +
            (known ? number(in_unit(correction.offset(zero)), 4, 10) : right("-", 10)) +
            (known ? number(in_unit(kCoverage * zero.sigma), 4, 10) : right("-", 10)) +
            right(known ? chance_text(zero.chance) : "-", 10) + "  " +
            verdict_text(zero, "master anew") + "\n";
  }
  text += "\n" + labelled("offset",
                          "the zero with which the specified lengths fit the measured arm best, as "
                          "the controller counts. It also makes up for lengths that are off, so it "
                          "is not where the joint stands. `--level machine-data` tells zeros and "
                          "lengths apart.");
  text += labelled("U", kExpanded);
  text += labelled("chance",
                   "that an arm whose zero is right shows as much (all joints together, Holm); "
                   "named are those below 0.05");
  const auto& zeros = correction.fit.numbers;
  if (!std::any_of(zeros.begin(), zeros.end(), [](const auto& zero) { return zero.taken(); }))
    return text + labelled("to do", "Nothing. No zero is seen to be off.") +
           levels_text(correction, "");
  text += labelled("to do",
                   "Of each joint named: move it to where it is mastered, less the offset, as the "
                   "controller shows it, and master it there. Then the controller shows q + offset "
                   "where it showed q.");
  return text + levels_text(correction, "and the zeros that are named");
}

std::string machine_data_text(const Correction& correction) {
  const auto& arm = correction.specified;
  std::string text = left("number", 8) + left("unit", 5) + right("specified", 12) +
                     right("proposed", 12) + right("change", 10) + right("U", 9) + "  verdict\n";
  for (const ControllerNumber& number_ : correction.fit.numbers) {
    const bool length = is_length(number_, arm);
    const auto in_unit = [&](double value) { return length ? value : degrees(value); };
    const auto& row = arm.rows[number_.joint];
    const double specified = number_.kind == Kind::a       ? row.a_mm
                             : number_.kind == Kind::b     ? row.b_mm
                             : number_.kind == Kind::alpha ? row.alpha_rad
                             : length                      ? row.b_mm
                                                           : row.theta_rad;
    const bool known = number_.verdict != Verdict::inseparable;
    const double change = number_.taken() ? number_.change : 0;
    text += left(name_of(number_, arm), 8) + left(length ? "mm" : "deg", 5) +
            number(in_unit(specified), 4, 12) + number(in_unit(specified + change), 4, 12) +
            (known ? number(in_unit(number_.change), 4, 10) : right("-", 10)) +
            (known ? number(in_unit(kCoverage * number_.sigma), 4, 9) : right("-", 9)) + "  " +
            (number_.taken() ? number_.kind == Kind::zero ? "by mastering" : "propose"
             : known         ? "leave"
                             : "not told apart") +
            "\n";
  }
  text += "\n" + labelled("numbers",
                          "of the specified table, b, theta, a, alpha as in the result. What is "
                          "zero or a right angle there stays: the controller's inverse kinematics "
                          "need parallel axes, right angles and a wrist.");
  text += labelled("U", kExpanded);
  text += levels_text(correction, "and what is proposed");
  return text + "\n" +
         labelled("not held",
                  fmt::format("The identified arm is {:.4f} mm (rms; max {:.4f} mm) from what this "
                              "structure can hold, over the poses.",
                              correction.unheld.rms_mm, correction.unheld.most_mm));
}

std::string targets_text(const Correction& correction) {
  const auto& points = correction.program->points;
  std::string text = left("point", 16) + left("type", 8) + right("line", 6) +
                     right("shift mm", 11) + right("turn deg", 11) + right("left mm", 10) + "\n";
  double most = 0, squares = 0;
  std::size_t corrected = 0;
  const CorrectedPoint* farthest = nullptr;
  for (const CorrectedPoint& point : points) {
    text += left(point.name, 15) + " " + left(point.type, 8) + right(std::to_string(point.line), 6);
    if (point.left) {
      text += "  as it was\n";
      continue;
    }
    text += number(point.shift_mm, 4, 11) + number(degrees(point.turn_rad), 4, 11) +
            number(point.expected_mm, 4, 10) + (point.outside ? "  beyond the poses" : "") + "\n";
    ++corrected;
    squares += point.expected_mm * point.expected_mm;
    if (point.shift_mm >= most) farthest = &point;
    most = std::max(most, point.shift_mm);
  }
  text += "\n";
  if (farthest != nullptr)
    text +=
        labelled("shift", fmt::format("{} of {} corrected, by {:.4f} mm at most ({})", corrected,
                                      rsi::counted(points.size(), "point"), most, farthest->name));
  if (corrected > 0)
    text += labelled("left", fmt::format("{:.4f} mm is expected between where a point is wanted "
                                         "and where it is reached (rms: what the result does not "
                                         "know, and the noise of one pose)",
                                         std::sqrt(squares / static_cast<double>(corrected))));
  text += labelled("before", fmt::format("{:.4f} mm (rms) was left of the poses with the best base "
                                         "and tool alone",
                                         correction.frames.rms_mm));
  return text + labelled("kept",
                         "Base and tool stay as they are. A point is wanted where the specified "
                         "arm has it with the base and tool of `--level frames`. What positions "
                         "of the target do not tell, its turn about the last axis, is not "
                         "corrected.");
}

}  // namespace

std::string correction_text(const Correction& correction) {
  const auto title = [&](const char* what) {
    return correction.robot + ": " + what + ", by " +
           rsi::counted(correction.poses, "static pose") + "\n\n";
  };
  std::string out;
  switch (correction.level) {
    case CorrectionLevel::frames:
      out = title("base and tool") + frames_text(correction);
      break;
    case CorrectionLevel::mastering:
      out = title("zeros of the joints") + mastering_text(correction);
      break;
    case CorrectionLevel::machine_data:
      out = title("a proposal of machine data") + machine_data_text(correction);
      break;
    case CorrectionLevel::targets:
      out = title("points of a program") + targets_text(correction);
      break;
  }
  const auto warnings = correction.warnings();
  if (!warnings.empty()) out += "\n";
  for (const std::string& warning : warnings) out += paragraph("! ", warning);
  return out;
}

}  // namespace sweepd
