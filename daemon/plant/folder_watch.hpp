#pragma once

#include <filesystem>

namespace sweepd {

/// Says that something came into folders, by inotify. Where the system refuses to watch one, nobody
/// is told: who uses it looks now and then all the same. One thread.
class FolderWatch {
 public:
  FolderWatch();
  ~FolderWatch();
  FolderWatch(const FolderWatch&) = delete;
  FolderWatch& operator=(const FolderWatch&) = delete;

  /// From now on, also; any number of times.
  void add(const std::filesystem::path& folder);
  /// Whether anything came since the last call. Does not wait.
  [[nodiscard]] bool changed();

 private:
  int notify_;
};

}  // namespace sweepd
