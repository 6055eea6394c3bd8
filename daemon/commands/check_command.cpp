#include "daemon/commands/check_command.hpp"

#include <set>
#include <string>

#include <CLI/CLI.hpp>
#include <spdlog/fmt/fmt.h>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/exit_codes.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/machine.hpp"
#include "daemon/plan/plan_outlook.hpp"
#include "daemon/points/device_lines.hpp"
#include "daemon/settings/answers.hpp"
#include "daemon/settings/robot_setup.hpp"
#include "daemon/settings/settings.hpp"
#include "daemon/settings/toml_table.hpp"
#include "rsi/counted.hpp"
#include "rsi/server/port_owner.hpp"
#include "rsi/telegram/ethernet_config.hpp"
#include "rsi/telegram/reply.hpp"
#include "rsi/telegram/rsi_context.hpp"
#include "rsi/telegram/wire_layout.hpp"

namespace sweepd {
namespace {

class Check {
 public:
  Check(const CheckOptions& options, std::ostream& out) : options_(options), findings_(out) {}

  int run() {
    for (const auto& file : options_.contexts) contexts_.push_back(context(file));
    if (options_.config) settings(*options_.config);
    for (const auto& file : options_.ethernet_configs)
      if (const auto config = ethernet(file)) {
        if (const auto text = warning_of_commands(*config); !text.empty()) findings_.warning(text);
        fit(*config);
      }
    return findings_.wrong_file() ? kConfigError : findings_.not_ready() ? kFailed : 0;
  }

 private:
  void settings(const std::filesystem::path& file) {
    try {
      const Settings settings = load_settings(file);
      findings_.ok(file.string() + ": " + rsi::counted(settings.robots.size(), "robot"));
      for (const auto& robot : settings.robots) check(robot);
      if (settings.http.listen && !options_.files_only) pages(*settings.http.listen);
    } catch (const ConfigError& problem) {
      findings_.error(problem.what());
    }
  }

  void check(const RobotSettings& robot) {
    findings_.heading("robot " + robot.name);
    try {
      const RobotSetup setup = load_setup(robot);
      findings_.ok(robot.description.string() + ": " + rsi::counted(setup.joints, "joint") +
                   (setup.description->arm ? "" : ", no specified DH table"));
      if (const auto named = robot.signals.angles.size(); named < setup.joints)
        findings_.warning(fmt::format(
            "{}: signals.angles of robot {}: expected {} signals, one for each joint of {}, found "
            "{}: name them all, or the joints that are not named are not seen",
            options_.config->string(), robot.name, setup.joints, robot.description.string(),
            named));
      if (robot.plan) plan(*setup.description, *setup.plan);
      if (robot.device.there()) device(robot.device);
    } catch (const ConfigError& problem) {
      findings_.error(problem.what());
    }
    std::optional<rsi::EthernetConfig> config;
    if (robot.ethernet_config)
      config = ethernet(*robot.ethernet_config);
    else
      findings_.warning(robot.name + ": ethernet_config: not set: " + kWithoutEthernetConfig);
    if (config) {
      compare(robot, *config);
      answers(robot, *config);
      fit(*config);
    }
    if (options_.files_only) return;
    const bool tcp = config && config->protocol == rsi::EthernetConfig::Protocol::TCP;
    judge_machine(look_at_machine(robot, tcp ? rsi::Transport::tcp : rsi::Transport::udp), robot,
                  config ? &*config : nullptr, findings_);
  }

  void device(const DeviceSettings& device) {
    try {
      const DeviceLines lines(device.columns);
      findings_.ok("device on " + text(device.listen) + ": lines of " + device.columns.text +
                   (lines.with_times() ? "" : ", with the times at which they come"));
    } catch (const ConfigError& problem) {
      findings_.error(problem.what());
    }
    if (options_.files_only) return;
    const auto transport = device.listen.tcp ? rsi::Transport::tcp : rsi::Transport::udp;
    const auto owner = rsi::port_owner(transport, device.listen.endpoint);
    if (!owner.empty() && !owner.starts_with("sweepd "))
      findings_.error("device on " + text(device.listen) + ": " + owner +
                      " has the port: end it, or choose another port");
  }

  void pages(const rsi::Endpoint& listen) {
    const auto place = "pages on http://" + rsi::text(listen) + "/: ";
    const auto owner = rsi::port_owner(rsi::Transport::tcp, listen);
    if (owner.empty())
      findings_.ok(place + "free");
    else if (owner.starts_with("sweepd "))
      findings_.ok(place + owner + " serves them");
    else
      findings_.warning(place + owner +
                        " has the port: robots are served without pages; choose another port with "
                        "`listen` of [http]");
  }

  /// What the plan would bring, with the decimals of the context where one was given.
  void plan(const RobotDescription& robot, const SweepPlan& plan) {
    const auto file = plan.file.string();
    if (!robot.arm)
      return findings_.ok(file + ": " + rsi::counted(plan.sweeps.size(), "sweep") +
                          ", within the limits");
    Measurement measurement;
    for (const auto& context : contexts_)
      if (context) measurement.precision = context->precision.value_or(1);
    const PlanOutlook outlook = look_ahead(robot, plan, measurement);
    const auto place = file + ": ";
    for (const auto& refusal : outlook.refusals) findings_.error(place + refusal);
    for (const auto& warning : outlook.warnings) findings_.warning(place + warning.message);
    if (outlook.refusals.empty())
      findings_.ok(file + ": " + rsi::counted(plan.sweeps.size(), "sweep") +
                   ", within the limits, each axis will be found");
  }

