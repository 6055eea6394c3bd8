#include "daemon/system/disk_room.hpp"

#include <system_error>

#include <sys/stat.h>
#include <sys/statvfs.h>

namespace sweepd {

std::optional<DiskRoom> disk_room(const std::filesystem::path& folder) {
  struct statvfs status {};
  if (statvfs(folder.c_str(), &status) != 0) return std::nullopt;
  return DiskRoom{std::uint64_t{status.f_bavail} * status.f_frsize,
                  std::uint64_t{status.f_blocks} * status.f_frsize};
}

std::uint64_t file_system_of(const std::filesystem::path& folder) {
  struct stat there {};
  std::error_code error;
  auto place = std::filesystem::absolute(folder, error).lexically_normal();
  while (stat(place.c_str(), &there) != 0) {
    if (!place.has_relative_path()) return 0;
    place = place.parent_path();
  }
  return there.st_dev;
}

}  // namespace sweepd
