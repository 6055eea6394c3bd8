#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>

namespace rsi {

/// More than any file that is read at once: a device that never ends is known by it.
inline constexpr std::size_t kLargestFile = std::size_t{1} << 30;
/// Whoever fills a pipe may take so long from one part to the next.
inline constexpr std::chrono::milliseconds kPatience{60'000};

/// The bytes of a file, or of a pipe. Of one that has more than `most`, the first `most` and one
/// more, by which it is known. Where it cannot be read, `why` says so: a pipe that brings nothing
/// has timed out.
[[nodiscard]] std::string file_bytes(const std::filesystem::path& file, std::size_t most,
                                     std::error_code& why,
                                     std::chrono::milliseconds patience = kPatience);

/// The bytes; nothing where they cannot be read, whatever the reason.
[[nodiscard]] std::optional<std::string> readable_bytes(const std::filesystem::path& file);

/// The same. Throws `Error`: which file, why it cannot be read, and what to do.
template <class Error = std::runtime_error>
[[nodiscard]] std::string file_bytes(const std::filesystem::path& file,
                                     std::size_t most = kLargestFile) {
  std::error_code why;
  std::string bytes = file_bytes(file, most, why);
  if (bytes.size() > kLargestFile) why = std::make_error_code(std::errc::file_too_large);
  if (why)
    throw Error(file.string() + ": cannot be read: " + why.message() +
                ": check the path and the permissions");
  return bytes;
}

}  // namespace rsi
