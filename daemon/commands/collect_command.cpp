#include <CLI/CLI.hpp>

#include "daemon/commands/exit_codes.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/plant_commands.hpp"

namespace sweepd {

CLI::App* add_collect(CLI::App& app, CollectOptions& options) {
  auto* command = app.add_subcommand(
      "collect",
      "Write what all publishers of a plant tell an MQTT broker into PostgreSQL\n"
      "It makes and changes its tables by itself. A result is acknowledged to the broker only once "
      "the database has it. It stays in the foreground until SIGTERM or SIGINT.");
  command->add_option("--config", options.config, "Read broker and database from this file")
      ->capture_default_str()
      ->type_name("FILE");
  command->footer(exit_status({kOk, kError, kWrongUsage, kWrongFile}));
  return command;
}

}  // namespace sweepd
