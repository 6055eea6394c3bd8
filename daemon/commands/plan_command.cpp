#include "daemon/commands/plan_command.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "daemon/commands/outputs.hpp"
#include "daemon/plan/plan_proposal.hpp"
#include "daemon/plan/plan_text.hpp"
#include "daemon/results/result_files.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/text/progress.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

void check(const PlanOptions& options) {
  if (options.krl.has_value() != options.output.has_value())
    throw std::invalid_argument(
        "--krl, --output: expected both or neither: name the dialect and the folder of the "
        "program");
  if (options.write_plan && !options.propose)
    throw std::invalid_argument("--write-plan: expected --propose, as it writes the proposal");
}

Measurement measurement_of(const PlanOptions& options) {
  return {std::chrono::milliseconds(options.cycle_ms), options.precision, options.wobble_deg,
          options.position_sigma_mm};
}

KrlOptions krl_options(const PlanOptions& options, const RobotDescription& robot) {
  KrlOptions krl;
  krl.dialect = *options.krl;
  krl.name = options.name;
  krl.tool = options.krl_tool;
  krl.rsi_file = options.rsi_file;
  for (const JointLimits& limits : robot.limits) {
    krl.max_speed_deg_s.emplace_back();
    if (std::isfinite(limits.max_speed_deg_s)) krl.max_speed_deg_s.back() = limits.max_speed_deg_s;
  }
  return krl;
}

/// Throws with all that KRL cannot express.
void check_krl(const SweepPlan& plan, const KrlOptions& krl) {
  std::string text;
  for (const std::string& finding : krl_findings(plan, krl))
    text += (text.empty() ? "" : "\n") + plan.file.string() + ": KRL: " + finding;
  if (!text.empty()) throw ConfigError(text);
}

std::string remark(const PlanOptions& options, const Proposal& proposal) {
  return "Proposed by `sweepd plan` from " + options.plan.filename().string() +
         ", with wider sweeps of " + rsi::counted(proposal.steps.size(), "joint") +
         ".\nsweepd knows joint limits, but neither the cell nor the robot's own "
         "body:\ndrive every new range by hand in T1 first.";
}

}  // namespace

int plan(const PlanOptions& options, std::ostream& out, std::ostream& errors) {
  check(options);
  RobotDescription robot = load_robot(options.robot);
  const SweepPlan given = load_plan(options.plan);
  if (options.tool_mm && robot.arm) robot.arm->tool_mm = Eigen::Vector3d(options.tool_mm->data());
  const Measurement measurement = measurement_of(options);
  std::optional<KrlProgram> program;
  if (options.krl) {
    const KrlOptions krl = krl_options(options, robot);
    check_krl(given, krl);
    program = krl_program(given, krl);
  }

  const PlanOutlook outlook = look_ahead(robot, given, measurement);
  out << plan_text(robot, outlook, measurement);
  std::optional<Proposal> proposal;
  if (options.propose) {
    Progress progress("plan");
    proposal =
        propose(robot, outlook, measurement, options.margin_deg,
                [&](double done, double total) { progress.update(done, total, "proposal"); });
    progress.clear();
    out << proposal_text(outlook, *proposal, options.margin_deg);
  }
  const PlanOutlook& judged = proposal && !options.krl ? proposal->outlook : outlook;
  out << std::flush;
  for (const std::string& refusal : judged.refusals) errors << "sweepd: " << refusal << '\n';
  if (!judged.refusals.empty()) return 1;

  std::vector<std::pair<std::filesystem::path, std::string>> files;
  if (proposal && options.write_plan)
    files.emplace_back(*options.write_plan,
                       plan_toml(proposal->outlook.plan, remark(options, *proposal)));
  if (program) {
    const auto base = *options.output / options.name;
    files.emplace_back(base.string() + ".src", program->src);
    files.emplace_back(base.string() + ".dat", program->dat);
  }
  const Outputs outputs({options.robot, options.plan}, options.force);
  for (const auto& [file, content] : files) outputs.check_same(file, content);
  if (program) make_folder(*options.output);
  for (const auto& [file, content] : files) write_output(file, content);
  const char* before = "\nwritten     ";
  for (const auto& [file, content] : files) {
    out << before << file.string() << '\n';
    before = "            ";
  }
  return 0;
}

}  // namespace sweepd
