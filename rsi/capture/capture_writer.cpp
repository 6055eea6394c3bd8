#include "rsi/capture/capture_writer.hpp"

#include <cerrno>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "rsi/capture/capture_record.hpp"
#include "rsi/capture/packet.hpp"

namespace rsi {
namespace {

constexpr std::size_t buffer_size = 256 * 1024;

}  // namespace

CaptureWriter::CaptureWriter(const std::filesystem::path& path) : name_(path.string()) {
  buffer_.reserve(buffer_size);
  buffer_ += capture_header();
  file_ = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file_ < 0)
    throw std::runtime_error("cannot create capture " + name_ + ": " +
                             std::generic_category().message(errno) +
                             ": name a place in a folder that exists and may be written to");
  if (!flush()) {
    close(file_);
    throw std::runtime_error(error_);
  }
}

CaptureWriter::~CaptureWriter() {
  flush();
  close(file_);
}

bool CaptureWriter::write(const Datagram& datagram) noexcept {
  const auto size = capture_record_size(datagram);
  const bool fits_udp = datagram.payload.size() <= max_udp_payload;
  if (!fits_udp) fail("a payload is larger than UDP can carry: it was left out");
  if (fits_udp && buffer_.size() + size > buffer_size) flush();
  if (!fits_udp || buffer_.size() + size > buffer_size) {
    ++dropped_;
    return false;
  }
  append_capture_record(datagram, buffer_);
  return true;
}

bool CaptureWriter::flush() noexcept {
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const auto written = ::write(file_, buffer_.data() + done, buffer_.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      fail(std::generic_category().message(errno) + ": make room on the disk, or record elsewhere");
      break;
    }
    done += static_cast<std::size_t>(written);
  }
  buffer_.erase(0, done);
  return buffer_.empty();
}

void CaptureWriter::fail(std::string_view what) noexcept {
  if (!error_.empty()) return;
  error_ = "cannot write capture " + name_ + ": ";
  error_ += what;
}

}  // namespace rsi
