#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sweepd {

/// Sessions in the order in which they began: the start, and the number of those of one second.
using SessionName = std::pair<std::string, unsigned>;

/// Of a folder named 20130704T120000Z or 20130704T120000Z-2; nothing for any other name.
[[nodiscard]] std::optional<SessionName> session_name(std::string_view folder_name);

/// Makes a session's folder, with all folders above it: `start`, or where that is there already
/// START-2 and so on. Throws std::runtime_error.
[[nodiscard]] std::filesystem::path make_session_folder(const std::filesystem::path& robot_folder,
                                                        const std::string& start);

/// Holds a session's folder as one that is being written, against other processes and threads that
/// do the same. A crash lets it go.
class FolderLock {
 public:
  FolderLock() = default;
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept : folder_(std::exchange(other.folder_, -1)) {}
  FolderLock& operator=(FolderLock&& other) noexcept {
    std::swap(folder_, other.folder_);
    return *this;
  }

  /// False if another one has it, or it cannot be had.
  [[nodiscard]] bool held() const { return folder_ >= 0; }

 private:
  int folder_ = -1;
};

/// The sessions of a robot whose last result was never written, as sweepd was killed or the disk
/// was full: run.json has no "ended". The newest first. Their trace may be gone. Those of earlier
/// replays and what cannot be read are left out.
[[nodiscard]] std::vector<std::filesystem::path> unfinished_sessions(
    const std::filesystem::path& robot_folder);

}  // namespace sweepd
