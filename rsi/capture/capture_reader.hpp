#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "rsi/capture/packet.hpp"
#include "rsi/datagram.hpp"

struct pcap;

namespace rsi {

/// Hands out a pcapng file section by section, as libpcap goes on only into sections of the same
/// byte order and with interfaces like the first. Any other file is one section. One thread.
class CaptureSections {
 public:
  /// Throws CaptureError if the file cannot be opened.
  explicit CaptureSections(const std::filesystem::path& path);
  CaptureSections(const CaptureSections&) = delete;
  CaptureSections& operator=(const CaptureSections&) = delete;

  /// Goes to the next section, whatever of the one before was read. False if there is none; there
  /// always is a first.
  bool next();
  /// The bytes of the section, to be closed by the caller, before this ends. Null if the system
  /// has no memory for it.
  [[nodiscard]] std::FILE* open();

  /// How far into the file the reading is.
  [[nodiscard]] std::uint64_t bytes_read() const noexcept { return bytes_read_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };

  std::size_t read(char* bytes, std::size_t size);
  void begin_block();

  // Whose sizes the C library heeds only where they are given to it; they outlive the files.
  std::vector<char> file_buffer_, section_buffer_;
  std::unique_ptr<std::FILE, Close> file_;
  bool begun_ = false;
  bool at_header_ = false;  // of a section that was not begun
  bool big_endian_ = false;
  std::array<char, 12> head_{};  // the block's first bytes, which tell what it is
  std::size_t head_size_ = 0;
  std::size_t head_read_ = 0;
  std::uint64_t left_ = 0;  // of the block
  std::uint64_t bytes_read_ = 0;
};

/// A capture that cannot be used at all. The text says which file, what is wrong and what to do.
class CaptureError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct CaptureCounters {
  std::uint64_t packets = 0;  ///< of any kind; the sum of udp, fragments, foreign and lost headers
  std::uint64_t udp = 0;      ///< datagrams handed out
  std::uint64_t snapped = 0;  ///< captured in part: handed out as cut, or not at all for want of
                              ///< their headers
  std::uint64_t fragments = 0;  ///< pieces of UDP datagrams, left out: they are not put together
  std::uint64_t foreign = 0;    ///< not UDP over IPv4
};

/// What to do where fragments pass.
[[nodiscard]] std::string remedy_for_fragments();

/// Reads the UDP datagrams over IPv4 from a pcap or pcapng file, all sections of it, in the order
/// of the file. What is wrong in the middle of the file never throws: what was read before it has
/// been handed out, and notes() says the rest. One thread at a time.
class CaptureReader {
 public:
  /// Throws CaptureError if the file cannot be opened, is no capture, or is of a link type that is
  /// not understood.
  explicit CaptureReader(const std::filesystem::path& path);

  /// Nothing at the end. The payload is valid until the next call.
  [[nodiscard]] std::optional<Datagram> next();

  [[nodiscard]] const CaptureCounters& counters() const noexcept { return counters_; }

  /// How far into the file the reading is, for progress.
  [[nodiscard]] std::uint64_t bytes_read() const noexcept { return sections_->bytes_read(); }

  /// One sentence for each thing that is wrong with the capture as far as it was read: file, what,
  /// what to do. Empty if all is well.
  [[nodiscard]] std::vector<std::string> notes() const;

 private:
  struct Close {
    void operator()(pcap* capture) const noexcept;
  };

  [[nodiscard]] std::string open_section();
  void next_section();
  void note(std::string sentence);

  std::string name_;
  std::unique_ptr<CaptureSections> sections_;
  std::unique_ptr<pcap, Close> capture_;  // of the section; null at the end
  std::uint64_t section_ = 1;
  LinkLayer layer_{};
  CaptureCounters counters_;
  std::vector<std::string> section_notes_;  // what is wrong with a section as a whole
};

/// The captures of one stream in the order of their first datagrams, however a shell has put their
/// names: "trace*.pcap" has trace-0002.pcap before trace.pcap. One alone is not opened, and one
/// without datagrams goes to the end. Throws CaptureError.
[[nodiscard]] std::vector<std::filesystem::path> in_order_of_time(
    const std::vector<std::filesystem::path>& captures);

}  // namespace rsi
