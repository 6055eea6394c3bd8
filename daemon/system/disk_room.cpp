#include "daemon/system/disk_room.hpp"

#include <sys/statvfs.h>

namespace sweepd {

std::optional<DiskRoom> disk_room(const std::filesystem::path& folder) {
  struct statvfs status {};
  if (statvfs(folder.c_str(), &status) != 0) return std::nullopt;
  return DiskRoom{std::uint64_t{status.f_bavail} * status.f_frsize,
                  std::uint64_t{status.f_blocks} * status.f_frsize};
}

}  // namespace sweepd
