#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sweepd {

/// Which file it was that a program read.
struct FileHash {
  std::filesystem::path file;
  std::uint64_t bytes = 0;
  std::string sha256;  ///< 64 digits
};

/// Makes the hashes of files a little at a time, for a thread that has other work. One thread at a
/// time.
class FileHashes {
 public:
  explicit FileHashes(std::vector<std::filesystem::path> files);
  ~FileHashes();
  FileHashes(const FileHashes&) = delete;
  FileHashes& operator=(const FileHashes&) = delete;

  /// A quarter of a megabyte more, some 0.15 ms. False when all are made.
  bool go_on();
  /// Those that there are, in the order of the files.
  [[nodiscard]] const std::vector<FileHash>& made() const { return made_; }

 private:
  struct Begun;

  std::vector<std::filesystem::path> files_;
  std::size_t next_ = 0;
  std::unique_ptr<Begun> begun_;
  std::vector<FileHash> made_;
};

/// Nothing of what is no regular file, or cannot be read. Reads the whole file: a second for some
/// hundred megabytes.
[[nodiscard]] std::optional<FileHash> hash_of(const std::filesystem::path& file);

/// 64 digits; empty where the library refuses to work.
[[nodiscard]] std::string sha256_of(std::string_view bytes);

/// Those that there are, in the order of `files`.
[[nodiscard]] std::vector<FileHash> hashes_of(const std::vector<std::filesystem::path>& files);

}  // namespace sweepd
