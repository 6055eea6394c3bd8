#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace sweepd {

/// The disk is full, or has less room than is to be kept free.
class NoRoom : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file that grows by whole records: of one that a full disk cut off, the piece is taken back.
/// One thread. Everything throws NoRoom or another std::runtime_error with what to do.
class RecordFile {
 public:
  /// The size of the record that the bytes begin with; 0 if they are too few to tell.
  using RecordSize = std::size_t (*)(std::string_view bytes) noexcept;

  /// Makes the file with `head` in it: it never exists without.
  RecordFile(const std::filesystem::path& path, std::string_view head, RecordSize record_size);
  ~RecordFile();
  RecordFile(const RecordFile&) = delete;
  RecordFile& operator=(const RecordFile&) = delete;

  /// Takes what is in the file now out of `records`: all, unless it throws.
  void append(std::string& records);
  /// Returns once everything is on the disk.
  void sync();

  /// Whether it is still found under its name.
  [[nodiscard]] bool in_place() const noexcept;
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] std::uint64_t records() const { return records_; }
  /// A piece of a record could not be taken back, or what was written may have been lost: the rest
  /// had better go to another file.
  [[nodiscard]] bool doubtful() const { return doubtful_; }

 private:
  std::filesystem::path path_;
  RecordSize record_size_;
  int file_;
  std::uint64_t bytes_;
  std::uint64_t records_ = 0;
  bool doubtful_ = false;
};

/// How many whole records the bytes begin with, and where the last of them ends.
struct WholeRecords {
  std::uint64_t count = 0;
  std::size_t bytes = 0;
};
[[nodiscard]] WholeRecords whole_records(std::string_view bytes,
                                         RecordFile::RecordSize record_size) noexcept;

/// RecordFile::RecordSize of text.
[[nodiscard]] std::size_t line_size(std::string_view bytes) noexcept;

}  // namespace sweepd
