#include "tests/scenarios/recorded.hpp"

#include <algorithm>
#include <stdexcept>

#include "daemon/record/recording_files.hpp"
#include "rsi/capture/capture_reader.hpp"
#include "rsi/telegram/ipoc.hpp"
#include "tests/daemon/temporary_folder.hpp"

namespace sweepd::test {

Recorded recorded(const std::filesystem::path& session, std::uint16_t port) {
  Recorded found;
  for (unsigned part = 1;; ++part) {
    const auto trace = session / part_name("trace", ".pcap", part);
    const auto samples = session / part_name("samples", ".csv", part);
    if (!std::filesystem::exists(trace)) break;
    found.traces.push_back(trace);
    rsi::CaptureReader reader(trace);
    while (const auto datagram = reader.next()) {
      if (datagram->destination.port == port)
        found.telegrams.push_back(rsi::ipoc_number(rsi::find_ipoc(datagram->payload)).value_or(0));
      else
        ++found.replies;
    }
    for (const auto& note : reader.notes()) found.notes.push_back(note);
    if (!std::filesystem::exists(samples)) continue;  // made after its trace
    const auto text = content(samples);
    if (!text.starts_with("t_s,ipoc,")) throw std::runtime_error(samples.string());
    found.samples += static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n')) - 1;
  }
  return found;
}

}  // namespace sweepd::test
