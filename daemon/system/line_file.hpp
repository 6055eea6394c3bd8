#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace sweepd {

/// A text file that grows line by line, through a buffer. A disk that refuses bytes never throws
/// here: the first error is kept, what waits is tried again with the next flush, and lines that
/// find the buffer full are left out, so that a disk with room again has whole lines only. One
/// thread.
class LineFile {
 public:
  /// Creates or empties the file; throws std::runtime_error.
  explicit LineFile(const std::filesystem::path& path);
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;

  /// `line` without its end.
  void append(std::string_view line);
  void flush();

  /// The first thing that went wrong; empty so far.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  std::filesystem::path path_;
  int file_;
  std::string buffer_;
  std::string error_;
};

}  // namespace sweepd
