#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "rsi/datagram.hpp"

namespace rsi {

// The bytes of a capture file: pcap with nanoseconds, link type "raw IP", headers of IPv4 and UDP
// made up around the payload (https://www.tcpdump.org/manpages/pcap-savefile.5.txt). Numbers are in
// the byte order of the writing machine; the magic number tells the reader.

/// What a file begins with.
[[nodiscard]] std::string capture_header();

/// Appends the record of a datagram. The payload has at most max_udp_payload bytes. Times from 1970
/// to 2106.
void append_capture_record(const Datagram& datagram, std::string& out);

/// How many bytes append_capture_record() adds.
[[nodiscard]] std::size_t capture_record_size(const Datagram& datagram) noexcept;

/// Of the record that `bytes` begin with; 0 if they are too few to tell.
[[nodiscard]] std::size_t capture_record_size(std::string_view bytes) noexcept;

/// Writes datagrams to a capture file: pcap with nanoseconds, link type "raw IP", headers of IPv4
/// and UDP made up around the payload. Wireshark and tcpdump open it; CaptureReader gives back the
/// same datagrams. One thread at a time.
///
/// Buffered: up to 256 KiB wait in memory. When the disk refuses bytes they stay there and are
/// tried again with the next write, in order, so that a disk with room again leaves a file without
/// damage; datagrams that find the buffer full are dropped and counted.
class CaptureWriter {
 public:
  /// Creates the file or empties it. Throws std::runtime_error if that, or writing the first bytes,
  /// fails.
  explicit CaptureWriter(const std::filesystem::path& path);
  ~CaptureWriter();  ///< flushes; call flush() before it to learn whether all went well
  CaptureWriter(const CaptureWriter&) = delete;
  CaptureWriter& operator=(const CaptureWriter&) = delete;

  /// False if the datagram was dropped: the disk refuses and the buffer is full, or the payload is
  /// larger than UDP can carry. Times from 1970 to 2106. Never throws.
  bool write(const Datagram& datagram) noexcept;

  /// Hands everything to the operating system. False if it did not take all.
  bool flush() noexcept;

  /// The first thing that went wrong in write() or flush(), and what to do; empty so far.
  [[nodiscard]] const std::string& error() const noexcept { return error_; }
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  void fail(std::string_view what) noexcept;

  std::string name_;
  int file_ = -1;
  std::string buffer_;
  std::string error_;
  std::uint64_t dropped_ = 0;
};

}  // namespace rsi
