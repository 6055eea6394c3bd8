#include "daemon/plant/ledger.hpp"

#include <cerrno>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "rsi/file_bytes.hpp"

namespace sweepd {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path) {
  throw std::runtime_error("cannot write " + path.string() + " (" +
                           std::generic_category().message(errno) +
                           "): check its folder's permissions and the free space");
}

}  // namespace

Ledger::Ledger(const std::filesystem::path& file) : path_(file) {
  std::string text = rsi::readable_bytes(file).value_or("");
  // A crash may have left half a line.
  text.resize(text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) lines_.insert(line);
  file_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0640);
  if (file_ < 0) refuse(path_);
  const auto end = static_cast<off_t>(text.size());
  if (::ftruncate(file_, end) != 0 || ::lseek(file_, end, SEEK_SET) < 0) {
    ::close(file_);
    refuse(path_);
  }
}

Ledger::~Ledger() {
  ::close(file_);
}

bool Ledger::has(const std::string& session, const std::string& sha256) const {
  return lines_.contains(session + ' ' + sha256);
}

void Ledger::add(const std::string& session, const std::string& sha256) {
  const auto [line, is_new] = lines_.insert(session + ' ' + sha256);
  if (!is_new) return;
  const std::string text = *line + '\n';
  const off_t begin = ::lseek(file_, 0, SEEK_CUR);
  if (::write(file_, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
      ::fsync(file_) == 0)
    return;
  const int problem = errno;
  // No half line: what follows would stand in it.
  if (::ftruncate(file_, begin) == 0) ::lseek(file_, begin, SEEK_SET);
  errno = problem;
  refuse(path_);
}

}  // namespace sweepd
