#include "daemon/plant/credentials.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include "daemon/settings/toml_table.hpp"

namespace sweepd {

std::optional<std::filesystem::path> credential(const std::string& name) {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nobody sets it
  const char* const folder = std::getenv("CREDENTIALS_DIRECTORY");
  if (folder == nullptr) return std::nullopt;
  auto file = std::filesystem::path(folder) / name;
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::nullopt;
  return file;
}

std::string read_secret(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw ConfigError(file.string() +
                      ": cannot be read: check the path and who may read it, or hand it over with "
                      "LoadCredential= of the unit");
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  std::string text = std::move(bytes).str();
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  if (text.empty()) throw ConfigError(file.string() + ": is empty: write the password into it");
  return text;
}

}  // namespace sweepd
