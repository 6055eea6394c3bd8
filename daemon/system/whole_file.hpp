#pragma once

#include <filesystem>
#include <string>

namespace sweepd {

/// All bytes of a file, or of a pipe. Throws std::runtime_error: which file, why it cannot be read,
/// and what to do.
[[nodiscard]] std::string whole_file(const std::filesystem::path& path);

}  // namespace sweepd
