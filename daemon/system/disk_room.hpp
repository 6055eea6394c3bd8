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

}  // namespace sweepd
