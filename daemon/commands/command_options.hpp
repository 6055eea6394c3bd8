#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "rsi/capture/conversation.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

// Options of several commands.
void add_traces(CLI::App& command, std::vector<std::filesystem::path>& traces);
/// Which conversation of a capture.
void add_filter(CLI::App& command, rsi::ConversationFilter& filter);
void add_robot(CLI::App& command, std::filesystem::path& robot);
void add_robot_and_plan(CLI::App& command, std::filesystem::path& robot,
                        std::filesystem::path& plan);
void add_tool(CLI::App& command, std::optional<std::array<double, 3>>& tool_mm);
/// Names for the columns of a file of points.
void add_columns(CLI::App& command, std::string& columns);
/// Where the result files go.
void add_output(CLI::App& command, std::optional<std::filesystem::path>& output);
void add_force(CLI::App& command, bool& force);
void add_quiet(CLI::App& command, bool& quiet);
/// The value of an option that is an endpoint or an address.
template <typename Value, typename Parse>
std::function<bool(const std::vector<std::string>&)> parsed(std::optional<Value>& into,
                                                            const Parse& parse) {
  return [&into, parse](const std::vector<std::string>& texts) {
    into = parse(texts.front());
    return into.has_value();
  };
}

}  // namespace sweepd
