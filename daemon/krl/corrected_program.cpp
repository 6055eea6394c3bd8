#include "daemon/krl/corrected_program.hpp"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "daemon/krl/krl_position.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "identify/correction/wrist_arm.hpp"

namespace sweepd {
namespace {

using AxisAngles = std::array<double, 6>;
using Eigen::Isometry3d;
using identify::CorrectedJoints;

constexpr std::array<std::string_view, 6> kCartesian = {"X", "Y", "Z", "A", "B", "C"};
constexpr std::array<std::string_view, 6> kAxes = {"A1", "A2", "A3", "A4", "A5", "A6"};
/// Nearer to where axes 4 and 6 lie along each other small corrections turn joints far.
constexpr double kSingular_rad = 1 * identify::kDegree;
/// A joint is taken for where it stands up to here: what files print.
constexpr double kPrinted_rad = 1e-4 * identify::kDegree;
/// Decimals of a corrected number, at least: 1 um, and 0.1 um at a metre's distance.
constexpr int kLeastDecimals_mm = 3;
constexpr int kLeastDecimals_deg = 4;
constexpr int kMostPointDecimals = 9;
constexpr std::size_t kMostFindings = 20;

bool is_point(const KrlAggregate& one) {
  return one.type == "E6POS" || one.type == "POS" || one.type == "E6AXIS" || one.type == "AXIS";
}

bool is_axis_point(const KrlAggregate& one) {
  return one.type == "E6AXIS" || one.type == "AXIS";
}

const std::array<std::string_view, 6>& names_of(const KrlAggregate& point) {
  return is_axis_point(point) ? kAxes : kCartesian;
}

int decimals_in(std::string_view number) {
  const auto point = number.find('.');
  if (point == std::string_view::npos || number.find_first_of("eE") != std::string_view::npos)
    return 0;
  return static_cast<int>(number.size() - point - 1);
}

struct Replacement {
  std::size_t at;
  std::size_t size;
  std::string text;
};

std::string replaced(std::string_view text, std::vector<Replacement> by) {
  std::sort(by.begin(), by.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
  std::string out;
  std::size_t from = 0;
  for (const Replacement& one : by) {
    out.append(text, from, one.at - from).append(one.text);
    from = one.at + one.size;
  }
  return out.append(text.substr(from));
}

const KrlAggregate* named(const std::vector<KrlAggregate>& all, const std::string& name) {
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const KrlAggregate& one) { return one.name == name; });
  return found != all.end() ? &*found : nullptr;
}

class Program {
 public:
  Program(std::string_view text, const identify::PoseFit& identified,
          const identify::PlacedArm& controller, const ProgramOptions& options)
      : text_(text),
        identified_(identified),
        controller_(controller),
        options_(options),
        all_(krl_aggregates(text)),
        arm_(identify::WristArm::of(controller.arm)) {
    const auto& linear = controller.arm.linear;
    if (controller.arm.joints() != 6 ||
        std::find(linear.begin(), linear.end(), true) != linear.end())
      throw KrlError("points of programs are corrected for arms of six joints that turn");
    for (const KrlAggregate& one : all_)
      if (is_point(one))
        for (std::size_t k = 0; k < 6; ++k)
          if (const KrlField* field = one.find(names_of(one)[k])) {
            int& most = k < 3 && !is_axis_point(one) ? decimals_mm_ : decimals_deg_;
            most = std::clamp(decimals_in(field->text), most, kMostPointDecimals);
          }
  }

  CorrectedProgram corrected() {
    CorrectedProgram program;
    std::string findings;
    for (const std::string& name : options_.leave)
      if (named(all_, name) == nullptr)
        throw KrlError("has no point " + name + ": correct --leave");
    std::size_t points = 0, count = 0;
    for (const KrlAggregate& one : all_) {
      if (!is_point(one)) continue;
      ++points;
      try {
        program.points.push_back(corrected(one));
      } catch (const KrlError& error) {
        if (++count <= kMostFindings)
          findings +=
              fmt::format("{}line {}: {}", findings.empty() ? "" : "\n", one.line, error.what());
      }
    }
    if (points == 0)
      throw KrlError(
          "gives no point of type E6POS, POS, E6AXIS or AXIS a value: there is nothing to "
          "correct");
    if (count > kMostFindings) findings += fmt::format("\nand {} more", count - kMostFindings);
    if (count > 0) throw KrlError(findings);
    program.text = replaced(text_, std::move(replacements_));
    return program;
  }

 private:
  /// Throws what `point` is refused for, beginning with its name.
  [[noreturn]] static void refuse(const KrlAggregate& point, const std::string& why) {
    throw KrlError(point.name + " " + why);
  }

