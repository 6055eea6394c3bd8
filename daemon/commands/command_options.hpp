#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "rsi/capture/conversation.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
class Validator;
}  // namespace CLI

namespace sweepd {

// Options of several commands.
void add_traces(CLI::App& command, std::vector<std::filesystem::path>& traces);
/// Which conversation of a capture.
void add_filter(CLI::App& command, rsi::ConversationFilter& filter);
void add_robot(CLI::App& command, std::filesystem::path& robot);
/// Description and plan, in place of those of the settings.
void add_setup(CLI::App& command, std::optional<std::filesystem::path>& robot,
               std::optional<std::filesystem::path>& plan);
void add_tool(CLI::App& command, std::optional<std::array<double, 3>>& tool_mm);
/// Names for the columns of a file of points.
void add_columns(CLI::App& command, std::string& columns);
/// Where the result files go.
void add_output(CLI::App& command, std::optional<std::filesystem::path>& output);
void add_force(CLI::App& command, bool& force);
void add_quiet(CLI::App& command, bool& quiet);
/// Lets no option of `command` that is a path be empty: that would be the current folder, or
/// nothing. Once all options are there.
void refuse_empty_paths(CLI::App& command);
/// A whole number from `least` to `most`.
[[nodiscard]] CLI::Validator whole_number(
    std::uint64_t least, std::uint64_t most = std::numeric_limits<std::uint64_t>::max());
/// A number from `least` to `most`; "nan" is none.
[[nodiscard]] CLI::Validator number_between(double least, double most);
[[nodiscard]] CLI::Validator zero_or_more();
/// Of each number of an option that may be any; help says nothing of it.
[[nodiscard]] CLI::Validator finite();
[[nodiscard]] CLI::Validator more_than_zero();

/// A number in `range`; help has the default, which is the value so far. `command` is a CLI::App.
template <typename Command, typename Number>
auto* add_number(Command& command, const char* name, Number& value, const CLI::Validator& range,
                 const char* help) {
  return command.add_option(name, value, help)->check(range)->capture_default_str();
}

inline constexpr const char* kAnAddress = "expected an IPv4 address, as 192.168.1.20";
inline constexpr const char* kAnEndpoint =
    "expected an IPv4 address and a port (1 to 65535), as 192.168.1.10:49152";

/// Throws CLI::ValidationError: what was expected of the option, and what it is.
[[noreturn]] void refuse_value(const std::string& option, const std::string& expected,
                               const std::string& found);

/// A date in UTC, since 1970. Throws std::invalid_argument with the option's name.
[[nodiscard]] std::chrono::nanoseconds date_option(const std::string& name,
                                                   const std::string& text);

/// The value of an option that is an endpoint or an address.
template <typename Value, typename Parse>
std::function<bool(const std::vector<std::string>&)> parsed(std::optional<Value>& into,
                                                            const Parse& parse,
                                                            const std::string& option,
                                                            const std::string& expected) {
  return [&into, parse, option, expected](const std::vector<std::string>& texts) {
    into = parse(texts.front());
    if (!into) refuse_value(option, expected, texts.front());
    return true;
  };
}

}  // namespace sweepd
