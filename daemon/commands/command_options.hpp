#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "daemon/commands/check_command.hpp"
#include "daemon/commands/export_command.hpp"
#include "daemon/commands/identify_command.hpp"
#include "daemon/commands/inspect_command.hpp"
#include "daemon/commands/plan_command.hpp"
#include "daemon/commands/replay_command.hpp"
#include "daemon/commands/report_command.hpp"
#include "daemon/commands/run_command.hpp"
#include "daemon/commands/simulate_command.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

/// Each adds a command to the program, whose options go into `options`, and returns it.
CLI::App* add_run(CLI::App& app, RunOptions& options);
CLI::App* add_replay(CLI::App& app, ReplayOptions& options);
CLI::App* add_inspect(CLI::App& app, InspectOptions& options);
CLI::App* add_identify(CLI::App& app, IdentifyOptions& options);
CLI::App* add_report(CLI::App& app, ReportOptions& options);
CLI::App* add_export(CLI::App& app, ExportOptions& options);
CLI::App* add_check(CLI::App& app, CheckOptions& options);
// planning_options.cpp
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