  /// The FDAT of XP1 is FP1.
  [[nodiscard]] static std::string data_of(const KrlAggregate& point) {
    return point.name.starts_with('X') ? "F" + point.name.substr(1) : "";
  }

  /// Of TOOL_DATA or BASE_DATA, by the number in the point's FDAT.
  [[nodiscard]] Isometry3d configured(const KrlAggregate& point, const std::string& what) const {
    const std::string option = what == "TOOL" ? "--tool" : "--base";
    const KrlAggregate* data = named(all_, data_of(point));
    if (data == nullptr) refuse(point, "has no FDAT that says its " + what + ": give " + option);
    if (const KrlField* frame = data->find("IPO_FRAME");
        frame != nullptr && in_capitals(frame->text) == "#TCP")
      refuse(
          point,
          "has its tool outside of the robot (#TCP), which is not corrected: leave it (--leave)");
    const KrlField* field = data->find(what + "_NO");
    const auto number = field != nullptr ? field->bits() : std::nullopt;
    if (!number) refuse(point, "has an FDAT without " + what + "_NO: give " + option);
    if (*number == 0) return Isometry3d::Identity();
    const std::string wanted = fmt::format("{}_DATA[{}]", what, *number);
    const KrlAggregate* frame = named(*options_.config, wanted);
    if (frame == nullptr) refuse(point, "uses " + wanted + ", which the file of --config has not");
    return krl_frame(*frame);
  }

  [[nodiscard]] Isometry3d frame_of(const KrlAggregate& point, const std::string& what,
                                    const std::optional<Isometry3d>& given) const {
    if (given) return *given;
    if (options_.config) return configured(point, what);
    refuse(point, what == "TOOL" ? "needs its tool: give --tool or --config"
                                 : "needs its base: give --base or --config");
  }

  [[nodiscard]] PointFrames frames_of(const KrlAggregate& point) const {
    if (!is_axis_point(point))
      return {frame_of(point, "BASE", options_.base), frame_of(point, "TOOL", options_.tool)};
    const bool told = options_.tool || (options_.config && named(all_, data_of(point)) != nullptr);
    return {Isometry3d::Identity(),
            told ? frame_of(point, "TOOL", options_.tool) : measured_tool()};
  }

  /// Points of axes without a tool are corrected for the measured target.
  [[nodiscard]] Isometry3d measured_tool() const {
    return options_.flange.inverse() * Eigen::Translation3d(controller_.targets_mm.front());
  }

  [[nodiscard]] AxisAngles told_angles(const KrlAggregate& point) const {
    AxisAngles angles;
    for (std::size_t j = 0; j < 6; ++j) angles[j] = radians(krl_number(point, kAxes[j]));
    return angles;
  }

  [[nodiscard]] AxisAngles angles_of(const KrlAggregate& point, const PointFrames& frames) const {
    if (is_axis_point(point)) return told_angles(point);
    if (!arm_)
      refuse(point,
             "cannot be told from other joints that reach it: the specified arm has no axes 2 and "
             "3 that are parallel, or no wrist whose axes meet");
    const Isometry3d pose = krl_frame(point);
    const KrlField* status = point.find("S");
    const KrlField* turn = point.find("T");
    if (status == nullptr || turn == nullptr)
      refuse(point,
             "has no S and T, which say with which joints it is reached: teach it again, or "
             "leave it (--leave)");
    const auto status_bits = status->bits(), turn_bits = turn->bits();
    if (!status_bits || !turn_bits || *turn_bits > 63) refuse(point, "has an S or T that is none");
    if ((*status_bits & kAbsolutelyAccurate) != 0)
      refuse(point,
             "was taught on an absolutely accurate robot (S has bit 4), which corrects by itself: "
             "leave it (--leave)");
    const Isometry3d last = frames.base * pose * frames.tool.inverse() * options_.flange.inverse();
    const auto found = arm_->angles_at(last, posture_of(*status_bits));
    if (!found)
      refuse(point, fmt::format("is out of the specified arm's reach with S {}: check base, tool, "
                                "flange, and whether the file is this robot's",
                                *status_bits));
    return turned_as(*found, *turn_bits);
  }

  void check_limits(const KrlAggregate& point, const AxisAngles& angles) const {
    for (std::size_t j = 0; j < std::min<std::size_t>(6, options_.limits.size()); ++j) {
      const auto& [least, most] = options_.limits[j];
      if (angles[j] < least - kPrinted_rad || angles[j] > most + kPrinted_rad)
        refuse(point, fmt::format("has joint {} at {:.3f} deg, beyond its limits of {:.1f} and "
                                  "{:.1f} deg",
                                  j + 1, degrees(angles[j]), degrees(least), degrees(most)));
    }
  }

