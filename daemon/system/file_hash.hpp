#pragma once

#include <cstdint>
#include <filesystem>
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

/// Nothing of what is no regular file, or cannot be read. Reads the whole file: a second for some
/// hundred megabytes.
[[nodiscard]] std::optional<FileHash> hash_of(const std::filesystem::path& file);

/// 64 digits; empty where the library refuses to work.
[[nodiscard]] std::string sha256_of(std::string_view bytes);

/// Those that there are, in the order of `files`.
[[nodiscard]] std::vector<FileHash> hashes_of(const std::vector<std::filesystem::path>& files);

}  // namespace sweepd
