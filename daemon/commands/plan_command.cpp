#include "daemon/commands/plan_command.hpp"

#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <spdlog/fmt/fmt.h>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/outputs.hpp"
#include "daemon/plan/plan_proposal.hpp"
#include "daemon/plan/plan_text.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/system/process_state.hpp"
#include "daemon/text/progress.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

void check(const PlanOptions& options) {
  if (options.krl.has_value() != options.output.has_value())
    throw std::invalid_argument(
        "--krl, --output: expected both or neither: name the dialect and the folder of the "
        "program");
  if (options.margin_deg && !options.propose)
    throw std::invalid_argument(
        "--margin-deg: expected --propose, whose ranges keep it: add it, or leave --margin-deg "
        "out");
  if (options.write_plan && !options.propose)
    throw std::invalid_argument("--write-plan: expected --propose, as it writes the proposal");
  if (!options.krl && !options.name.empty())
    throw std::invalid_argument(
        "--name: expected --krl, as it names the KRL program: add it, or leave --name out");
}

Measurement measurement_of(const PlanOptions& options) {
  return {std::chrono::milliseconds(options.cycle_ms), options.precision, options.wobble_deg,
          options.position_sigma_mm};
}

/// Throws with all of the options that KRL cannot express.
void check_krl_options(const PlanOptions& options) {
  if (!options.krl && !options.rsi_file.empty())
    throw std::invalid_argument(
        "--rsi-file: expected --krl, whose program loads it: add it, or leave --rsi-file out");
  if (!options.krl) return;
  std::string text;
  for (const std::string& finding : krl_findings(options.krl_options({})))
    text += (text.empty() ? "" : "\n") + finding;
  if (!text.empty()) throw std::invalid_argument(text);
}

/// Throws with all that KRL cannot express.
void check_krl(const SweepPlan& plan, const KrlOptions& krl) {
  std::string text;
  for (const std::string& finding : krl_findings(plan, krl))
    text += (text.empty() ? "" : "\n") + plan.file.string() + ": KRL: " + finding;
  if (!text.empty()) throw ConfigError(text);
}

constexpr std::string_view kProposed = "Proposed by `sweepd plan` from ";

std::string remark(const PlanOptions& options, const Proposal& proposal) {
  return std::string(kProposed) + options.plan.filename().string() + ", with wider sweeps of " +
         rsi::counted(proposal.steps.size(), "joint") +
         ".\nsweepd knows joint limits, but neither the cell nor the robot's own "
         "body:\ndrive every new range by hand in T1 first.";
}

/// Throws where the proposal could not be written, before it is computed. What only the proposal
/// itself shows is left for then: that an earlier one is there and holds something else.
void check_write_plan(const PlanOptions& options, const Outputs& outputs) {
  if (!options.write_plan) return;
  const std::filesystem::path& file = *options.write_plan;
  outputs.check_made_again(file, "# " + std::string(kProposed));
  const auto folder = std::filesystem::absolute(file).parent_path();
  if (options.output && !std::filesystem::exists(folder)) return;  // may be made for the program
  const OutputFile can_be_opened(file);
}

}  // namespace

std::string PlanOptions::file_name() const {
  if (!name.empty()) return name;
  return poses.count > 0 ? "sweepd_poses" : "sweepd_sweeps";
}

KrlOptions PlanOptions::krl_options(const RobotDescription& of) const {
  KrlOptions options;
  options.dialect = *krl;
  options.name = file_name();
  options.tool = krl_tool;
  options.rsi_file = rsi_file;
  options.limits = of.limits;
  return options;
}

int plan(const PlanOptions& options, std::ostream& out, std::ostream& errors) {
  keep_memory();
  check_krl_options(options);
  if (options.poses.count > 0) return plan_static_poses(options, out);
  check(options);
  RobotDescription robot = load_robot(options.robot);
  const SweepPlan given = load_plan(options.plan);
  if (options.tool_mm && robot.arm) robot.arm->tool_mm = Eigen::Vector3d(options.tool_mm->data());
  const Measurement measurement = measurement_of(options);
  std::optional<KrlProgram> program;
  if (options.krl) {
    const KrlOptions krl = options.krl_options(robot);
    check_krl(given, krl);
    program = krl_program(given, krl);
  }

  const Outputs outputs({options.robot, options.plan}, options.force);
  check_write_plan(options, outputs);
  const PlanOutlook outlook = look_ahead(robot, given, measurement);
  out << plan_text(robot, outlook, measurement);
  std::optional<Proposal> proposal;
  if (options.propose) {
    Progress progress("plan");
    proposal =
        propose(robot, outlook, measurement, options.margin(),
                [&](double done, double total) { progress.update(done, total, "proposal"); });
    progress.clear();
    out << proposal_text(outlook, *proposal, options.margin());
  }
  const PlanOutlook& judged = proposal && !options.krl ? proposal->outlook : outlook;
  out << std::flush;
  for (const std::string& refusal : judged.refusals) errors << "sweepd: " << refusal << '\n';
  if (!judged.refusals.empty()) return kFailed;

  std::vector<std::pair<std::filesystem::path, std::string>> files;
  if (proposal && options.write_plan)
    files.emplace_back(*options.write_plan,
                       plan_toml(proposal->outlook.plan, remark(options, *proposal)));
  if (program) {
    const auto base = *options.output / options.file_name();
    files.emplace_back(base.string() + ".src", program->src);
    files.emplace_back(base.string() + ".dat", program->dat);
  }
  write_edited(outputs, program ? options.output : std::nullopt, files, out);
  return 0;
}