  CorrectedPoint corrected(const KrlAggregate& point) {
    CorrectedPoint done;
    done.name = point.name;
    done.line = point.line;
    done.type = point.type;
    if (std::find(options_.leave.begin(), options_.leave.end(), point.name) !=
        options_.leave.end()) {
      done.left = true;
      return done;
    }
    const PointFrames frames = frames_of(point);
    const CorrectedJoints joints(identified_, controller_, options_.flange * frames.tool);
    done.from_target_mm = joints.from_target_mm();
    const AxisAngles before = angles_of(point, frames);
    check_limits(point, before);
    if (arm_ && arm_->from_singular_rad(before) < kSingular_rad)
      refuse(point, fmt::format("lies in the wrist's singularity (joint 5 at {:.3f} deg), where "
                                "corrections turn joints far: move it, or leave it (--leave)",
                                degrees(before[4])));
    const auto reached = joints.reach({before.begin(), before.end()});
    if (!reached.converged)
      refuse(point, "cannot be reached by the identified arm: leave it (--leave)");
    std::copy(reached.angles_rad.begin(), reached.angles_rad.end(), done.angles_rad.begin());
    check_limits(point, done.angles_rad);
    if (arm_ && !(arm_->posture(done.angles_rad) == arm_->posture(before)))
      refuse(point,
             "would come into another posture (S): it lies at the edge of two, leave it (--leave)");
    const auto from = joints.believed({before.begin(), before.end()});
    const auto to = joints.believed(reached.angles_rad);
    done.shift_mm = (to.translation() - from.translation()).norm();
    done.turn_rad =
        Eigen::AngleAxisd(Eigen::Matrix3d(to.linear() * from.linear().transpose())).angle();
    if (done.shift_mm > options_.largest_shift_mm)
      refuse(point, fmt::format("would be shifted by {:.3f} mm, more than --largest-shift {} mm: "
                                "check base, tool, flange, and whether the file is this robot's",
                                done.shift_mm, options_.largest_shift_mm));
    done.expected_mm = reached.expected_mm;
    for (std::size_t j = 0; j < std::min<std::size_t>(6, options_.measured.size()); ++j)
      if (done.angles_rad[j] < options_.measured[j].first ||
          done.angles_rad[j] > options_.measured[j].second)
        done.outside = true;
    write(point, frames, to, done);
    return done;
  }

  /// `to`: the tool in the measurement frame.
  void write(const KrlAggregate& point, const PointFrames& frames, const Isometry3d& to,
             CorrectedPoint& done) {
    std::array<double, 6> values = done.angles_rad;
    std::array<int, 6> decimals{};
    decimals.fill(decimals_deg_);
    if (!is_axis_point(point)) {
      const Isometry3d told = frames.base.inverse() * controller_.base.inverse() * to;
      const auto abc = identify::abc_of(told.linear());
      for (std::size_t k = 0; k < 3; ++k) {
        values[k] = told.translation()(static_cast<Eigen::Index>(k));
        values[k + 3] = abc[k];
        decimals[k] = decimals_mm_;
      }
    }
    for (std::size_t k = 0; k < 6; ++k) {
      const KrlField& field = *point.find(names_of(point)[k]);
      const bool length = !is_axis_point(point) && k < 3;
      replacements_.push_back({field.at, field.text.size(),
                               fixed(length ? values[k] : degrees(values[k]), decimals[k])});
    }
    if (is_axis_point(point)) return;
    const KrlField& turn = *point.find("T");
    const unsigned before = *turn.bits(), after = turn_of(done.angles_rad);
    if (before == after) return;
    done.turn_bits = {before, after};
    replacements_.push_back({turn.at, turn.text.size(), std::to_string(after)});
  }

  std::string_view text_;
  const identify::PoseFit& identified_;
  const identify::PlacedArm& controller_;
  const ProgramOptions& options_;
  std::vector<KrlAggregate> all_;
  std::optional<identify::WristArm> arm_;
  int decimals_mm_ = kLeastDecimals_mm;
  int decimals_deg_ = kLeastDecimals_deg;
  std::vector<Replacement> replacements_;
};

}  // namespace

CorrectedProgram corrected_program(std::string_view text, const identify::PoseFit& identified,
                                   const identify::PlacedArm& controller,
                                   const ProgramOptions& options) {
  return Program(text, identified, controller, options).corrected();
}

}  // namespace sweepd
