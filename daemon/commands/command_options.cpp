#include "daemon/commands/command_options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <system_error>
#include <type_traits>

#include <CLI/CLI.hpp>
#include <spdlog/fmt/fmt.h>

#include "daemon/text/numbers.hpp"
#include "daemon/text/utc.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

/// Whether `text` as a whole is such a number.
template <typename Number>
std::errc number_from(const std::string& text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return end == text.data() + text.size() ? error : std::errc::invalid_argument;
}

/// Help has `expected` in brackets, see help_text.cpp.
template <typename Number, typename Holds>
CLI::Validator expecting(const std::string& expected, const Holds& holds) {
  return {[=](std::string& text) {
            constexpr auto kMost = std::numeric_limits<Number>::max();
            Number value{};
            const auto error = number_from(text, value);
            if (error == std::errc() && holds(value)) return std::string();
            const bool too_large = error == std::errc::result_out_of_range &&
                                   std::is_integral_v<Number> && holds(kMost);
            double any{};
            const bool no_whole = std::is_integral_v<Number> && error != std::errc() &&
                                  number_from(text, any) == std::errc() && any != std::floor(any);
            return std::string("expected ") + (no_whole ? "a whole number, " : "") +
                   (too_large ? fmt::format("at most {}", kMost) : expected) + ", found " +
                   rsi::in_short(text);
          },
          "(" + expected + ")"};
}

/// Without an exponent.
std::string plain(double value) {
  std::string text;
  append_measured(text, value, 9);
  return text;
}

}  // namespace

void refuse_empty_paths(CLI::App& command) {
  static constexpr std::array kPaths{"FILE",    "DIR",    "TRACE", "TRACE.pcap", "P.dat",
                                     "NEW.dat", "RESULT", "A",     "B"};
  const CLI::Validator there(
      [](std::string& path) {
        return path.empty() ? std::string("expected a path, found an empty one") : std::string();
      },
      "");
  for (CLI::Option* option : command.get_options()) {
    const auto type = option->get_type_name();
    const auto what = type.empty() ? option->get_name(true) : type;
    if (std::find(kPaths.begin(), kPaths.end(), what) != kPaths.end()) option->check(there);
  }
  for (CLI::App* part : command.get_subcommands({})) refuse_empty_paths(*part);
}

CLI::Validator whole_number(std::uint64_t least, std::uint64_t most) {
  const bool open = most == std::numeric_limits<std::uint64_t>::max();
  return expecting<std::uint64_t>(
      std::to_string(least) + (open ? " or more" : " to " + std::to_string(most)),
      [=](std::uint64_t value) { return least <= value && value <= most; });
}

CLI::Validator number_between(double least, double most) {
  return expecting<double>(plain(least) + " to " + plain(most),
                           [=](double value) { return least <= value && value <= most; });
}

CLI::Validator zero_or_more() {
  return expecting<double>("0 or more",
                           [](double value) { return value >= 0 && std::isfinite(value); });
}

CLI::Validator finite() {
  return expecting<double>("a number", [](double value) { return std::isfinite(value); })
      .description("");
}

CLI::Validator more_than_zero() {
  return expecting<double>("more than 0",
                           [](double value) { return value > 0 && std::isfinite(value); });
}

void refuse_value(const std::string& option, const std::string& expected,
                  const std::string& found) {
  throw CLI::ValidationError(option, expected + ", found " + rsi::in_short(found));
}

std::chrono::nanoseconds date_option(const std::string& name, const std::string& text) {
  if (const auto time = parse_utc(text)) return *time;
  throw std::invalid_argument(name + ": " + rsi::in_short(text) +
                              " is no date: write it as 2026-03-01 or 2026-03-01T14:30, in UTC");
}

void add_filter(CLI::App& command, rsi::ConversationFilter& filter) {
  command.add_option("--port", filter.port, "Take the conversation whose RSI server has this port")
      ->check(whole_number(1, 65535))
      ->type_name("PORT")
      ->default_str("that of the busiest conversation");
  command
      .add_option("--controller",
                  parsed(filter.controller, rsi::parse_address, "--controller", kAnAddress),
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

void add_setup(CLI::App& command, std::optional<std::filesystem::path>& robot,
               std::optional<std::filesystem::path>& plan) {
  command.add_option("--robot", robot, "Read the robot description from this file")
      ->type_name("FILE")
      ->default_str("that of the settings");
  command
      .add_option("--plan", plan,
                  "Read the sweep plan from this file. Telegrams without angles need its order of "
                  "joints")
      ->type_name("FILE")
      ->default_str("that of the settings");
}

void add_tool(CLI::App& command, std::optional<std::array<double, 3>>& tool_mm) {
  command
      .add_option("--tool-mm", tool_mm,
                  "Place the target at this point, in mm, of the frame after the last DH row")
      ->check(finite())
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
