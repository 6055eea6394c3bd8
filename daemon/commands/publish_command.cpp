#include <CLI/CLI.hpp>

#include "daemon/commands/exit_codes.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/plant_commands.hpp"

namespace sweepd {

CLI::App* add_publish(CLI::App& app, PublishOptions& options) {
  auto* command = app.add_subcommand(
      "publish",
      "Tell an MQTT broker how the robots of this machine are, and each result\n"
      "It reads the result folders and the pages of a `sweepd run` with the same settings, whose "
      "[publish] table names the broker. It stays in the foreground until SIGTERM or SIGINT. What "
      "the broker has not acknowledged then is published at the next start. It takes no commands "
      "from the broker.");
  command->add_option("--config", options.config, "Read the settings from this file")
      ->capture_default_str()
      ->type_name("FILE");
  command->add_flag("--again", options.again,
                    "Publish all results that are on the disk, also those that were published");
  command->footer(exit_status({kOk, kError, kWrongUsage, kWrongFile}));
  return command;
}

}  // namespace sweepd
