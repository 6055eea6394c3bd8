#include "daemon/commands/command_options.hpp"

#include <CLI/CLI.hpp>

namespace sweepd {

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

void add_robot(CLI::App& command, std::filesystem::path& robot) {
  command.add_option("--robot", robot, "Read the robot description from this file")
      ->required()
      ->type_name("FILE");
}

void add_robot_and_plan(CLI::App& command, std::filesystem::path& robot,
                        std::filesystem::path& plan) {
  add_robot(command, robot);
  command.add_option("--plan", plan, "Read the sweep plan from this file")
      ->required()
      ->type_name("FILE");
}

void add_tool(CLI::App& command, std::optional<std::array<double, 3>>& tool_mm) {
  command
      .add_option("--tool-mm", tool_mm,
                  "Place the target at this point, in mm, of the frame after the last DH row")
      ->type_name("X,Y,Z")
      ->delimiter(',')
      ->default_str("that of the robot description");
}

void add_columns(CLI::App& command, std::string& columns) {
  command
      .add_option(
          "--columns", columns,
          "Name the columns, with commas between, where a file has no header or a wrong one. The "
          "name - or _ skips a column. Write --columns=-,x_mm where the first name is -")
      ->type_name("NAMES");
}

void add_force(CLI::App& command, bool& force) {
  command.add_flag(
      "--force", force,
      "Overwrite also files that sweepd did not write or that somebody has edited, but "
      "never an input file");
}

void add_quiet(CLI::App& command, bool& quiet) {
  command.add_flag("--quiet", quiet, "Print no progress and no report");
}

void add_output(CLI::App& command, std::optional<std::filesystem::path>& output) {
  command.add_option("--output", output, "Write the result files into this folder")
      ->type_name("DIR")
      ->default_str("no result files");
}

}  // namespace sweepd
