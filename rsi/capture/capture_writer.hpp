#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "rsi/datagram.hpp"

namespace rsi {

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
