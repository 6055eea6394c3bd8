#include "daemon/commands/export_command.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/outputs.hpp"
#include "daemon/stream/sample_clock.hpp"
#include "daemon/stream/traces.hpp"
#include "daemon/system/line_file.hpp"
#include "daemon/text/numbers.hpp"
#include "rsi/capture/capture_reader.hpp"
#include "rsi/counted.hpp"
#include "rsi/link/link_statistics.hpp"
#include "rsi/telegram/telegram.hpp"

namespace sweepd {
namespace {

constexpr std::string_view kBegins = "t_s,ipoc";

struct Column {
  explicit Column(const rsi::Signal& signal)
      : element(signal.element), attribute(signal.attribute), place(element, attribute) {}

  std::string element;
  std::string attribute;
  rsi::SignalPlace place;

  [[nodiscard]] std::string name() const {
    return attribute.empty() ? element : element + "." + attribute;
  }
};

/// A value as CSV: quoted where it would be mistaken for more than one.
std::string field(std::string_view text) {
  if (text.find_first_of(",\"\n\r") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

using OnTelegram = std::function<void(const rsi::Telegram&, const rsi::Datagram&)>;

/// Calls `on_telegram` for each usable one; returns how many were not.
std::uint64_t for_each_telegram(const ExportOptions& options, const rsi::Conversation& conversation,
                                const OnTelegram& on_telegram, std::ostream* errors) {
  std::uint64_t malformed = 0;
  rsi::Telegram telegram;
  for (const auto& path : options.traces) {
    rsi::CaptureReader capture(path);
    while (const auto datagram = capture.next()) {
      if (conversation.direction(*datagram) != rsi::Direction::from_controller) continue;
      if (telegram.parse(datagram->payload) == rsi::Defect::none && !datagram->cut)
        on_telegram(telegram, *datagram);
      else
        ++malformed;
    }
    if (errors != nullptr)
      for (const auto& note : capture.notes()) *errors << "sweepd: " << note << '\n';
  }
  return malformed;
}

std::vector<Column> columns_of(const ExportOptions& options,
                               const rsi::Conversation& conversation) {
  std::vector<Column> columns;
  std::uint64_t names = 0;
  for_each_telegram(
      options, conversation,
      [&](const rsi::Telegram& telegram, const rsi::Datagram&) {
        if (telegram.names() == names) return;
        names = telegram.names();
        for (const auto& signal : telegram.signals())
          if (std::none_of(columns.begin(), columns.end(), [&](const Column& column) {
                return column.element == signal.element && column.attribute == signal.attribute;
              }))
            columns.emplace_back(signal);
      },
      nullptr);
  std::stable_partition(columns.begin(), columns.end(),
                        [](const Column& column) { return column.element == "RIst"; });
  return columns;
}

}  // namespace

int export_csv(const ExportOptions& given, std::ostream& out, std::ostream& errors) {
  ExportOptions options = given;
  const bool to_file = options.csv != "-";
  if (to_file) Outputs(given.traces, given.force).check(options.csv, kBegins);
  options.traces = traces_in_order(given.traces);
  const auto search = rsi::find_conversation(options.traces, options.filter);
  if (!search.note.empty()) errors << "sweepd: " << search.note << '\n';
  if (!search.chosen) return kFailed;

  std::optional<OutputFile> output;
  std::optional<LineFile> file;
  if (to_file) file.emplace(output.emplace(options.csv).beside());
  const auto write = [&](const std::string& line) {
    if (file)
      file->append(line);
    else
      out << line << '\n';
  };
  auto columns = columns_of(options, *search.chosen);
  std::string header(kBegins);
  for (const Column& column : columns) header += "," + field(column.name());
  write(header);

  rsi::LinkStatistics link;
  SampleClock clock;
  std::uint64_t telegrams = 0;
  const auto malformed = for_each_telegram(
      options, *search.chosen,
      [&](const rsi::Telegram& telegram, const rsi::Datagram& datagram) {
        const auto arrival = link.add(datagram, telegram.ipoc(), {});
        const double time = clock.seconds(telegram.ipoc(), datagram.time, link.counts_ms(),
                                          arrival == rsi::Arrival::restart);
        std::string row = fixed(time, 3) + "," + std::to_string(telegram.ipoc());
        for (Column& column : columns) {
          row += ',';
          if (const auto* const signal = column.place.in(telegram)) row += field(signal->text);
        }
        write(row);
        ++telegrams;
      },
      &errors);
  if (malformed > 0)
    errors << "sweepd: "
           << rsi::counted(malformed, "datagram was no usable telegram and has",
                           "datagrams were no usable telegrams and have")
           << " no row: "
           << "`sweepd replay` tells why\n";
  if (file) {
    file->flush();
    if (!file->error().empty()) {
      errors << "sweepd: " << file->error() << '\n';
      return kFailed;
    }
    file.reset();
    output->commit();
  }
  return telegrams > 0 ? kOk.code : kFailed;
}

CLI::App* add_export(CLI::App& app, ExportOptions& options) {
  auto* command = app.add_subcommand(
      "export", "Write every signal of the telegrams in captures as CSV, one row a telegram");
  add_traces(*command, options.traces);
  command->add_option("--csv", options.csv, "Write the table to this file. With -, print it")
      ->required()
      ->type_name("FILE");
  add_filter(*command, options.filter);
  add_force(*command, options.force);
  command->footer(exit_status({kOk, kError, kWrongUsage}));
  return command;
}

}  // namespace sweepd
