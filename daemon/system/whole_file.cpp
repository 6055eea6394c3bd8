#include "daemon/system/whole_file.hpp"

#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace sweepd {

std::string whole_file(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  std::string bytes;
  std::array<char, 64 << 10> part{};
  ssize_t count = file < 0 ? -1 : 1;
  while (count > 0) {
    count = read(file, part.data(), part.size());
    if (count > 0) bytes.append(part.data(), static_cast<std::size_t>(count));
    if (count < 0 && errno == EINTR) count = 1;
  }
  const int reason = errno;
  if (file >= 0) close(file);
  if (count < 0)
    throw std::runtime_error(path.string() +
                             ": cannot be read: " + std::generic_category().message(reason) +
                             ": check the path and the permissions");
  return bytes;
}

}  // namespace sweepd
