#include "tests/acceptance/recording.hpp"

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <string>

#include "rsi/capture/capture_writer.hpp"

namespace acceptance {

std::uint64_t recording_to_capture(const std::filesystem::path& recording,
                                   const std::filesystem::path& capture) {
  constexpr std::chrono::milliseconds kCycle{4};
  constexpr std::chrono::seconds kStart{1'735'689'600};  // 2025-01-01T00:00:00Z
  rsi::Datagram datagram;
  datagram.source = *rsi::parse_endpoint("192.168.1.20:49153");
  datagram.destination = *rsi::parse_endpoint("192.168.1.10:49152");
  datagram.time = kStart;

  std::ifstream text(recording, std::ios::binary);
  if (!text) throw std::runtime_error(recording.string() + ": cannot be read");
  rsi::CaptureWriter writer(capture);
  std::uint64_t telegrams = 0;
  for (std::string line; std::getline(text, line); datagram.time += kCycle, ++telegrams) {
    if (!text.eof()) line += '\n';
    datagram.payload = line;
    writer.write(datagram);
  }
  if (!writer.flush()) throw std::runtime_error(writer.error());
  return telegrams;
}

}  // namespace acceptance
