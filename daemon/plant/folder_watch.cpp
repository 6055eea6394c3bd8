#include "daemon/plant/folder_watch.hpp"

#include <sys/inotify.h>
#include <unistd.h>

namespace sweepd {

FolderWatch::FolderWatch() : notify_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {}

FolderWatch::~FolderWatch() {
  if (notify_ >= 0) ::close(notify_);
}

void FolderWatch::add(const std::filesystem::path& folder) {
  // The same folder has the same number.
  ::inotify_add_watch(notify_, folder.c_str(),
                      IN_CREATE | IN_MOVED_TO | IN_CLOSE_WRITE | IN_ONLYDIR);
}

bool FolderWatch::changed() {
  bool any = false;
  alignas(inotify_event) char events[4096];
  while (::read(notify_, events, sizeof events) > 0) any = true;
  return any;
}

}  // namespace sweepd
