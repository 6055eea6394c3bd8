#pragma once

#include <filesystem>

namespace sweepd {

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
