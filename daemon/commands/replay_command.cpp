#include "daemon/commands/replay_command.hpp"

#include <future>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/outputs.hpp"
#include "daemon/points/device_recording.hpp"
#include "daemon/results/outcome.hpp"
#include "daemon/results/report.hpp"
#include "daemon/results/result_files.hpp"
#include "daemon/results/run_json.hpp"
#include "daemon/settings/robot_setup.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/stream/session.hpp"
#include "daemon/stream/traces.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/system/line_file.hpp"
#include "daemon/system/process_state.hpp"
#include "daemon/text/file_names.hpp"
#include "rsi/capture/capture_reader.hpp"

namespace sweepd {
namespace {

/// The robot of the settings that a conversation belongs to: the only one, or the one whose port it
/// is; nothing if there is none. Without a conversation any will do.
std::optional<RobotSettings> robot_of(const Settings& settings,
                                      const std::optional<rsi::Conversation>& conversation) {
  if (settings.robots.size() == 1 || !conversation) return settings.robots.front();
  for (const RobotSettings& robot : settings.robots)
    if (robot.listen.port == conversation->sweepd.port) return robot;
  return std::nullopt;
}

RobotSetup setup_for(const ReplayOptions& options,
                     const std::optional<rsi::Conversation>& conversation) {
  std::optional<RobotSettings> settings;
  if (options.config) {
    settings = robot_of(load_settings(*options.config), conversation);
    if (!settings && !options.robot)
      throw ConfigError(options.config->string() +
                        ": listen: expected a [[robot]] that listens where the capture's telegrams "
                        "go, found none: name its description with --robot");
  }
  auto description = options.robot;
  auto plan = options.plan;
  if (settings && !description) description = settings->description;
  if (settings && !plan) plan = settings->plan;
  RobotSetup setup = load_setup(description, plan);
  if (settings) {
    setup.name = settings->name;
    setup.signals = settings->signals;
    setup.device = settings->device;
  }
  return setup;
}

std::vector<std::filesystem::path> inputs_of(const ReplayOptions& options) {
  auto inputs = options.traces;
  for (const auto& file : {options.config, options.robot, options.plan})
    if (file) inputs.push_back(*file);
  return inputs;
}

void check_output(const ReplayOptions& options) {
  auto names = result_file_names();
  names.insert(names.end(), {file_names::kSamples, file_names::kRun});
  Outputs(inputs_of(options), options.force).check_results(*options.output, names);
}

/// First what marks the folder as that of results; with `inputs` once they are known.
void write_run_file(const ReplayOptions& options, const rsi::ConversationSearch& search,
                    const std::vector<FileHash>& inputs) {
  auto given = nlohmann::ordered_json::object();
  for (const auto& trace : options.traces) given["traces"].push_back(trace.string());
  if (options.config) given["settings"] = options.config->string();
  if (options.robot) given["description"] = options.robot->string();
  if (options.plan) given["plan"] = options.plan->string();
  if (search.chosen) given["conversation"] = text(*search.chosen);
  write_atomically(*options.output / file_names::kRun,
                   run_json("replay", given, options.arguments, inputs));
}

/// On the session's second thread. Of a device's recording only the angles are touched there.
class Rows : public StreamSink {
 public:
  Rows(std::optional<LineFile>& file, DeviceRecording& device) : file_(file), device_(device) {}
  void sample(const identify::Sample& sample, std::string_view row) override {
    device_.sample(sample);
    if (file_) file_->append(row);
  }

 private:
  std::optional<LineFile>& file_;
  DeviceRecording& device_;
};

}  // namespace

int replay(const ReplayOptions& given, std::ostream& out, std::ostream& errors) {
  keep_memory();
  ReplayOptions options = given;
  if (options.output) check_output(options);
  options.traces = traces_in_order(given.traces);
  const auto search = rsi::find_conversation(options.traces, options.filter);
  if (!search.note.empty()) errors << "sweepd: " << search.note << '\n';
  // There is RSI, but not the one that was asked for: what is in the folder stays.
  if (!search.chosen && !search.found.empty()) return kFailed;
  const RobotSetup setup = setup_for(options, search.chosen);
  std::optional<OutputFile> samples_file;
  std::optional<LineFile> samples;
  FileHashes hashes(options.output ? inputs_of(options) : std::vector<std::filesystem::path>{});
  if (options.output) {
    make_folder(*options.output);
    // One that is there belongs to the result beside it, which stays until the new one is made.
    if (!std::filesystem::exists(*options.output / file_names::kRun))
      write_run_file(options, search, {});
    samples.emplace(samples_file.emplace(*options.output / file_names::kSamples).beside());
  }
  DeviceRecording device(setup);
  Rows rows(samples, device);
  std::optional<Session> session;
  const auto begin = [&](std::string_view telegram) {
    session.emplace(setup, "trace", rows, telegram);
    session->use_two_threads([&hashes] { return hashes.go_on(); });
    if (!session->missing_signals().empty())
      errors << "sweepd: " << session->missing_signals() << '\n';
    if (samples) samples->append(session->csv_header());
  };
  if (search.chosen)
    read_traces(options.traces, "replay", options.quiet, errors, [&](const auto& datagram) {
      if (device.is_device(datagram)) return device.device(datagram);
      if (search.chosen->direction(datagram) != rsi::Direction::from_controller) return;
      if (!session) begin(datagram.payload);
      device.telegram(datagram);
      session->telegram(datagram);
    });
  if (!session) begin({});
  session->finish();
  if (samples) samples->flush();
  const bool all_written = !samples || samples->error().empty();
  if (!all_written) errors << "sweepd: " << samples->error() << '\n';
  std::future<void> committed;  // the disk takes as long as the engine
  if (samples_file && all_written)
    committed = std::async(std::launch::async, [&] {
      samples.reset();
      samples_file->commit();
    });
  Outcome outcome = outcome_of(device.with_device(session->snapshot()));
  if (committed.valid()) committed.get();
  if (!search.chosen) outcome.identification.reason = "no RSI telegrams in the capture";
  if (options.output) {
    session->wait_for_beside();
    write_run_file(options, search, hashes.made());
    write_result(*options.output, outcome);
  }
  if (!options.quiet) out << report(outcome);
  // Without telegrams the search has said why.
  return all_written && search.chosen ? exit_code(outcome, errors) : kFailed;
}

CLI::App* add_replay(CLI::App& app, ReplayOptions& options) {
  auto* command = app.add_subcommand(
      "replay",
      "Identify a robot from captures of its RSI telegrams (pcap, pcapng)\n"
      "The captures may be sweepd's own recordings, or come from Wireshark or tcpdump. The result "
      "files are those that `sweepd run` would have written.");
  add_traces(*command, options.traces);
  command->add_option("--config", options.config, "Read the settings from this file")
      ->type_name("FILE")
      ->default_str("no settings");
  add_setup(*command, options.robot, options.plan);
  add_output(*command, options.output);
  add_filter(*command, options.filter);
  add_quiet(*command, options.quiet);
  add_force(*command, options.force);
  command->footer(exit_status({kOk, kError, kWrongUsage, kDoubtful, kWrongFile}));
  return command;
}

}  // namespace sweepd
