#include "daemon/stream/traces.hpp"

#include <algorithm>
#include <system_error>

#include "daemon/text/progress.hpp"
#include "rsi/capture/capture_reader.hpp"

namespace sweepd {

std::vector<std::filesystem::path> traces_in_order(
    const std::vector<std::filesystem::path>& traces) {
  for (auto path = traces.begin(); path != traces.end(); ++path) {
    std::error_code error;
    const auto status = std::filesystem::status(*path, error);
    if (std::filesystem::is_fifo(status) || std::filesystem::is_socket(status))
      throw rsi::CaptureError(path->string() +
                              " is a pipe, which can be read once only: save it to a file first");
    if (std::any_of(traces.begin(), path, [&](const auto& before) {
          return std::filesystem::equivalent(before, *path, error);
        }))
      throw rsi::CaptureError(path->string() + " is given twice: give each capture once");
  }
  return rsi::in_order_of_time(traces);
}

void read_traces(const std::vector<std::filesystem::path>& traces, const std::string& command,
                 bool quiet, std::ostream& errors,
                 const std::function<void(const rsi::Datagram&)>& on_datagram) {
  constexpr std::uint64_t kBetweenUpdates = 4096;
  Progress progress(command, quiet ? Progress::Terminal{} : Progress::standard_error());
  std::uintmax_t all = 0;
  for (const auto& path : traces) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    if (!error) all += size;
  }
  std::uintmax_t before = 0;
  for (const auto& path : traces) {
    rsi::CaptureReader capture(path);
    while (const auto datagram = capture.next()) {
      if (capture.counters().packets % kBetweenUpdates == 0)
        progress.update(static_cast<double>(before + capture.bytes_read()),
                        static_cast<double>(all), path.filename().string());
      on_datagram(*datagram);
    }
    before += capture.bytes_read();
    progress.clear();
    for (const auto& note : capture.notes()) errors << "sweepd: " << note << '\n';
  }
}

}  // namespace sweepd
