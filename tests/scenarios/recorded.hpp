#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sweepd::test {

/// What a session's folder holds of its recording.
struct Recorded {
  std::vector<std::filesystem::path> traces;  ///< in order
  std::vector<std::uint64_t> telegrams;       ///< their IPOCs, as recorded
  std::uint64_t replies = 0;
  std::uint64_t samples = 0;       ///< whole rows of all samples files
  std::vector<std::string> notes;  ///< what is wrong with the traces
};

/// Of a server on `port`. Throws if a trace does not open or a samples file does not begin with its
/// header.
Recorded recorded(const std::filesystem::path& session, std::uint16_t port);

}  // namespace sweepd::test
