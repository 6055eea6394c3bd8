#pragma once

#include <cstdint>
#include <filesystem>

namespace acceptance {

/// Turns a text file with one telegram a line into a capture as a controller at 192.168.1.20:49153
/// would have left it at 192.168.1.10:49152: one datagram a line, its LF included, every 4 ms from
/// a fixed start. The same text gives the same bytes. Returns how many telegrams there were. Throws
/// std::runtime_error if a file cannot be read or written.
std::uint64_t recording_to_capture(const std::filesystem::path& recording,
                                   const std::filesystem::path& capture);

}  // namespace acceptance