namespace {

/// What a rehearsal takes for granted. `sweeps` is --plan.
void add_assumptions(CLI::App& command, PlanOptions& options, CLI::Option& sweeps) {
  add_number(command, "--cycle-ms", options.cycle_ms, whole_number(1, 1000),
             "Assume a telegram every so many milliseconds: 4 on IPO_FAST, 12 on IPO")
      ->needs(&sweeps);
  add_number(command, "--precision", options.precision, whole_number(0, rsi::kMostPrecision),
             "Assume numbers with this many decimals, as set at the ETHERNET object")
      ->needs(&sweeps);
  add_number(command, "--wobble-deg", options.wobble_deg, number_between(0.0, kMostWobble_deg),
             "Assume that every joint wobbles with this standard deviation, in degrees");
  command
      .add_option("--position-sigma-mm", options.position_sigma_mm,
                  "Assume that another device measures positions and no angles, with this "
                  "standard deviation of each coordinate in mm")
      ->check(number_between(1e-6, 100.0))
      ->default_str(fmt::format("positions and angles are the controller's; of static poses {}",
                                PoseTask().position_sigma_mm));
  add_tool(command, options.tool_mm);
}

void add_proposal(CLI::App& command, PlanOptions& options) {
  auto* propose = command.add_flag("--propose", options.propose,
                                   "Look for better sweep ranges within the joint limits");
  command
      .add_option("--margin-deg", options.margin_deg,
                  "Keep proposed ranges and poses this many degrees off the joint limits")
      ->check(number_between(0.0, 90.0))
      ->default_str(std::to_string(PlanOptions::kMargin_deg));
  command.add_option("--write-plan", options.write_plan, "Write the proposed plan to this file")
      ->type_name("FILE")
      ->needs(propose);
}

void add_krl(CLI::App& command, PlanOptions& options) {
  auto* krl = command
                  .add_option_function<std::string>(
                      "--krl",
                      [&options](const std::string& dialect) {
                        options.krl = dialect == "krc2"   ? KrlDialect::krc2
                                      : dialect == "krc4" ? KrlDialect::krc4
                                                          : KrlDialect::iiqka;
                      },
                      "Write the KRL program of the plan that was given, for a KR C2 (krc2: RSI "
                      "2), a KR C4 or KR C5 with KSS (krc4: RSI 3 to 5), or a KR C5 with iiQKA "
                      "(iiqka: RSI 6)")
                  ->type_name("krc2|krc4|iiqka")
                  ->check(CLI::IsMember({"krc2", "krc4", "iiqka"}));
  auto* output =
      command
          .add_option("--output", options.output,
                      "Write the KRL program into this folder, as NAME.src and NAME.dat, and the "
                      "table of static poses as NAME.csv")
          ->type_name("DIR");
  krl->needs(output);
  command.add_option("--name", options.name, "Give the KRL program this name")
      ->type_name("NAME")
      ->needs(output)
      ->default_str("sweepd_sweeps, of poses sweepd_poses");
  add_number(command, "--krl-tool", options.krl_tool, whole_number(1, kMostKrlTools),
             "Use the controller's tool of this number in the KRL program, whose point is the "
             "target")
      ->needs(krl);
  command
      .add_option("--rsi-file", options.rsi_file,
                  "Let the KRL program load this Ethernet file (krc2) or RSI context (krc4, "
                  "iiqka)")
      ->type_name("NAME")
      ->needs(krl)
      ->default_str("sweepd_udp.xml, sweepd.rsi or sweepd; a program of poses has no RSI then");
}

}  // namespace

CLI::App* add_plan(CLI::App& app, PlanOptions& options) {
  auto* command = app.add_subcommand(
      "plan",
      "Check a sweep plan before the robot moves: predict uncertainties, propose better ranges, "
      "write the KRL program\n"
      "A simulated robot rehearses the plan. With --poses, static poses are chosen. The "
      "uncertainties are those of the Fisher information of what the estimator would use.\n"
      "sweepd knows joint limits, but neither the cell nor the robot's own body: run every new "
      "plan in T1 first.");
  add_robot(*command, options.robot);
  auto* what = command->add_option_group("What");
  auto* sweeps = what->add_option("--plan", options.plan, "Read the sweep plan from this file")
                     ->type_name("FILE");
  auto* poses =
      what->add_option("--poses", options.poses.count,
                       "Choose so many static poses in place of sweeps, which a device will "
                       "measure: those that together tell most")
          ->check(whole_number(1, 1000))
          ->type_name("N");
  what->require_option(1);
  add_assumptions(*command, options, *sweeps);
  add_proposal(*command, options);
  add_krl(*command, options);
  add_pose_options(*command, options.poses, *poses);
  add_force(*command, options.force);
  command->footer(exit_status(
      {kOk,
       {kFailed,
        "The plan is refused and nothing is written: an axis would not be determined, or a sweep "
        "not be recognised. Or a file cannot be written."},
       kWrongUsage,
       {kConfigError,
        "A configuration file is wrong, or the plan goes beyond the limits of the robot. All "
        "findings are listed."}}));
  return command;
}

}  // namespace sweepd
