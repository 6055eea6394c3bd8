#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace sweepd {

struct DiskRoom {
  std::uint64_t free = 0;  ///< bytes, to a user without privileges
  std::uint64_t total = 0;
};

/// Of the disk that a folder is on; nothing if it cannot be told.
[[nodiscard]] std::optional<DiskRoom> disk_room(const std::filesystem::path& folder);

/// The number of the file system that a folder is on, or would be; 0 if none of its parents is
/// there. Waits for the disk.
[[nodiscard]] std::uint64_t file_system_of(const std::filesystem::path& folder);

}  // namespace sweepd
