#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "daemon/commands/plan_command.hpp"
#include "daemon/commands/simulate_command.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

/// Adds every command with its options, in the order of the help. Whichever is called leaves its
/// exit code in `exit_code`; `arguments` are those of the program, as they stand then. Both must
/// outlive `app`.
void add_commands(CLI::App& app, const std::vector<std::string>& arguments, int& exit_code);

// Those that rehearse: planning_options.cpp. Each adds a command whose options go into `options`.
CLI::App* add_simulate(CLI::App& app, SimulateOptions& options);
CLI::App* add_plan(CLI::App& app, PlanOptions& options);

// Of several commands.
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
