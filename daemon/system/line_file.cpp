#include "daemon/system/line_file.hpp"

#include <cerrno>
#include <stdexcept>

#include <fcntl.h>
#include <unistd.h>

#include "daemon/system/atomic_file.hpp"

namespace sweepd {
namespace {

constexpr std::size_t kBuffer = 256 << 10;

std::string reason(const std::filesystem::path& path) {
  return cannot_write(path, errno);
}

}  // namespace

LineFile::LineFile(const std::filesystem::path& path)
    : path_(path), file_(open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)) {
  if (file_ < 0) throw std::runtime_error(reason(path));
  buffer_.reserve(kBuffer + 4096);
}

LineFile::~LineFile() {
  flush();
  close(file_);
}

void LineFile::append(std::string_view line) {
  if (buffer_.size() >= kBuffer) flush();
  if (buffer_.size() >= kBuffer) return;
  buffer_ += line;
  buffer_ += '\n';
}

void LineFile::flush() {
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const auto written = write(file_, buffer_.data() + done, buffer_.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      if (error_.empty()) error_ = reason(path_);
      break;
    }
    done += static_cast<std::size_t>(written);
  }
  buffer_.erase(0, done);
}

}  // namespace sweepd
