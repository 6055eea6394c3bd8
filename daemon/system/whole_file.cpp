#include "daemon/system/whole_file.hpp"

#include <stdexcept>
#include <system_error>

#include "rsi/file_bytes.hpp"

namespace sweepd {

std::string whole_file(const std::filesystem::path& path) {
  try {
    return rsi::file_bytes(path);
  } catch (const std::system_error& error) {
    throw std::runtime_error(path.string() + ": cannot be read: " + error.code().message() +
                             ": check the path and the permissions");
  }
}

}  // namespace sweepd
