#include "daemon/plan/krl_program.hpp"

#include <algorithm>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>

namespace sweepd {
namespace {

constexpr double kLeastToolRadius_mm = 20;

class ProgramWriter {
 public:
  ProgramWriter(const SweepPlan& plan, const KrlOptions& options)
      : plan_(plan), krl_(options), options_(options) {}

  [[nodiscard]] std::string src() && {
    krl_.begin_program("the sweep plan " + plan_.file.filename().string());
    krl_.line(
        "; First run: T1, override 10 %, hand on the enabling switch, sweepd listening already.");
    krl_.line("; Look through all poses first: nothing here knows what stands in the cell.");
    krl_.line("; Deselect or reset the program after a HALT; do not start it again from there.");
    krl_.line();
    krl_.init();
    frames();
    krl_.go_home(plan_.home_deg.size(), plan_.positioning_speed_deg_s);
    krl_.rsi_on();
    for (std::size_t i = 0; i < plan_.sweeps.size(); ++i) sweep(i);
    krl_.rsi_off();
    krl_.line("END");
    return std::move(krl_).text();
  }

  [[nodiscard]] std::string dat() && {
    krl_.begin_data();
    krl_.line("; The rest at both ends of a sweep, in seconds");
    krl_.line("DECL REAL REST_S=" + krl_number(std::chrono::duration<double>(plan_.dwell).count()));
    krl_.declare_rsi();
    const bool linear = std::any_of(plan_.sweeps.begin(), plan_.sweeps.end(),
                                    [](const PlannedSweep& sweep) { return sweep.linear; });
    krl_.line(std::string("; Where the joints stand that do not sweep, in degrees") +
              (linear ? ", linear ones in mm" : ""));
    krl_.line("DECL AXIS HOME_POSE=" + krl_pose(plan_.home_deg));
    for (std::size_t i = 0; i < plan_.sweeps.size(); ++i)
      for (const PlannedMove& move : moves_of(plan_, plan_.sweeps[i])) {
        if (move.place.empty()) continue;
        auto angles = plan_.home_deg;
        angles[plan_.sweeps[i].joint - 1] = move.to_deg;
        krl_.line("DECL AXIS " + name(i, move) + "=" + krl_pose(angles));
      }
    krl_.line("ENDDAT");
    return std::move(krl_).text();
  }

 private:
  /// Of the place where a move ends.
  static std::string name(std::size_t sweep, const PlannedMove& move) {
    return move.place.empty() ? "HOME_POSE" : fmt::format("SWEEP{}_{}", sweep + 1, move.place);
  }

  void frames() {
    krl_.line("; Positions are those of the tool point in the robot's own frame.");
    krl_.line(fmt::format("BAS (#TOOL,{} )", options_.tool));
    krl_.line("BAS (#BASE,0 )").line("$BASE = $NULLFRAME");
    const std::string least = krl_number(kLeastToolRadius_mm);
    krl_.halt_unless(
        fmt::format("(($TOOL.X*$TOOL.X+$TOOL.Y*$TOOL.Y) < {0}*{0})", least),
        fmt::format("the tool point lies on axis {}: choose a tool {} mm or more off it",
                    plan_.home_deg.size(), least));
    krl_.line();
  }

  void sweep(std::size_t index) {
    const PlannedSweep& sweep = plan_.sweeps[index];
    krl_.line(fmt::format(";FOLD sweep {}: A{} from {} to {}", index + 1, sweep.joint,
                          krl_number(sweep.start_deg), krl_number(sweep.end_deg)));
    krl_.in();
    for (const PlannedMove& move : moves_of(plan_, sweep)) {
      krl_.speed(sweep.joint, move.speed_deg_s);
      krl_.line("PTP " + name(index, move));
      if (!move.place.empty()) krl_.line("WAIT SEC REST_S");
    }
    krl_.out();
    krl_.line(";ENDFOLD").line();
  }

  const SweepPlan& plan_;
  KrlWriter krl_;
  const KrlOptions& options_;
};

}  // namespace

KrlProgram krl_program(const SweepPlan& plan, const KrlOptions& options) {
  if (const auto findings = krl_findings(plan, options); !findings.empty())
    throw std::invalid_argument(findings.front());
  return {ProgramWriter(plan, options).src(), ProgramWriter(plan, options).dat()};
}

}  // namespace sweepd
