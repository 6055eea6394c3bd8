#include "daemon/system/atomic_file.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

namespace sweepd {
namespace {

constexpr int kEndings[] = {SIGINT, SIGTERM, SIGHUP};

sigset_t endings() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : kEndings) sigaddset(&signals, signal);
  return signals;
}

std::atomic_flag in_change;

std::vector<std::filesystem::path>& unfinished_files() {
  static std::vector<std::filesystem::path> files;
  return files;
}

/// A handler waits for the thread that has this, and never interrupts it.
class Changing {
 public:
  Changing() {
    const auto signals = endings();
    pthread_sigmask(SIG_BLOCK, &signals, &before_);
    while (in_change.test_and_set()) {
    }
  }
  ~Changing() {
    in_change.clear();
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  Changing(const Changing&) = delete;
  Changing& operator=(const Changing&) = delete;

 private:
  sigset_t before_{};
};

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

UnfinishedFile::UnfinishedFile(const std::filesystem::path& path) : path_(path) {
  const Changing changing;
  unfinished_files().push_back(path_);
}

UnfinishedFile::~UnfinishedFile() {
  const Changing changing;
  auto& files = unfinished_files();
  files.erase(std::find(files.begin(), files.end(), path_));
}

void delete_unfinished_on_signals() {
  static_cast<void>(unfinished_files());  // no handler is to make it
  for (const int signal : kEndings) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler != SIG_DFL) continue;
    action.sa_handler = end_by;
    sigaction(signal, &action, nullptr);
  }
}

void end_by(int signal) noexcept {
  const Changing changing;
  for (const auto& file : unfinished_files()) unlink(file.c_str());
  std::signal(signal, SIG_DFL);
  const auto signals = endings();
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  raise(signal);
}

void make_folder(const std::filesystem::path& folder, const std::string& remedy) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw std::runtime_error("cannot make the folder " + folder.string() + " (" + error.message() +
                             "): " + remedy);
}

std::string cannot_write(const std::filesystem::path& path, int error) {
  const char* const remedy = error == EISDIR   ? "name a file"
                             : error == ENOENT ? "make that folder first, or name another one"
                             : error == ENOTDIR
                                 ? "name another folder"
                                 : "check the folder's permissions and the free space";
  return "cannot write " + path.string() + " (" + std::generic_category().message(error) +
         "): " + remedy;
}

void replace_file(const std::filesystem::path& path, std::string_view content) {
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
}

void sync_folder(const std::filesystem::path& folder) noexcept {
  const File file{open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (file.descriptor >= 0) fsync(file.descriptor);
}

void write_atomically(const std::filesystem::path& path, std::string_view content) {
  replace_file(path, content);
  sync_folder(path.parent_path());
}

}  // namespace sweepd
