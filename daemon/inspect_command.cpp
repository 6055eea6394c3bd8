#include "daemon/inspect_command.hpp"

#include "daemon/atomic_file.hpp"
#include "daemon/link_json.hpp"
#include "daemon/link_text.hpp"
#include "daemon/progress.hpp"
#include "rsi/capture_reader.hpp"
#include "rsi/link_monitor.hpp"
#include "rsi/link_verdict.hpp"

namespace sweepd {
namespace {

rsi::LinkReport watch(const InspectOptions& options, const rsi::Conversation& conversation,
                      std::ostream& errors) {
  constexpr std::uint64_t kBetweenUpdates = 4096;
  Progress progress("inspect", options.quiet ? Progress::Terminal{} : Progress::standard_error());
  double all = 0;
  for (const auto& path : options.traces) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    if (!error) all += static_cast<double>(size);
  }
  rsi::LinkMonitor monitor;
  double before = 0;
  for (const auto& path : options.traces) {
    rsi::CaptureReader capture(path);
    while (const auto datagram = capture.next()) {
      if (capture.counters().packets % kBetweenUpdates == 0)
        progress.update(before + static_cast<double>(capture.bytes_read()), all,
                        path.filename().string());
      switch (conversation.direction(*datagram)) {
        case rsi::Direction::from_controller:
          monitor.telegram(*datagram);
          break;
        case rsi::Direction::to_controller:
          monitor.reply(*datagram);
          break;
        case rsi::Direction::other:
          break;
      }
    }
    before += static_cast<double>(capture.bytes_read());
    progress.clear();
    for (const auto& note : capture.notes()) errors << "sweepd: " << note << '\n';
  }
  return monitor.report();
}

}  // namespace

int inspect(const InspectOptions& options, std::ostream& out, std::ostream& errors) {
  const auto search = rsi::find_conversation(options.traces, options.filter);
  if (!search.note.empty()) errors << "sweepd: " << search.note << '\n';
  if (!search.chosen) return 1;
  const auto report = watch(options, *search.chosen, errors);
  const bool json_only = options.json == "-";
  if (json_only)
    out << link_json(*search.chosen, report);
  else if (options.json)
    write_atomically(*options.json, link_json(*search.chosen, report));
  if (!json_only && !options.quiet) out << link_text(*search.chosen, report);
  return rsi::verdict(report).grade == rsi::Grade::bad ? 1 : 0;
}

}  // namespace sweepd
