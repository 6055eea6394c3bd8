#include "daemon/commands/command_options.hpp"

#include <cstddef>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/commands/check_command.hpp"
#include "daemon/commands/compare_command.hpp"
#include "daemon/commands/export_command.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/identify_command.hpp"
#include "daemon/commands/inspect_command.hpp"
#include "daemon/commands/replay_command.hpp"
#include "daemon/commands/report_command.hpp"
#include "daemon/commands/run_command.hpp"
#include "daemon/commands/validate_command.hpp"
#include "daemon/devices/device_formats.hpp"
#include "daemon/points/axes_file.hpp"
#include "daemon/points/points_file.hpp"
#include "daemon/text/text_layout.hpp"
#include "identify/sweeps/sample.hpp"

namespace sweepd {
namespace {

constexpr ExitCode kDoubtful{
    3,
    "The result is doubtful: the data contradict themselves, or what a built robot can be. The "
    "result files are written. The first lines of the report say why."};

void add_filter(CLI::App& command, rsi::ConversationFilter& filter) {
  command.add_option("--port", filter.port, "Take the conversation whose RSI server has this port")
      ->type_name("PORT")
      ->default_str("that of the busiest conversation");
  command
      .add_option("--controller", parsed(filter.controller, rsi::parse_address),
                  "Take the conversation of the controller with this IPv4 address")
      ->type_name("ADDRESS")
      ->default_str("that of the busiest conversation");
}

void add_traces(CLI::App& command, std::vector<std::filesystem::path>& traces) {
  command.add_option("TRACE", traces, "Capture files (pcap or pcapng) of one stream, in any order")
      ->required()
      ->type_name("");
}

}  // namespace

void add_force(CLI::App& command, bool& force) {
  command.add_flag(
      "--force", force,
      "Overwrite also files that sweepd did not write or that somebody has edited, but "
      "never an input file");
}

void add_quiet(CLI::App& command, bool& quiet) {
  command.add_flag("--quiet", quiet, "Print no progress and no report");
}

namespace {

CLI::App* add_run(CLI::App& app, RunOptions& options) {
  auto* command = app.add_subcommand(
      "run",
      "Serve robot controllers: answer and record their RSI telegrams, identify the robots\n"
      "The command stays in the foreground until SIGTERM or SIGINT. SIGHUP makes it read the "
      "settings again.");
  command->add_option("--config", options.config, "Read the settings from this file")
      ->capture_default_str()
      ->type_name("FILE");
  command->add_option("--output", options.output, "Keep recordings and results below this folder")
      ->type_name("DIR")
      ->default_str("the `output` of each robot's settings");
  command
      ->add_option("--listen", parsed(options.listen, rsi::parse_endpoint),
                   "Receive telegrams on this IPv4 address and port, where the settings have one "
                   "robot")
      ->type_name("ADDRESS:PORT")
      ->default_str("the `listen` of the robot's settings");
  command->add_flag_callback(
      "--help-settings",
      [] {
        std::cout << settings_text();
        throw CLI::Success();
      },
      "Print every key of the settings file with its meaning and default, and exit");
  command->footer(exit_status({kOk, kError, kWrongUsage, kWrongFile}));
  return command;
}

CLI::App* add_replay(CLI::App& app, ReplayOptions& options) {
  auto* command = app.add_subcommand(
      "replay",
      "Identify a robot from captures of its RSI telegrams (pcap, pcapng)\n"
      "The captures may be sweepd's own recordings, or come from Wireshark or tcpdump. The result "
      "files are those that `sweepd run` would have written.");
  add_traces(*command, options.traces);
  command->add_option("--config", options.config, "Read the settings from this file")
      ->type_name("FILE")
      ->default_str("no settings");
  command->add_option("--robot", options.robot, "Read the robot description from this file")
      ->type_name("FILE")
      ->default_str("that of the settings");
  command
      ->add_option("--plan", options.plan,
                   "Read the sweep plan from this file. Telegrams without angles need its order of "
                   "joints")
      ->type_name("FILE")
      ->default_str("that of the settings");
  command->add_option("--output", options.output, "Write the result files into this folder")
      ->type_name("DIR")
      ->default_str("no result files");
  add_filter(*command, options.filter);
  add_quiet(*command, options.quiet);
  add_force(*command, options.force);
  command->footer(exit_status({kOk, kError, kWrongUsage, kDoubtful, kWrongFile}));
  return command;
}

CLI::App* add_inspect(CLI::App& app, InspectOptions& options) {
  auto* command = app.add_subcommand(
      "inspect",
      "Judge the RSI link in captures by its loss, jitter, reply latency and late replies\n"
      "The verdict is good, marginal or bad. Each reason comes with what to do about it. The "
      "captures may be of any RSI server.");
  add_traces(*command, options.traces);
  add_filter(*command, options.filter);
  command
      ->add_option("--json", options.json,
                   "Write the report to this file as JSON too. With -, print JSON in place of the "
                   "text")
      ->type_name("FILE");
  add_quiet(*command, options.quiet);
  add_force(*command, options.force);
  command->footer(exit_status(
      {{0, "The link is good or marginal."},
       {kFailed,
        "The link is bad, or the captures have no RSI, or a file cannot be read or written."},
       kWrongUsage}));
  return command;
}

/// What --format takes.
std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const DeviceFormat& format : device_formats()) names.emplace_back(format.name);
  names.emplace_back(kOwnFormat);
  names.emplace_back("list");
  return names;
}

