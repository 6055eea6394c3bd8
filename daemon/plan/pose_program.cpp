#include <stdexcept>

#include <spdlog/fmt/fmt.h>

#include "daemon/plan/krl_program.hpp"
#include "daemon/text/numbers.hpp"

namespace sweepd {
namespace {

constexpr int kTableDecimals = 3;

std::string name_of_pose(std::size_t index) {
  return fmt::format("POSE_{}", index + 1);
}

std::string pose_src(const PosePlan& plan, const KrlOptions& options) {
  KrlWriter krl(options);
  krl.begin_program(fmt::format("{} static poses", plan.poses.size()));
  krl.line("; First run: T1, override 10 %, hand on the enabling switch.");
  krl.line("; Look at every pose and every way: nothing here knows what stands in the cell.");
  krl.line("; Deselect or reset the program after a HALT; do not start it again from there.")
      .line();
  krl.init();
  krl.line(fmt::format("BAS (#TOOL,{} ) ; for the load that it carries", options.tool));
  krl.line("BAS (#BASE,0 )").line("$BASE = $NULLFRAME").line();
  krl.go_home(plan.home_deg.size(), plan.task.speed_deg_s);
  if (!options.rsi_file.empty()) krl.rsi_on();
  for (std::size_t i = 0; i < plan.poses.size(); ++i) {
    if (plan.poses[i].over_home) krl.line("PTP HOME_POSE ; the straight way is not free");
    krl.line("PTP " + name_of_pose(i)).line("WAIT SEC DWELL_S");
  }
  krl.line("PTP HOME_POSE");
  if (!options.rsi_file.empty()) krl.rsi_off();
  krl.line("END");
  return std::move(krl).text();
}

std::string pose_dat(const PosePlan& plan, const KrlOptions& options) {
  KrlWriter krl(options);
  krl.begin_data();
  krl.line("; The rest at each pose, in seconds");
  krl.line("DECL REAL DWELL_S=" + krl_number(plan.task.dwell_s));
  if (!options.rsi_file.empty()) krl.declare_rsi();
  krl.line("DECL AXIS HOME_POSE=" + krl_pose(plan.home_deg));
  for (std::size_t i = 0; i < plan.poses.size(); ++i)
    krl.line("DECL AXIS " + name_of_pose(i) + "=" + krl_pose(plan.poses[i].angles_deg));
  krl.line("ENDDAT");
  return std::move(krl).text();
}

}  // namespace

std::vector<std::string> krl_findings(const PosePlan& plan, const KrlOptions& options) {
  SweepPlan same;
  same.home_deg = plan.home_deg;
  same.positioning_speed_deg_s = plan.task.speed_deg_s;
  return krl_findings(same, options);
}

KrlProgram krl_program(const PosePlan& plan, const KrlOptions& options) {
  if (const auto findings = krl_findings(plan, options); !findings.empty())
    throw std::invalid_argument(findings.front());
  return {pose_src(plan, options), pose_dat(plan, options)};
}

std::string pose_table(const PosePlan& plan) {
  std::string csv =
      "# Static poses in the order of the program. Fill in where the target was seen, then run\n"
      "# sweepd identify on this file with the robot description.\npose,x_mm,y_mm,z_mm";
  for (std::size_t j = 1; j <= plan.home_deg.size(); ++j) csv += fmt::format(",a{}_deg", j);
  csv += '\n';
  for (std::size_t i = 0; i < plan.poses.size(); ++i) {
    csv += fmt::format("{},,,", i + 1);
    for (const double angle : plan.poses[i].angles_deg)
      append_fixed(csv += ',', angle, kTableDecimals);
    csv += '\n';
  }
  return csv;
}

}  // namespace sweepd
