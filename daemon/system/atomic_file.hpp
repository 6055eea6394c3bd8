#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace sweepd {

// Files that appear as a whole, and leave nothing behind where they do not.

/// Puts `content` at `path` so that a reader sees the old file or the new one, never half of one,
/// and that it is on the disk when this returns: written beside it, synced, renamed. Throws
/// std::runtime_error with the path and the reason.
void write_atomically(const std::filesystem::path& path, std::string_view content);

/// The same, but that after a power cut the old file may be back, until sync_folder(): who writes
/// many files of one folder waits for the disk once less for each of them.
void replace_file(const std::filesystem::path& path, std::string_view content);
/// Which files it has is on the disk when this returns, as far as the disk allows.
void sync_folder(const std::filesystem::path& folder) noexcept;

/// With all folders above it; it may be there already. Throws std::runtime_error with the reason
/// and `remedy`.
void make_folder(const std::filesystem::path& folder, const std::string& remedy);

/// Why `path` cannot be written, by the number of the error, and what to do.
[[nodiscard]] std::string cannot_write(const std::filesystem::path& path, int error);

/// A file that is still being written, beside where it belongs: while this lives, a signal that
/// ends the program deletes it first (see delete_unfinished_on_signals()). Any thread.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const std::filesystem::path& path);
  ~UnfinishedFile();
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

 private:
  std::filesystem::path path_;
};

/// Once, at the start of the program: SIGINT, SIGTERM and SIGHUP end it as ever, without its
/// unfinished files. One that is ignored stays ignored.
void delete_unfinished_on_signals();

/// Ends the program by `signal`, without its unfinished files. For handlers of these signals.
void end_by(int signal) noexcept;

}  // namespace sweepd
