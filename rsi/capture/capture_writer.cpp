#include "rsi/capture/capture_writer.hpp"

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "rsi/capture/packet.hpp"

namespace rsi {
namespace {

constexpr std::size_t record_header_size = 16;
constexpr std::size_t captured_length_at = 8;
constexpr std::size_t wire_length_at = 12;

void append32(std::string& out, std::uint32_t value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

}  // namespace

std::string capture_header() {
  constexpr std::uint16_t version[] = {2, 4};
  std::string out;
  append32(out, 0xa1b23c4d);  // pcap with nanoseconds
  out.append(reinterpret_cast<const char*>(version), sizeof version);
  append32(out, 0);  // two unused words
  append32(out, 0);
  append32(out, packet_header_size + max_udp_payload);  // the largest packet
  append32(out, 101);                                   // LINKTYPE_RAW
  return out;
}

void append_capture_record(const Datagram& datagram, std::string& out) {
  using namespace std::chrono;
  const auto whole_seconds = floor<seconds>(datagram.time);
  const auto header = out.size();
  append32(out, static_cast<std::uint32_t>(whole_seconds.count()));
  append32(out, static_cast<std::uint32_t>((datagram.time - whole_seconds).count()));
  append32(out, static_cast<std::uint32_t>(packet_header_size + datagram.payload.size()));
  append32(out, 0);
  const auto wire_length = static_cast<std::uint32_t>(append_packet(datagram, out));
  std::memcpy(out.data() + header + wire_length_at, &wire_length, sizeof wire_length);
}

std::size_t capture_record_size(const Datagram& datagram) noexcept {
  return record_header_size + packet_header_size + datagram.payload.size();
}

std::size_t capture_record_size(std::string_view bytes) noexcept {
  if (bytes.size() < record_header_size) return 0;
  std::uint32_t captured = 0;
  std::memcpy(&captured, bytes.data() + captured_length_at, sizeof captured);
  return record_header_size + captured;
}

namespace {

constexpr std::size_t buffer_size = 256 << 10;

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