std::string formats_in_words() {
  std::string words;
  for (const DeviceFormat& format : device_formats())
    words.append(words.empty() ? "" : ", ")
        .append(format.name)
        .append(" (")
        .append(format.title)
        .append(")");
  return words;
}

CLI::App* add_identify(CLI::App& app, IdentifyOptions& options) {
  auto* command = app.add_subcommand(
      "identify", "Identify a robot from points or joint axes that another device measured (CSV)");
  command->add_option("FILE", options.points, "Files of measured points")->type_name("");
  command
      ->add_option("--axes", options.axes,
                   "Read joint axes from this file in place of points, and make the DH table of "
                   "them")
      ->type_name("FILE");
  command
      ->add_option(
          "--columns", options.columns,
          "Name the columns, with commas between, where a file has no header or a wrong one. The "
          "name - or _ skips a column. Write --columns=-,x_mm where the first name is -")
      ->type_name("NAMES");
  command
      ->add_option_function<std::string>(
          "--format",
          [&options](const std::string& format) {
            options.list_formats = format == "list";
            options.format = options.list_formats ? "" : format;
          },
          "Read all files of points as this device's, whatever they look like. The word list "
          "prints the formats")
      ->type_name("NAME")
      ->check(CLI::IsMember(format_names()))
      ->default_str("as each file's content tells");
  command->add_flag("--per-joint", options.per_joint,
                    "Take each file as the points of one joint, beginning with joint 1");
  command->add_flag("--poses", options.poses,
                    "Take each line as a static pose: joint angles and where the target stood. "
                    "Files without times, or with a column pose, are taken so anyway");
  command
      ->add_option("--robot", options.robot,
                   "Read the robot description from this file, and compare the result with it")
      ->type_name("FILE")
      ->default_str("no comparison");
  command
      ->add_option("--plan", options.plan,
                   "Read home, directions and order of joints from this sweep plan, for points "
                   "without angles")
      ->type_name("FILE");
  command->add_option("--joints", options.joints, "Set the number of joints of the arm")
      ->check(CLI::Range(std::size_t{1}, identify::kMostJoints))
      ->default_str("that of the description, the plan or the points, else 6");
  command
      ->add_option_function<std::string>(
          "--frame",
          [&options](const std::string& frame) { options.device_frame = frame == "device"; },
          "Say whose frame the points are in. The robot's place in a device's frame is identified "
          "too")
      ->type_name("device|robot")
      ->check(CLI::IsMember({"device", "robot"}))
      ->default_str("device");
  command->add_option("--output", options.output, "Write the result files into this folder")
      ->type_name("DIR")
      ->default_str("no result files");
  add_quiet(*command, options.quiet);
  add_force(*command, options.force);
  const auto text = [](std::string_view words) { return paragraph("  ", words); };
  command->footer(
      exit_status({kOk, kError, kWrongUsage, kDoubtful, kWrongFile}) + "\nFiles:\n" +
      text("A file of points is text with commas, semicolons, tabs or blanks between its columns. "
           "Lines that begin with # are passed over. The header names columns and units, in any "
           "order:") +
      '\n' + text(std::string(kPointColumns) + '.') + '\n' +
      text("The column target has a number or a name for each target point. sweepd's own "
           "samples.csv and sweeps.csv are such files.") +
      '\n' +
      text(
          "Files of measuring devices are read as they are, with their own columns and units. Each "
          "is recognised by its content. By the names that --format takes, they are " +
          formats_in_words() + '.') +
      '\n' +
      text("Points make sweeps in one of three ways. With times t_s, sweeps are found as in live "
           "data. With a column joint, each run of lines of the same joint is a sweep. With "
           "--per-joint, each file is a sweep, or with times several strokes and rests.") +
      '\n' +
      text("A file of axes has a line for each joint, with a point of its axis and the direction. "
           "Its header names these columns: " +
           std::string(kAxisColumns) + '.'));
  return command;
}

CLI::App* add_validate(CLI::App& app, ValidateOptions& options) {
  auto* command = app.add_subcommand(
      "validate",
      "Judge a result by static poses that it was not made of\n"
      "It tells how far the poses lie from where the result has them, whether the stated "
      "uncertainties hold, and what each level of correction leaves.");
  command->add_option("RESULT", options.result, "Folder of a result of static poses")
      ->required()
      ->type_name("");
  command->add_option("FILE", options.points, "Files of static poses, as identify reads them")
      ->required()
      ->type_name("");
  command
      ->add_option("--columns", options.columns,
                   "Name the columns, with commas between, where a file has no header")
      ->type_name("NAMES");
  command->add_option("--output", options.output, "Write the JSON to this file")
      ->type_name("FILE")
      ->default_str("validation.json in RESULT");
  add_force(*command, options.force);
  command->footer(exit_status({kOk, kError, kWrongUsage}));
  return command;
}

