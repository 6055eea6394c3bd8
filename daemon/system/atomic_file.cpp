#include "daemon/system/atomic_file.hpp"

#include <cerrno>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "daemon/system/unfinished_file.hpp"

namespace sweepd {
namespace {

/// Closes on every way out.
struct File {
  int descriptor;
  ~File() {
    if (descriptor >= 0) close(descriptor);
  }
};

[[noreturn]] void fail(const std::filesystem::path& path, const std::filesystem::path& beside) {
  const int reason = errno;
  unlink(beside.c_str());  // on a full disk its bytes are wanted
  throw std::runtime_error(cannot_write(path, reason));
}

}  // namespace

std::string cannot_write(const std::filesystem::path& path, int error) {
  const char* const remedy = error == EISDIR   ? "name a file"
                             : error == ENOENT ? "make that folder first, or name another one"
                             : error == ENOTDIR
                                 ? "name another folder"
                                 : "check the folder's permissions and the free space";
  return "cannot write " + path.string() + " (" + std::generic_category().message(error) +
         "): " + remedy;
}

void write_atomically(const std::filesystem::path& path, std::string_view content) {
  const auto beside = std::filesystem::path(path).concat(".tmp");
  const UnfinishedFile unfinished(beside);
  {
    const File file{open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)};
    if (file.descriptor < 0) fail(path, beside);
    while (!content.empty()) {
      const auto written = write(file.descriptor, content.data(), content.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(path, beside);
      content.remove_prefix(static_cast<std::size_t>(written));
    }
    if (fsync(file.descriptor) != 0) fail(path, beside);
  }
  if (rename(beside.c_str(), path.c_str()) != 0) fail(path, beside);
  const File folder{open(path.has_parent_path() ? path.parent_path().c_str() : ".",
                         O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (folder.descriptor >= 0) fsync(folder.descriptor);
}

}  // namespace sweepd
