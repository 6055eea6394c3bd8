#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/identify_command.hpp"
#include "daemon/devices/device_formats.hpp"
#include "daemon/points/axes_file.hpp"
#include "daemon/points/points_file.hpp"
#include "daemon/text/text_layout.hpp"
#include "identify/sweeps/sample.hpp"

namespace sweepd {
namespace {

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

}  // namespace

CLI::App* add_identify(CLI::App& app, IdentifyOptions& options) {
  auto* command = app.add_subcommand(
      "identify", "Identify a robot from points or joint axes that another device measured (CSV)");
  command->add_option("FILE", options.points, "Files of measured points")->type_name("");
  command
      ->add_option("--axes", options.axes,
                   "Read joint axes from this file in place of points, and make the DH table of "
                   "them")
      ->type_name("FILE");
  add_columns(*command, options.columns);
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
  command
      ->add_option("--angles", options.angles,
                   "Take the joint angles from this capture of RSI, which was recorded while the "
                   "device measured. The clocks need not agree")
      ->type_name("TRACE");
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
      ->check(whole_number(1, identify::kMostJoints))
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
  add_output(*command, options.output);
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
          formats_in_words() + ", and sweepd for its own columns.") +
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

}  // namespace sweepd
