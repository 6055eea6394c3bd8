#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace sweepd {

/// A credential that systemd gave the service (LoadCredential=), as a file.
[[nodiscard]] std::optional<std::filesystem::path> credential(const std::string& name);

/// What is in a file without line ends behind it. Throws ConfigError.
[[nodiscard]] std::string read_secret(const std::filesystem::path& file);

}  // namespace sweepd