  std::optional<rsi::EthernetConfig> ethernet(const std::filesystem::path& file) {
    try {
      auto config = rsi::EthernetConfig::load(file);
      findings_.ok(fmt::format(
          "{}: sends {}, receives {}, port {}, {}", file.string(),
          rsi::counted(config.send.size(), "tag"), rsi::counted(config.receive.size(), "tag"),
          config.port, config.protocol == rsi::EthernetConfig::Protocol::TCP ? "TCP" : "UDP"));
      for (const auto& text : config.warnings) findings_.warning(text);
      for (const auto& text : warnings_of_answers(config)) findings_.warning(text);
      findings_.line("reply", config.only_send
                                  ? "none: ONLYSEND is TRUE"
                                  : std::string(rsi::Reply(config).with_ipoc("123456")));
      return config;
    } catch (const rsi::EthernetConfigError& problem) {
      findings_.error(problem.what());
      return std::nullopt;
    }
  }

  void answers(const RobotSettings& robot, const rsi::EthernetConfig& config) {
    const auto objections = objections_to_answers(robot, config);
    for (const auto& objection : objections) findings_.error(objection);
    if (const auto tags = commanding_tags(config); objections.empty() && !tags.empty())
      findings_.ok(fmt::format(
          "{} of these tags can move the robot or switch something: they are answered with zeros, "
          "as answers_with_zeros wants, and only in streams whose beginning sweepd saw",
          tags.size()));
  }

  std::optional<rsi::RsiContext> context(const std::filesystem::path& file) {
    try {
      auto context = rsi::RsiContext::load(file);
      findings_.ok(fmt::format("{}: Precision {}, Ethernet file {}", file.string(),
                               context.precision ? fmt::to_string(*context.precision) : "not set",
                               context.config_file));
      for (const auto& text : context.warnings) findings_.warning(text);
      return context;
    } catch (const rsi::RsiContextError& problem) {
      findings_.error(problem.what());
      return std::nullopt;
    }
  }

  void fit(const rsi::EthernetConfig& config) {
    for (const auto& context : contexts_)
      if (context)
        for (const auto& text : context->compare(config)) findings_.warning(text);
  }

  void compare(const RobotSettings& robot, const rsi::EthernetConfig& config) {
    if (config.port != robot.listen.port)
      findings_.error(
          fmt::format("{}: PORT: expected {} as in `listen` of robot {}, found {}: make them equal",
                      config.name, robot.listen.port, robot.name, config.port));
    const auto address = rsi::parse_address(config.ip_number);
    if (address && robot.listen.address != 0 && *address != robot.listen.address)
      findings_.error(fmt::format(
          "{}: IP_NUMBER: expected {} as in `listen` of robot {}, found {}: make them equal",
          config.name, rsi::address_text(robot.listen.address), robot.name, config.ip_number));
    std::set<std::string> sent;
    for (const auto& element : rsi::wire_layout(config.send))
      for (const auto& field : element.fields)
        sent.insert(field.attribute.empty() ? element.name : element.name + "." + field.attribute);
    const auto want = [&](const std::string& signal, const std::string& consequence) {
      if (sent.contains(signal)) return true;
      findings_.warning(config.name + ": SEND: " + signal +
                        " of `signals` is not sent: " + consequence);
      return false;
    };
    for (const auto& signal : robot.signals.position)
      if (!want(signal,
                "without positions nothing can be identified; add DEF_RIst, or name the "
                "signal that holds it"))
        break;
    for (const auto& signal : robot.signals.angles)
      if (!want(signal,
                "without angles the joints are known from the plan's order alone; add "
                "DEF_AIPos, or set `plan`"))
        break;
  }

  const CheckOptions& options_;
  Findings findings_;
  std::vector<std::optional<rsi::RsiContext>> contexts_;
};

}  // namespace

int check(const CheckOptions& options, std::ostream& out) {
  return Check(options, out).run();
}

CLI::App* add_check(CLI::App& app, CheckOptions& options) {
  auto* command = app.add_subcommand(
      "check",
      "Check settings, robot, plan, the controller's files and this machine against each other\n"
      "Run it as the user that serves: `sudo -u sweepd sweepd check`. It prints the reply that "
      "the controller would get.");
  command
      ->add_option("--config", options.config, "Check these settings and all files that they name")
      ->type_name("FILE")
      ->default_str("those of `sweepd run`, where no other file is given");
  command
      ->add_option("--ethernet-config", options.ethernet_configs,
                   "Check these Ethernet files by themselves")
      ->type_name("FILE");
  command
      ->add_option("--context", options.contexts,
                   "Check these RSI contexts of the controller (.rsi.xml or .rsix) against the "
                   "Ethernet files")
      ->type_name("FILE");
  command->add_flag("--files-only", options.files_only,
                    "Check files only, and not the port, addresses, real time and disk of this "
                    "machine");
  command->footer(
      exit_status({{0, "Nothing is wrong. There may be warnings."},
                   {kFailed, "The files are right, but this machine cannot do what they say."},
                   kWrongUsage,
                   {kConfigError, "A file is wrong."}}));
  return command;
}

}  // namespace sweepd
