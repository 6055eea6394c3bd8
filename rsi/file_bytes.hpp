#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>

namespace rsi {

inline constexpr std::size_t kWholeFile = std::numeric_limits<std::size_t>::max();

/// The bytes of a file, or of a pipe. Of one that has more than `most`, the first `most` and one
/// more, by which it is known. Where it cannot be read, `why` says so.
[[nodiscard]] std::string file_bytes(const std::filesystem::path& file, std::size_t most,
                                     std::error_code& why);

/// The bytes; nothing where they cannot be read, whatever the reason.
[[nodiscard]] std::optional<std::string> readable_bytes(const std::filesystem::path& file);

/// The same. Throws `Error`: which file, why it cannot be read, and what to do.
template <class Error = std::runtime_error>
[[nodiscard]] std::string file_bytes(const std::filesystem::path& file,
                                     std::size_t most = kWholeFile) {
  std::error_code why;
  std::string bytes = file_bytes(file, most, why);
  if (why)
    throw Error(file.string() + ": cannot be read: " + why.message() +
                ": check the path and the permissions");
  return bytes;
}

}  // namespace rsi
