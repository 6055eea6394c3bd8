#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace sweepd {

/// Puts `content` at `path` so that a reader sees the old file or the new one, never half of one,
/// and that it is on the disk when this returns: written beside it, synced, renamed. Throws
/// std::runtime_error with the path and the reason.
void write_atomically(const std::filesystem::path& path, std::string_view content);

/// Why `path` cannot be written, by the number of the error, and what to do.
[[nodiscard]] std::string cannot_write(const std::filesystem::path& path, int error);

}  // namespace sweepd
