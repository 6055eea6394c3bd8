#include "rsi/file_bytes.hpp"

#include <algorithm>
#include <array>
#include <cerrno>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

namespace rsi {

std::string file_bytes(const std::filesystem::path& path, std::size_t most, std::error_code& why,
                       std::chrono::milliseconds patience) {
  // Of a pipe, neither to open it waits for ever, nor to read it.
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  std::string bytes;
  std::array<char, 64 << 10> part{};
  ssize_t count = file < 0 ? -1 : 1;
  while (count > 0 && bytes.size() <= most) {
    // One more than `most` in all, which may be the largest number that there is.
    const std::size_t room = most - bytes.size();
    pollfd ready{file, POLLIN, 0};
    const int found = poll(&ready, 1, static_cast<int>(patience.count()));
    if (found == 0) errno = ETIMEDOUT;
    count = found > 0 ? read(file, part.data(), std::min(part.size() - 1, room) + 1) : -1;
    if (count > 0) bytes.append(part.data(), static_cast<std::size_t>(count));
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) count = 1;
  }
  why = count < 0 ? std::error_code(errno, std::generic_category()) : std::error_code();
  if (file >= 0) close(file);
  return bytes;
}

std::optional<std::string> readable_bytes(const std::filesystem::path& file) {
  std::error_code why;
  std::string bytes = file_bytes(file, kLargestFile, why);
  if (why || bytes.size() > kLargestFile) return std::nullopt;
  return bytes;
}

}  // namespace rsi
