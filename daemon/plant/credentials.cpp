#include "daemon/plant/credentials.hpp"

#include <cstdlib>
#include <system_error>
#include <utility>

#include "daemon/settings/toml_table.hpp"
#include "rsi/file_bytes.hpp"

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
  auto text = rsi::readable_bytes(file);
  if (!text)
    throw ConfigError(file.string() +
                      ": cannot be read: check the path and who may read it, or hand it over with "
                      "LoadCredential= of the unit");
  while (!text->empty() && (text->back() == '\n' || text->back() == '\r')) text->pop_back();
  if (text->empty()) throw ConfigError(file.string() + ": is empty: write the password into it");
  return std::move(*text);
}

}  // namespace sweepd
