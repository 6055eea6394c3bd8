#include "daemon/commands/inspect_command.hpp"

#include <CLI/CLI.hpp>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/outputs.hpp"
#include "daemon/results/link_files.hpp"
#include "daemon/stream/traces.hpp"
#include "rsi/capture/capture_reader.hpp"
#include "rsi/link/link.hpp"
#include "rsi/link/link_verdict.hpp"

namespace sweepd {

int inspect(const InspectOptions& options, std::ostream& out, std::ostream& errors) {
  const bool json_only = options.json == "-";
  if (options.json && !json_only)
    Outputs(options.traces, options.force).check(*options.json, link_json_begins());
  const auto traces = traces_in_order(options.traces);
  const auto search = rsi::find_conversation(traces, options.filter);
  if (!search.note.empty()) errors << "sweepd: " << search.note << '\n';
  if (!search.chosen) return kFailed;
  rsi::Link monitor;
  read_traces(traces, "inspect", options.quiet, errors, [&](const rsi::Datagram& datagram) {
    const auto direction = search.chosen->direction(datagram);
    if (direction == rsi::Direction::from_controller) monitor.telegram(datagram);
    if (direction == rsi::Direction::to_controller) monitor.reply(datagram);
  });
  const auto report = monitor.report();
  if (json_only)
    out << link_json(*search.chosen, report);
  else if (options.json)
    write_output(*options.json, link_json(*search.chosen, report));
  if (!json_only && !options.quiet) out << link_text(*search.chosen, report);
  const auto verdict = rsi::verdict(report);
  if (verdict.grade != rsi::Grade::bad) return kOk.code;
  if (options.quiet) errors << "sweepd: the link is bad: " << verdict.worst() << '\n';
  return kFailed;
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
      {{kOk.code, "The link is good or marginal."},
       {kFailed,
        "The link is bad, or the captures have no RSI, or a file cannot be read or written."},
       kWrongUsage}));
  return command;
}

}  // namespace sweepd
