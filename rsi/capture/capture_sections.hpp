#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>

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

}  // namespace rsi
