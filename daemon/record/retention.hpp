#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

#include "daemon/settings/settings.hpp"

namespace sweepd {

/// The files of a session that are being written, and must stay.
struct InUse {
  std::string session;  ///< name of its folder; empty: none
  unsigned part = 0;    ///< of trace.pcap and samples.csv; 1 is the first
};

struct Deleted {
  std::uint64_t files = 0;
  std::uint64_t bytes = 0;
  std::uint64_t of_session = 0;  ///< files of the session that is being written, among them
  std::string trouble;  ///< what could not be looked at or deleted first, and why; empty: nothing
};

/// Deletes the recordings of one robot that are older than settings.keep, and the oldest ones
/// while all together are larger than settings.keep_bytes. A trace and the samples of the same
/// number go together, both as old as the younger one was last written.
///
/// Recordings are the regular files named trace.pcap, trace-0002.pcap, samples.csv,
/// samples-0002.csv and so on, in folders named by a start time, in `robot_folder`. Nothing else
/// is touched, nor is what others hold by a FolderLock, and no symbolic link is followed below
/// `robot_folder`. Never throws.
Deleted delete_old_recordings(const std::filesystem::path& robot_folder,
                              const RecordingSettings& settings,
                              std::chrono::system_clock::time_point now,
                              const InUse& in_use) noexcept;

}  // namespace sweepd