CLI::App* add_report(CLI::App& app, ReportOptions& options) {
  auto* command =
      app.add_subcommand("report",
                         "Make the measurement report of result folders, with pictures\n"
                         "Every run writes one by itself, as report.html. This command makes it "
                         "again: with facts that "
                         "data cannot know, as a PDF, or of several folders side by side.");
  command->add_option("DIR", options.folders, "Folders that run, replay or identify has written")
      ->required()
      ->type_name("");
  command
      ->add_option("--facts", options.facts,
                   "Print what this file states: serial_number, controller, payload, temperature, "
                   "device, certificate, place, date, operator, customer, remarks. Each is a text")
      ->type_name("FILE");
  command->add_option("--output", options.output, "Write the report to this file")
      ->type_name("FILE")
      ->default_str("report.html in DIR, or here where there are several");
  command->add_flag("--pdf", options.pdf,
                    "Print it as a PDF, too, beside it. This needs Debian's package chromium");
  add_force(*command, options.force);
  command->footer(exit_status(
      {kOk,
       kError,
       kWrongUsage,
       {kConfigError, "The file of --facts is wrong. Standard error names the line."}}));
  return command;
}

CLI::App* add_compare(CLI::App& app, CompareOptions& options) {
  auto* command = app.add_subcommand(
      "compare",
      "Tell whether a robot has changed between two results\n"
      "It compares the numbers that neither conventions nor the place of base, tool and home "
      "change. First it tests all of them together, then each of them, and says how large a "
      "change would have been seen.");
  command->add_option("A", options.first, "The earlier result: a folder, or its result.json")
      ->required()
      ->type_name("");
  command->add_option("B", options.second, "The later result: a folder, or its result.json")
      ->required()
      ->type_name("");
  command
      ->add_option("--level", options.level,
                   "Call this share of unchanged pairs changed, and no more")
      ->check(CLI::Range(1e-6, 0.5))
      ->capture_default_str()
      ->type_name("SHARE");
  command->add_flag("--json", options.json, "Print JSON in place of the text");
  command->footer(exit_status({{0, "No change is seen."},
                               {kChanged, "The robot has changed."},
                               {kFailed,
                                "The two cannot be compared. A line on standard error says why, "
                                "and what to do."},
                               kWrongUsage}));
  return command;
}

CLI::App* add_export(CLI::App& app, ExportOptions& options) {
  auto* command = app.add_subcommand(
      "export", "Write every signal of the telegrams in captures as CSV, one row a telegram");
  add_traces(*command, options.traces);
  command->add_option("--csv", options.csv, "Write the table to this file. With -, print it")
      ->required()
      ->type_name("FILE");
  add_filter(*command, options.filter);
  add_force(*command, options.force);
  command->footer(exit_status({kOk, kError, kWrongUsage}));
  return command;
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

/// Adds a command whose options live as long as it does.
template <typename Options, typename Work>
void add(CLI::App& app, CLI::App* (*describe)(CLI::App&, Options&), const Work& work,
         int& exit_code) {
  const auto options = std::make_shared<Options>();
  describe(app, *options)->callback([options, work, &exit_code] { exit_code = work(*options); });
}

}  // namespace

void add_commands(CLI::App& app, const std::vector<std::string>& arguments, int& exit_code) {
  add(app, add_run, run, exit_code);
  add(
      app, add_replay,
      [&arguments](ReplayOptions& options) {
        options.arguments = arguments;
        return replay(options);
      },
      exit_code);
  add(
      app, add_inspect, [](const InspectOptions& options) { return inspect(options); }, exit_code);
  add(
      app, add_identify,
      [&arguments](IdentifyOptions& options) {
        options.arguments = arguments;
        return identify_points(options);
      },
      exit_code);
  add(
      app, add_simulate, [](const SimulateOptions& options) { return simulate(options); },
      exit_code);
  add(
      app, add_plan, [](const PlanOptions& options) { return plan(options); }, exit_code);
  add(
      app, add_report, [](const ReportOptions& options) { return make_report(options); },
      exit_code);
  add(
      app, add_validate, [](const ValidateOptions& options) { return validate(options); },
      exit_code);
  add(
      app, add_compare, [](const CompareOptions& options) { return compare(options); }, exit_code);
  add(
      app, add_export, [](const ExportOptions& options) { return export_csv(options); }, exit_code);
  add(
      app, add_check,
      [](CheckOptions& options) {
        if (!options.config && options.ethernet_configs.empty() && options.contexts.empty())
          options.config = RunOptions().config;
        return check(options);
      },
      exit_code);
}

}  // namespace sweepd
