#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "rsi/capture/capture_sections.hpp"
#include "rsi/capture/packet.hpp"
#include "rsi/datagram.hpp"

struct pcap;

namespace rsi {

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

}  // namespace rsi
