#include "daemon/system/unfinished_file.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <vector>

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

}  // namespace sweepd
