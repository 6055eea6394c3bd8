#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>

namespace rsi {

/// The bytes of a file, or of a pipe. Of one that has more than `most`, the first `most` and one
/// more, by which it is known. Throws std::system_error: why it cannot be read.
[[nodiscard]] std::string file_bytes(const std::filesystem::path& file,
                                     std::size_t most = std::numeric_limits<std::size_t>::max());

}  // namespace rsi
